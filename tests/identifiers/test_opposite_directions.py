"""One shaker or one sensor under two labels, 99+Z and 99-Z with the sign turned: the same DOF to every method."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole, Direction, Dof, ModalModel, Record, modal_assurance
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import DRIVE_NODE, Example

PLATE = Example(noise_m_s2=0.005)


def turned(record: Record, role: ChannelRole) -> Record:
    """The record with every channel of a role along the opposite direction, its samples with it."""
    chosen = np.array([c.role is role for c in record.channels])
    channels = tuple(
        replace(c, dof=Dof(c.dof.node, Direction(-c.dof.direction))) if c.role is role and c.dof else c
        for c in record.channels
    )
    sign = np.where(chosen, -1.0, 1.0)
    return replace(record, channels=channels, samples=record.samples * sign[:, None])


def shaker_turned_round() -> Campaign:
    """The force of the last two runs along 99-Z."""
    whole = PLATE.campaign()
    return replace(whole, runs=(*whole.runs[:2], *(turned(r, ChannelRole.REFERENCE) for r in whole.runs[2:])))


@pytest.mark.parametrize("name", ["auto", "cfdd", "plscf", "quadrature", "subspace"])
def test_a_shaker_named_the_other_way_in_some_runs_is_one_reference(name: str) -> None:
    model = run_identifier(make_identifier(name), shaker_turned_round())
    true = PLATE.modes().at(model.dofs)
    assert len(model) == len(true)
    assert np.diag(modal_assurance(model.shapes, true.shapes)).min() > 0.999
    assert not any("shape_incomplete" in flags for flags in model.flags)
    assert model.references in ((), (Dof(DRIVE_NODE, Direction.PLUS_Z),))


@pytest.mark.parametrize("name", ["auto", "quadrature"])
def test_a_sensor_that_comes_back_upside_down_is_one_dof(name: str) -> None:
    whole = PLATE.campaign()
    again = replace(turned(whole.runs[1], ChannelRole.RESPONSE), run=9)
    model = run_identifier(make_identifier(name), replace(whole, runs=(*whole.runs, again)))
    assert model.dofs == PLATE.dofs
    assert np.diag(modal_assurance(model.shapes, PLATE.modes().shapes)).min() > 0.999


def by_vectors(campaign: Campaign) -> tuple[ModalModel, ModalModel]:
    """What cfdd claims with singular vectors as shapes, and with residues."""
    vectors, residues = (
        run_identifier(make_identifier("cfdd", shapes=s), campaign) for s in ("singular-vector", "residues")
    )
    return vectors, residues


def test_singular_vectors_are_taken_for_a_drive_point_whose_force_and_response_point_apart() -> None:
    """Sensor 1+Z beside a force along 1-Z: shapes over 1+Z and the others, with the signs of the sensors."""
    whole = PLATE.campaign()
    plain, _ = by_vectors(whole)
    runs = []
    for record in whole.runs:
        reference = replace(record.channels[0], dof=Dof(1, Direction.MINUS_Z))
        runs.append(replace(record, channels=(reference, *record.channels[1:])))
    vectors, residues = by_vectors(replace(whole, runs=tuple(runs)))
    assert vectors.modal_mass_kg is None and residues.modal_mass_kg is not None
    assert vectors.dofs == PLATE.dofs
    np.testing.assert_allclose(vectors.shapes, plain.shapes, rtol=1e-9)
    assert not np.allclose(vectors.shapes, residues.shapes, rtol=1e-3)


def test_singular_vectors_that_lack_a_dof_are_not_taken_and_that_is_said() -> None:
    """Under a second drive point only nodes 1 and 2 were measured: the matrix knows no more than those."""
    whole = PLATE.campaign()
    first = whole.runs[0]
    response = PLATE._accelerations(first.samples[0], PLATE._gains(0))[:2]
    reference = replace(first.channels[0], dof=PLATE.dofs[0])
    second = replace(
        first, run=5, channels=(reference, *first.channels[1:]), samples=np.vstack([first.samples[:1], response])
    )
    vectors, residues = by_vectors(replace(whole, runs=(*whole.runs, second)))
    np.testing.assert_array_equal(vectors.shapes, residues.shapes)
    assert any("not singular vectors" in line and "3+Z" in line for line in vectors.advice)
