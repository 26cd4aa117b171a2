"""BFF, GARTEUR SM-AG19 and the teaching beam: simulator, independent finite elements and published frequencies.

The tables of scenarios/README.md are read and held to what the models give. Three of GARTEUR's modes lie more than 8 %
above the measured ones; that is stated there, not fitted away, and no test asks for it.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from finite_element import Array, build, natural_modes
from uniform_beams import FREE_FREE, UniformBeam

from vgvt.data import ModalModel
from vgvt.scenario import load_scenario
from vgvt.scenario.library import library_folder
from vgvt.simulation.assembly import bare_rig, plan
from vgvt.simulation.labels import mode_labels
from vgvt.simulation.linear import linearise
from vgvt.simulation.modes import eigenpairs, modal_model

BFF_HZ = np.array([5.67, 8.37, 18.34, 19.82, 23.17, 28.60])
"""Moreno et al., American Control Conference 2014, Table I."""
BFF_KINDS = (
    "1st symmetric bending",
    "1st antisymmetric bending",
    "1st symmetric torsion",
    "1st antisymmetric torsion",
    "2nd symmetric bending",
    "2nd antisymmetric bending",
)
GARTEUR_HZ = np.array([6.38, 16.10, 33.13, 33.53, 35.65, 48.38, 49.43, 55.08])
"""Participant C of the round robin: 2-node bending, fuselage rotation, torsion, 3- and 4-node bending, in-plane."""
GARTEUR_KINDS = (
    "1st symmetric bending",
    "1st antisymmetric bending",
    "1st antisymmetric torsion",
    "1st symmetric torsion",
    "2nd antisymmetric bending",
    "2nd symmetric bending",
    "1st antisymmetric in-plane",
    "1st symmetric in-plane",
)
STIFF_JOINT = np.array([False, True, False, False, True, False, True, False])
"""GARTEUR modes that load the joint of wing and fuselage antisymmetrically: not within 8 %."""


@functools.cache
def bare_modes(name: str) -> ModalModel:
    """The bare airframe's modes by the simulator."""
    layout = plan(load_scenario(name))
    rig = bare_rig(layout)
    linear = linearise(rig.model, rig.qpos, tuple((p.site, p.dof.direction.unit_vector) for p in layout.points))
    labels = mode_labels(layout.parts, rig.model, linear.mass, eigenpairs(linear)[1])
    dofs = tuple(p.dof for p in layout.points)
    return modal_model(linear, dofs, len(dofs) - 1, 80.0, labels)


@functools.cache
def finite_element_hz(name: str) -> Array:
    """Elastic frequencies of the bare airframe by the judge."""
    model = build(load_scenario(name).airframe, 30)
    return natural_modes(model.mass, model.stiffness)[0][6:]


@pytest.mark.parametrize(("name", "modes"), [("bff", 6), ("garteur-sm-ag19", 8), ("teaching-beam", 6)])
def test_simulator_and_finite_elements_agree(name: str, modes: int) -> None:
    found = bare_modes(name).natural_frequency_hz[:modes]
    np.testing.assert_allclose(found, finite_element_hz(name)[:modes], rtol=0.005)


def test_bff_is_within_six_per_cent_of_the_paper_and_of_its_kinds() -> None:
    bare = bare_modes("bff")
    np.testing.assert_allclose(bare.natural_frequency_hz[:6], BFF_HZ, rtol=0.06)
    assert bare.labels[:6] == BFF_KINDS


def test_garteur_has_the_published_modes_in_the_published_order() -> None:
    assert bare_modes("garteur-sm-ag19").labels[:8] == GARTEUR_KINDS


def test_garteur_is_within_eight_per_cent_where_the_joint_is_not_asked() -> None:
    found = bare_modes("garteur-sm-ag19").natural_frequency_hz[:8]
    deviation = found / GARTEUR_HZ - 1
    assert np.abs(deviation[~STIFF_JOINT]).max() < 0.08


def test_garteur_torsion_modes_are_closer_than_their_half_power_width() -> None:
    bare = bare_modes("garteur-sm-ag19")
    apart = float(np.diff(bare.natural_frequency_hz[2:4])[0])
    assert 0.0 < apart < 2 * 0.01 * bare.natural_frequency_hz[2]


def test_the_teaching_beam_has_the_frequencies_of_its_lesson() -> None:
    beam = UniformBeam(
        length_m=2.0,
        bending_stiffness_n_m2=40.0,
        torsional_stiffness_n_m2=20.0,
        mass_kg_per_m=1.0,
        pitch_inertia_kg_m=0.01,
    )
    exact = np.sort([*beam.bending_hz(FREE_FREE[:3]), *beam.torsion_hz(np.array([2.0, 4.0, 6.0]))])
    np.testing.assert_allclose(bare_modes("teaching-beam").natural_frequency_hz[:6], exact, rtol=0.003)
    for frequency in exact:
        assert f"{frequency:.3f}" in load_scenario("teaching-beam").lesson


def catalogue_rows(name: str) -> Array:
    """The numbers of a scenario's table in the catalogue: model, finite elements, published (rows, 3)."""
    text = (library_folder() / "README.md").read_text(encoding="utf-8")
    table = text.split(f"`{name}`, against")[1].split("\n\n")[1]
    lines = [line.strip("|").split("|") for line in table.splitlines()[2:]]
    return np.array([[float(cell) for cell in line[1:4]] for line in lines])


@pytest.mark.parametrize("name", ["bff", "garteur-sm-ag19", "teaching-beam"])
def test_the_catalogue_tells_what_the_models_give(name: str) -> None:
    rows = catalogue_rows(name)
    np.testing.assert_allclose(rows[:, 0], bare_modes(name).natural_frequency_hz[: len(rows)], rtol=1.5e-3)
    np.testing.assert_allclose(rows[:, 1], finite_element_hz(name)[: len(rows)], rtol=1.5e-3)
    published = {"bff": BFF_HZ, "garteur-sm-ag19": GARTEUR_HZ}.get(name)
    if published is not None:
        np.testing.assert_array_equal(rows[:, 2], published)
