"""Named random streams: reproducible, independent, untouched by what else exists."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from vgvt.scenario import named_stream


def test_the_same_name_gives_the_same_numbers() -> None:
    first = named_stream(7, "noise", 3, "12+Z").standard_normal(5)
    named_stream(7, "noise", 3, "13+Z").standard_normal(100)
    np.testing.assert_array_equal(first, named_stream(7, "noise", 3, "12+Z").standard_normal(5))


def test_seed_and_every_name_matter() -> None:
    labels = [("a", "bc"), ("ab", "c"), ("abc",), ("a", "b", "c"), (1,), ("1",), (1, "a"), ("a", 1), ('a", "bc',)]
    firsts = [named_stream(seed, *names).integers(2**63) for seed in (0, 1) for names in labels]
    assert len(set(firsts)) == len(firsts)


def test_streams_are_uncorrelated() -> None:
    samples = 20_000
    streams = [named_stream(1, "sensor", node).standard_normal(samples) for node in range(12)]
    correlation = [abs(np.corrcoef(a, b)[0, 1]) for a, b in itertools.combinations(streams, 2)]
    assert max(correlation) < 5 / np.sqrt(samples)


def test_numpy_integers_name_the_same_stream() -> None:
    assert named_stream(np.int64(3), np.int32(4)).random() == named_stream(3, 4).random()


def test_a_stream_needs_a_name() -> None:
    with pytest.raises(ValueError, match="name"):
        named_stream(1)
