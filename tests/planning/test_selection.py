"""The choice of points: against every possible choice, and with shapes kept apart."""

from __future__ import annotations

import itertools

import numpy as np

from vgvt.planning.selection import chosen_points, dealt, least_distinct, worst_relative_damping

POLES = np.array([-0.6 + 50j, -1.2 + 95j])
WANTED = np.array([0, 1])


def informations(seed: int, points: int):
    generator = np.random.default_rng(seed)
    roots = generator.normal(size=(points, 4, 6)) * generator.lognormal(sigma=1.0, size=(points, 1, 1))
    return roots @ roots.transpose(0, 2, 1)


def test_the_choice_is_as_good_as_the_best_of_all() -> None:
    for seed in range(5):
        each = informations(seed, 9)
        shapes = np.random.default_rng(seed + 100).normal(size=(2, 9)).astype(complex)
        mine = chosen_points(each, POLES, WANTED, shapes, 4, 1.0)
        every = [np.array(c) for c in itertools.combinations(range(9), 4)]
        worst = worst_relative_damping(POLES, np.array([each[c].sum(axis=0) for c in every]), WANTED)
        found = worst_relative_damping(POLES, each[mine].sum(axis=0)[None], WANTED)[0]
        assert found <= 1.02 * worst.min()


def test_shapes_stay_apart_where_the_best_points_would_not_tell_them() -> None:
    each = informations(1, 12)
    each[:6] *= 1e6  # right wing: tells most, but there both shapes look alike
    shapes = np.ones((2, 12), complex)
    shapes[1, 6:] = -1
    greedy = chosen_points(each, POLES, WANTED, shapes, 4, 1.0)
    assert least_distinct(shapes, greedy) > 0.9
    apart = chosen_points(each, POLES, WANTED, shapes, 4, 0.1)
    assert least_distinct(shapes, apart) <= 0.1
    assert apart.size == np.unique(apart).size == 4


def test_dealing_keeps_every_point_once() -> None:
    hands = dealt(list(range(7)), 3)
    assert sorted(itertools.chain(*hands)) == list(range(7))
    assert {len(hand) for hand in hands} == {2, 3}
    assert [0 in hands[0], 1 in hands[1], 2 in hands[2], 3 in hands[2]] == [True] * 4
