"""Laws of the NRMSE fit, the ν-gap and the synthesised FRFs they compare."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.data import Direction, Dof, ModalModel, Quantity, synthesise
from vgvt_scoreboard import fit_percent, frf_fit_percent, pointwise_nu_gap, winding_turns
from vgvt_scoreboard.nu_gap import STANDARD_GRAVITY_M_S2, nu_gap_of_accelerances

seeds = st.integers(0, 2**32 - 1)


def random_system(generator: np.random.Generator, outputs: int, inputs: int, lines: int = 6) -> np.ndarray:
    size = (outputs, inputs, lines)
    scale = 10.0 ** generator.uniform(-2, 2, lines)
    return (generator.normal(size=size) + 1j * generator.normal(size=size)) * scale


@given(seeds, st.integers(1, 5), st.integers(1, 3))
@settings(max_examples=40, deadline=None)
def test_nu_gap_is_the_sine_of_the_largest_angle_between_the_graphs(seed: int, outputs: int, inputs: int) -> None:
    """The chordal distance is the gap between the graph subspaces [P; I]."""
    generator = np.random.default_rng(seed)
    p1, p2 = random_system(generator, outputs, inputs), random_system(generator, outputs, inputs)
    gap = pointwise_nu_gap(p1, p2)
    for k in range(p1.shape[-1]):
        graphs = [np.vstack([p[:, :, k], np.eye(inputs)]) for p in (p1, p2)]
        assert gap[k] == pytest.approx(np.sin(scipy.linalg.subspace_angles(*graphs).max()), abs=1e-9)


@given(seeds, st.integers(1, 4), st.integers(1, 3))
@settings(max_examples=40, deadline=None)
def test_nu_gap_laws(seed: int, outputs: int, inputs: int) -> None:
    generator = np.random.default_rng(seed)
    p1, p2, p3 = (random_system(generator, outputs, inputs) for _ in range(3))
    gap = pointwise_nu_gap(p1, p2)
    assert np.all((gap >= 0) & (gap <= 1))
    assert pointwise_nu_gap(p1, p1) == pytest.approx(0.0, abs=1e-12)
    assert pointwise_nu_gap(p2, p1) == pytest.approx(gap, abs=1e-9)
    assert np.all(gap <= pointwise_nu_gap(p1, p3) + pointwise_nu_gap(p3, p2) + 1e-9)
    u = np.linalg.qr(generator.normal(size=(outputs, outputs)) + 1j * generator.normal(size=(outputs, outputs)))[0]
    v = np.linalg.qr(generator.normal(size=(inputs, inputs)))[0]
    turned = [np.einsum("ij,jkf,kl->ilf", u, p, v) for p in (p1, p2)]
    assert pointwise_nu_gap(*turned) == pytest.approx(gap, abs=1e-9)


def test_nu_gap_refuses_systems_of_different_size() -> None:
    with pytest.raises(ValueError, match="responses, references, frequency"):
        pointwise_nu_gap(np.zeros((2, 1, 3)), np.zeros((3, 1, 3)))


OMEGA = np.concatenate([-np.geomspace(1e6, 1e-6, 40001), np.geomspace(1e-6, 1e6, 40001)])


def lag(pole: float, gain: float = 100.0) -> np.ndarray:
    """gain / (2 s + pole) on the whole imaginary axis, (1, 1, frequency)."""
    return np.asarray(gain / (2j * OMEGA + pole))[None, None]


def test_a_stable_and_an_unstable_lag_are_near_because_the_winding_makes_up_for_the_pole() -> None:
    """Vinnicombe's example: 100/(2s+1) and 100/(2s-1); one unstable pole more and one turn."""
    assert pointwise_nu_gap(lag(1.0), lag(-1.0)).max() == pytest.approx(0.02, abs=1e-3)
    assert abs(winding_turns(lag(1.0), lag(-1.0))) == pytest.approx(1.0, abs=1e-3)


def test_of_accelerances_it_is_one_where_the_band_winds_and_else_their_distance_in_g() -> None:
    """A model has stable poles: where the graphs wind about each other no distance makes up for it."""
    one, turned, near = (STANDARD_GRAVITY_M_S2 * lag(p, g) for p, g in ((1.0, 100.0), (-1.0, 100.0), (1.0, 101.0)))
    assert np.array_equal(nu_gap_of_accelerances(one, turned), np.ones(OMEGA.size))
    assert nu_gap_of_accelerances(one, near) == pytest.approx(pointwise_nu_gap(lag(1.0), lag(1.0, 101.0)))


