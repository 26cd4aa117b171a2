"""GARTEUR SM-AG19 with other joints than its scenario declares: rigid ones, or springs of any stiffness."""

from __future__ import annotations

from vgvt.scenario import Airframe, Beam, load_scenario

HEIGHT_M = 0.005
"""Of the wing's mount: half the wing's thickness, from the fuselage's top to the wing's middle plane."""


def rigid_jointed() -> Airframe:
    """The testbed without its three calibrated springs: the wing on the body itself, the fin's foot clamped."""
    airframe = load_scenario("garteur-sm-ag19").airframe
    mount = next(beam for beam in airframe.beam if beam.name == "wing-mount")
    freed = {"wing": {"parent": "body"}, "fin": {"root_bending_stiffness_n_m_per_rad": None}}
    beams = tuple(_changed(beam, freed) for beam in airframe.beam if beam is not mount)
    mass = airframe.body.mass_kg + HEIGHT_M * mount.stations.mass_kg_per_m[0]
    body = airframe.body.model_copy(update={"mass_kg": mass})
    return airframe.model_copy(update={"beam": beams, "body": body})


def jointed(roll: float, pitch: float, yaw: float, fin: float | None) -> Airframe:
    """The testbed with wing-mount springs about the three axes and one at the fin's foot, N m/rad; None is rigid."""
    airframe = load_scenario("garteur-sm-ag19").airframe
    mount = next(beam for beam in airframe.beam if beam.name == "wing-mount")
    springs = {
        "bending_stiffness_n_m2": (roll * HEIGHT_M,) * 2,
        "in_plane_stiffness_n_m2": (pitch * HEIGHT_M,) * 2,
        "torsional_stiffness_n_m2": (yaw * HEIGHT_M,) * 2,
    }
    changes: dict[str, dict[str, object]] = {
        "wing-mount": {"stations": mount.stations.model_copy(update=springs)},
        "fin": {"root_bending_stiffness_n_m_per_rad": fin},
    }
    return airframe.model_copy(update={"beam": tuple(_changed(beam, changes) for beam in airframe.beam)})


def _changed(beam: Beam, changes: dict[str, dict[str, object]]) -> Beam:
    return beam.model_copy(update=changes.get(beam.name, {}))
