"""Hati hung for tests of effects: put an effect on, take its true modes by name, solve for receptances."""

from __future__ import annotations

import finite_element as fe
import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel
from vgvt.effects import Effect, make_effect
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.mass import rigid_body_properties
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import hung_rig, plans
from vgvt.simulation.linear import LinearModel, linearise

AFT, RIGHT, UP = np.eye(3)
HEIGHT_M = 0.05
"""Of the hook above the centre of gravity: low enough to keep pitch well below heave."""


def hung_hati() -> Scenario:
    """One run of Hati with eight links a wing and instruments without mass, hung right above its centre of gravity."""
    whole = load_scenario("hati-unsymmetric")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 8})
    airframe = whole.airframe.model_copy(update={"beam": (wing,)})
    x, _, z = rigid_body_properties(airframe).centre_of_gravity_m
    changes: dict[str, dict[str, object]] = {
        "acquisition": {"runs": ((1, 10),)},
        "accelerometers": {"mass_kg": 0.0},
        "transducer": {"mass_kg": 0.0, "end_mass_kg": 0.0},
        "stinger": {"mass_kg": 0.0},
        "suspension": {"hook_m": (float(x), 0.0, float(z) + HEIGHT_M)},
    }
    tables = {name: getattr(whole, name).model_copy(update=update) for name, update in changes.items()}
    return whole.model_copy(update=tables | {"airframe": airframe})


def stiffened(hati: Scenario) -> Scenario:
    """The scenario with wings a thousand times stiffer, for formulas of rigid bodies: real ones droop."""
    table = hati.airframe.beam[0]
    columns = {
        n: tuple(1e3 * v for v in getattr(table.stations, n))
        for n in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2")
    }
    wing = table.model_copy(update={"stations": table.stations.model_copy(update=columns)})
    return hati.model_copy(update={"airframe": hati.airframe.model_copy(update={"beam": (wing,)})})


def with_effect(scenario: Scenario, name: str, **parameters: object) -> Scenario:
    """The scenario with one more effect."""
    return scenario.model_copy(update={"effect": (*scenario.effect, EffectTable(name=name, **parameters))})


def made(name: str, **parameters: object) -> Effect:
    """One effect."""
    return make_effect(name, "test", **parameters)


def as_tested(scenario: Scenario) -> ModalModel:
    """The true modes of the first run."""
    return truth_of(scenario).as_tested[0]


def hung(scenario: Scenario, *points: tuple[str, NDArray[np.float64]]) -> LinearModel:
    """The hung aircraft linearised, with displacement rows for some sites and directions."""
    rig = hung_rig(plans(scenario)[0], 0)
    return linearise(rig.model, rig.qpos, points)


def receptance(model: LinearModel, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Receptances (lines, points, points) by direct solution."""
    rows = model.displacement
    s = 2j * np.pi * frequency_hz[:, None, None]
    return np.asarray(rows @ np.linalg.solve(s**2 * model.mass + s * model.damping + model.stiffness, rows.T[None]))


def mode(modes: ModalModel, label: str) -> tuple[float, float]:
    """Frequency and damping ratio of the mode of that name."""
    index = modes.labels.index(label)
    return float(modes.natural_frequency_hz[index]), float(modes.damping_ratio[index])


def elastic(scenario: Scenario) -> NDArray[np.float64]:
    """Frequencies of the aircraft's elastic modes as tested, in the band of the test."""
    modes = as_tested(scenario)
    keep = [i for i, label in enumerate(modes.labels) if "bending" in label or "torsion" in label]
    frequency = modes.natural_frequency_hz[keep]
    return np.asarray(frequency[frequency < 40.0])


def bare_bending(scenario: Scenario) -> NDArray[np.float64]:
    """Bending frequencies of the bare airframe."""
    bare = truth_of(scenario).bare
    keep = [i for i, label in enumerate(bare.labels) if label.endswith("bending")]
    return np.asarray(bare.natural_frequency_hz[keep])


def fe_items(scenario: Scenario) -> tuple[fe.Item, ...]:
    """Every item once, mirrored ones written out with the names of their sides."""
    copies = []
    for item in scenario.airframe.item:
        if not item.mirror:
            copies.append(item)
            continue
        x, y, z = item.position_m
        for side, sign in (("right", 1.0), ("left", -1.0)):
            part = item.attached_to if item.attached_to == "body" else f"{item.attached_to}-{side}"
            update = {
                "name": f"{item.name}-{side}",
                "mirror": False,
                "attached_to": part,
                "position_m": (x, sign * y, z),
            }
            copies.append(item.model_copy(update=update))
    return tuple(copies)


def tips(scenario: Scenario) -> tuple[int, int]:
    """Nodes of the outermost points on the forward row, right and left."""
    grid = scenario.accelerometers.grid
    order = np.argsort(grid.y_m)
    return grid.node[int(order[-1])], grid.node[int(order[0])]