def test_stable_systems_that_differ_little_wind_by_nothing() -> None:
    s = 1j * OMEGA
    systems = [(np.array([1.0, -0.5])[:, None] * s**2 / (s**2 + 2 * z * s + 1))[:, None] for z in (0.01, 0.011)]
    assert winding_turns(*systems) == pytest.approx(0.0, abs=1e-3)
    assert winding_turns(systems[0], systems[0]) == 0.0


def test_a_delay_winds() -> None:
    late = lag(1.0) * np.exp(-0.5j * np.clip(OMEGA, -40.0, 40.0))
    assert abs(winding_turns(lag(1.0), late)) > 0.5


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_fit_laws(seed: int) -> None:
    generator = np.random.default_rng(seed)
    y = random_system(generator, 2, 1, 30)
    error = random_system(generator, 2, 1, 30)
    assert fit_percent(y, y) == pytest.approx(100.0)
    mean = np.broadcast_to(y.mean(axis=-1, keepdims=True), y.shape)
    assert fit_percent(y, mean) == pytest.approx(0.0, abs=1e-9)
    turn, shift = 3 * np.exp(1.2j), 0.7 - 2j
    assert fit_percent(turn * y + shift, turn * (y + error) + shift) == pytest.approx(fit_percent(y, y + error))
    assert np.all(fit_percent(y, y + 2 * error) < fit_percent(y, y + error))


def test_fit_of_a_constant_is_unknown_and_shapes_must_agree() -> None:
    assert np.isnan(fit_percent(np.ones(4), np.zeros(4)))
    with pytest.raises(ValueError, match="one shape"):
        fit_percent(np.ones(4), np.ones(5))


def spring_and_mass() -> tuple[ModalModel, float, float, float]:
    mass, stiffness, damping = 2.0, 3200.0, 1.6
    omega = np.sqrt(stiffness / mass)
    ratio = damping / (2 * mass * omega)
    residue = 1 / (2j * omega * np.sqrt(1 - ratio**2) * mass)
    dofs = (Dof(1, Direction.PLUS_Z),)
    model = ModalModel(
        np.array([omega / 2 / np.pi]), np.array([ratio]), np.ones((1, 1), complex), dofs,
        references=dofs, residues=np.full((1, 1, 1), residue),
    )  # fmt: skip
    return model, mass, stiffness, damping


@pytest.mark.parametrize(
    ("quantity", "derivatives"), [(Quantity.DISPLACEMENT, 0), (Quantity.VELOCITY, 1), (Quantity.ACCELERATION, 2)]
)
def test_synthesis_is_the_frf_of_a_spring_and_mass(quantity: Quantity, derivatives: int) -> None:
    model, mass, stiffness, damping = spring_and_mass()
    frequency = np.linspace(0.5, 20, 57)
    s = 2j * np.pi * frequency
    expected = s**derivatives / (mass * s**2 + damping * s + stiffness)
    frf = synthesise(model, frequency, quantity)
    assert np.allclose(frf.values[0, 0], expected, rtol=1e-12)
    assert frf.quantity is quantity


def test_synthesis_needs_residues_and_a_motion() -> None:
    model, *_ = spring_and_mass()
    bare = ModalModel(model.natural_frequency_hz, model.damping_ratio, model.shapes, model.dofs)
    with pytest.raises(ValueError, match="no residues"):
        synthesise(bare, np.array([1.0]))
    with pytest.raises(ValueError, match="displacement, velocity or acceleration"):
        synthesise(model, np.array([1.0]), Quantity.REACTION_FORCE)


def test_frf_fit_compares_like_with_like() -> None:
    model, *_ = spring_and_mass()
    frequency = np.linspace(0.5, 20, 57)
    frf = synthesise(model, frequency)
    assert frf_fit_percent(frf, frf) == pytest.approx(np.array([[100.0]]))
    with pytest.raises(ValueError, match="same DOFs"):
        frf_fit_percent(frf, synthesise(model, frequency, Quantity.VELOCITY))
