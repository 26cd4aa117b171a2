"""Few sensors and many points driven, as with a roving hammer: shapes over the points driven, by reciprocity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, Direction, Dof, ModalModel, modal_assurance
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.merged_claim import merged_claim

FREQUENCY, DAMPING = np.array([8.0, 15.0, 30.0]), np.full(3, 0.01)
POLES = 2 * np.pi * FREQUENCY * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
MASS = np.array([2.0, 1.0, 3.0])
SHAPES = np.random.default_rng(7).standard_normal((3, 8))


def residues(dofs: tuple[Dof, ...], references: tuple[Dof, ...]) -> np.ndarray:
    """Receptance residues (M, D, R) of the shapes and modal masses, along the directions of the labels."""
    here, there = (
        SHAPES[:, [d.node - 1 for d in part]] * [d.direction.sign for d in part] for part in (dofs, references)
    )
    return np.asarray(here[:, :, None] * there[:, None] / (2j * POLES.imag * MASS)[:, None, None])


def hits(sensors: tuple[str, ...], points: tuple[str, ...]) -> tuple[RunModes, ...]:
    """What a perfect identification tells of one run for every point hit."""
    dofs, std = tuple(map(Dof.from_label, sensors)), np.full(3, 1e-3)
    return tuple(
        RunModes(k + 1, point, dofs, POLES, residues(dofs, (point,))[:, :, 0], std, std / 10)
        for k, point in enumerate(map(Dof.from_label, points))
    )


def assert_right(model: ModalModel) -> None:
    """Shape, scale and residues, at all DOFs of the model."""
    true = SHAPES[:, [d.node - 1 for d in model.dofs]] * [d.direction.sign for d in model.dofs]
    np.testing.assert_allclose(np.diag(modal_assurance(model.shapes, true)), 1.0, rtol=1e-12)
    assert model.residues is not None
    np.testing.assert_allclose(model.residues, residues(model.dofs, model.references), rtol=1e-9)
    np.testing.assert_allclose(np.abs(model.shapes).max(axis=1), 1.0)
    assert any("reciprocity" in line for line in model.advice)
    if model.modal_mass_kg is not None:
        np.testing.assert_allclose(model.modal_mass_kg, MASS / np.abs(true).max(axis=1) ** 2, rtol=1e-9)


@pytest.mark.parametrize(
    ("sensors", "points"),
    [
        (("2+Z",), ("1+Z", "2+Z", "3+Z", "4+Z", "5+Z", "6+Z", "7+Z", "8+Z")),
        (("2-Z",), ("1+Z", "2+Z", "3-Z", "4+Z")),
        (("2+Z", "7+Z"), ("1+Z", "2-Z", "3+Z", "4+Z", "5-Z")),
        (("2+Z", "7+Z", "8-Z"), ("1+Z", "2-Z", "7+Z", "4+Z", "5-Z")),
    ],
)
def test_points_hit_join_the_shape_where_one_of_them_has_a_sensor(
    sensors: tuple[str, ...], points: tuple[str, ...]
) -> None:
    model = merged_claim(hits(sensors, points))
    assert {d.unsigned for d in model.dofs} == {Dof.from_label(x).unsigned for x in (*sensors, *points)}
    assert model.references == tuple(map(Dof.from_label, points))
    assert model.modal_mass_kg is not None
    assert_right(model)


def test_without_a_sensor_at_a_point_hit_the_shape_is_over_those_points_and_has_no_mass() -> None:
    model = merged_claim(hits(("2+Z", "7-Z"), ("1+Z", "3-Z", "4+Z", "5+Z")))
    assert [str(d) for d in model.dofs] == ["1+Z", "3-Z", "4+Z", "5+Z"]
    assert [str(r) for r in model.references] == ["2+Z", "7-Z"]
    assert model.modal_mass_kg is None
    assert_right(model)
    assert any("drive the point of a sensor too" in line for line in model.advice)


def test_as_many_sensors_as_points_stay_as_they_are() -> None:
    model = merged_claim(hits(("2+Z", "7+Z"), ("1+Z", "2+Z")))
    assert [str(d) for d in model.dofs] == ["2+Z", "7+Z"] and model.advice == ()


def roving_force(example: Example, sensor: int) -> Campaign:
    """One sensor that stays, at a node of the example, and the force at every node in turn."""
    force, whole = example._force(), example.campaign()
    first = whole.runs[0]
    channels = next(r.channels[1:] for r in whole.runs if sensor in [c.dof.node for c in r.channels[1:] if c.dof])
    answer = next(c for c in channels if c.dof == Dof(sensor, Direction.PLUS_Z))
    runs = []
    for driven, dof in enumerate(example.dofs):
        response = example._accelerations(force, example._gains(driven))[sensor - 1]
        noise = example.noise_m_s2 * np.random.default_rng(driven).standard_normal(response.size)
        reference = replace(first.channels[0], dof=dof)
        samples = np.vstack([force, response + noise])
        runs.append(replace(first, run=driven + 1, channels=(reference, answer), samples=samples))
    return replace(whole, runs=tuple(runs))


@pytest.mark.parametrize("name", ["auto", "cfdd", "era", "quadrature", "subspace"])
def test_methods_claim_shapes_over_the_points_hit(name: str) -> None:
    example = Example(noise_m_s2=0.005)
    model = run_identifier(make_identifier(name), roving_force(example, 2))
    true = example.modes()
    np.testing.assert_allclose(model.natural_frequency_hz, true.natural_frequency_hz, rtol=1e-3)
    assert set(model.dofs) == set(example.dofs)
    assert np.diag(modal_assurance(model.at(example.dofs).shapes, true.shapes)).min() > 0.999
    assert any("reciprocity" in line for line in model.advice)
