"""Laws of the pairing of modes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.data import Direction, Dof, ModalModel
from vgvt_scoreboard import PairingRule, pair_modes, pole_distance

DOFS = tuple(Dof(k, Direction.PLUS_Z) for k in range(1, 6))


def random_model(generator: np.random.Generator, modes: int) -> ModalModel:
    frequency = np.sort(generator.uniform(5.0, 12.0, modes))
    shapes = generator.normal(size=(modes, len(DOFS))) + 1.0
    return ModalModel(frequency, generator.uniform(0.005, 0.03, modes), shapes.astype(complex), DOFS)


def with_mode(model: ModalModel, frequency_hz: float) -> ModalModel:
    """The same model with one more mode."""
    frequency = np.append(model.natural_frequency_hz, frequency_hz)
    order = np.argsort(frequency)
    shapes = np.vstack([model.shapes, np.ones((1, len(model.dofs)))])
    return ModalModel(frequency[order], np.append(model.damping_ratio, 0.01)[order], shapes[order], model.dofs)


def pairs_in_hz(first: ModalModel, second: ModalModel) -> set[tuple[float, float]]:
    return {
        (float(first.natural_frequency_hz[i]), float(second.natural_frequency_hz[j]))
        for i, j in pair_modes(first, second).pairs
    }


seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.integers(0, 5), st.integers(0, 5))
@settings(max_examples=60, deadline=None)
def test_pairing_is_optimal_among_all_one_to_one_choices(seed: int, m: int, n: int) -> None:
    generator = np.random.default_rng(seed)
    first, second = random_model(generator, m), random_model(generator, n)
    rule = PairingRule()
    result = pair_modes(first, second, rule)

    def gain(pairs: list[tuple[int, int]]) -> float:
        return sum(
            1 + rule.mac_weight - result.pole_distance[p] / rule.max_pole_distance
            - rule.mac_weight * (1 - result.mac[p])
            for p in pairs
        )  # fmt: skip

    best = 0.0
    for size in range(1, min(m, n) + 1):
        for rows in itertools.combinations(range(m), size):
            for columns in itertools.permutations(range(n), size):
                pairs = list(zip(rows, columns, strict=True))
                if all(result.admissible[p] for p in pairs):
                    best = max(best, gain(pairs))
    assert gain(list(result.pairs)) == pytest.approx(best, abs=1e-12)
    assert len({i for i, _ in result.pairs}) == len({j for _, j in result.pairs}) == len(result.pairs)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_exchanging_the_sides_exchanges_the_pairs(seed: int) -> None:
    generator = np.random.default_rng(seed)
    first, second = random_model(generator, 4), random_model(generator, 5)
    assert pairs_in_hz(first, second) == {(a, b) for b, a in pairs_in_hz(second, first)}


@given(seeds, st.permutations(range(len(DOFS))), st.lists(st.floats(0.1, 6.2), min_size=5, max_size=5))
@settings(max_examples=40, deadline=None)
def test_order_of_sensors_and_phase_of_shapes_do_not_matter(seed: int, order: list[int], phases: list[float]) -> None:
    generator = np.random.default_rng(seed)
    first, second = random_model(generator, 4), random_model(generator, 5)
    turned = ModalModel(
        second.natural_frequency_hz,
        second.damping_ratio,
        second.shapes * 7.0 * np.exp(1j * np.array(phases))[:, None],
        second.dofs,
    )
    dofs = tuple(DOFS[k] for k in order)
    assert pairs_in_hz(first, second) == pairs_in_hz(first.at(dofs), turned.at(dofs))


@given(seeds, st.floats(20.0, 100.0))
@settings(max_examples=40, deadline=None)
def test_a_far_mode_changes_no_other_pair(seed: int, far_hz: float) -> None:
    generator = np.random.default_rng(seed)
    first, second = random_model(generator, 4), random_model(generator, 4)
    assert pairs_in_hz(first, second) == pairs_in_hz(first, with_mode(second, far_hz))


def test_pole_distance_counts_damping_and_ignores_it_where_none_is_stated(model) -> None:
    shape = [[1.0, 1.0]]
    assert pole_distance(model([10.0], [0.01], shape), model([10.0], [0.03], shape))[0, 0] == pytest.approx(0.02, 1e-3)
    assert pole_distance(model([10.0], [0.01], shape), model([10.1], [np.nan], shape))[0, 0] == pytest.approx(
        0.1 / 10.05
    )


def test_close_modes_with_different_shapes_are_not_exchanged(model) -> None:
    """The estimates of the pair are out of order in frequency; their shapes tell them apart."""
    truth = model([33.13, 33.53], [0.01, 0.01], [[1, 1, 1, 1], [1, -1, 1, -1]])
    claim = model([33.20, 33.45], [0.01, 0.01], [[1, -1, 1.1, -1], [1, 1.1, 1, 1]])
    assert pairs_in_hz(truth, claim) == {(33.13, 33.45), (33.53, 33.20)}


def test_close_modes_with_alike_shapes_go_by_their_poles(model) -> None:
    truth = model([33.0, 33.6], [0.01, 0.01], [[1, 1, 1.0], [1, 1, 0.8]])
    claim = model([33.05, 33.55], [0.01, 0.01], [[1, 1, 0.8], [1, 1, 1.0]])
    assert pairs_in_hz(truth, claim) == {(33.0, 33.05), (33.6, 33.55)}


def test_look_alikes_far_apart_are_never_paired(model) -> None:
    truth = model([8.0, 20.0], [0.01, 0.01], [[1, 2, 1], [1, 2, 2]])
    claim = model([8.04, 20.4], [0.01, 0.01], [[1, 2, 2], [1, 2, 1]])
    result = pair_modes(truth, claim)
    assert result.mac[0, 1] == pytest.approx(1.0)
    assert result.pairs == ((0, 0), (1, 1))


def test_gates_hold_at_their_edges(model) -> None:
    truth = model([10.0], [0.01], [[1.0, 0.0]])
    assert pair_modes(truth, model([11.2], [0.01], [[1.0, 0.0]])).pairs == ()
    assert pair_modes(truth, model([10.9], [0.01], [[1.0, 0.0]])).pairs == ((0, 0),)
    assert pair_modes(truth, model([10.0], [0.01], [[1.0, 1.2]])).pairs == ()


def test_models_at_different_dofs_are_refused(model) -> None:
    with pytest.raises(ValueError, match="same DOFs"):
        pair_modes(model([10.0], [0.01], [[1.0, 0.0]]), model([10.0], [0.01], [[1.0]]))


@pytest.mark.parametrize("bad", [{"max_pole_distance": 0.0}, {"min_mac": 1.5}, {"mac_weight": -1.0}])
def test_a_rule_without_sense_is_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="pairing rule"):
        PairingRule(**bad)
