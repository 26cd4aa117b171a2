"""What --json prints is JSON for every reader: plain types, no NaN, no infinity."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vgvt.cli.document import document_text, plain
from vgvt.data import Direction, Dof, ModalModel, Outcome
from vgvt.files.claim import Claim, claim_document, read_claim


class Colour(StrEnum):
    """Something with a value."""

    RED = "red"


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (float("nan"), None),
        (np.float64("inf"), None),
        (np.array([1.0, np.nan]), [1.0, None]),
        (np.int64(3), 3),
        (np.bool_(True), True),
        (True, True),
        (1 + 2j, {"real": 1.0, "imag": 2.0}),
        (Dof(12, Direction.MINUS_Z), "12-Z"),
        (Path("a/b"), str(Path("a/b"))),
        (Colour.RED, "red"),
        ((1, (2, 3)), [1, [2, 3]]),
        ({1: None}, {"1": None}),
    ],
)
def test_plain(value: object, expected: object) -> None:
    assert plain(value) == expected
    assert type(plain(value)) is type(expected)


def test_what_has_no_place_is_refused() -> None:
    with pytest.raises(TypeError, match="object has no place"):
        plain({"a": [object()]})


@settings(deadline=None, max_examples=50)
@given(st.dictionaries(st.text(), st.recursive(st.floats() | st.integers() | st.text() | st.none(), st.lists)))
def test_every_document_is_one_strict_ascii_object(document: dict[str, object]) -> None:
    text = document_text(document)
    assert text.isascii()

    def refuse(constant: str) -> float:
        raise AssertionError(constant)

    assert isinstance(json.loads(text, parse_constant=refuse), dict)


@settings(deadline=None, max_examples=50)
@given(
    frequencies=st.lists(st.floats(0.1, 100.0), min_size=0, max_size=4),
    shapes=arrays(complex, (4, 3), elements=st.complex_numbers(max_magnitude=1e3)),
    std=st.floats(0, 1) | st.just(float("nan")),
)
def test_a_claim_survives_its_file(
    tmp_path_factory: pytest.TempPathFactory, frequencies: list[float], shapes: np.ndarray, std: float
) -> None:
    count = len(frequencies)
    model = ModalModel(
        natural_frequency_hz=np.sort(np.array(frequencies, dtype=float)),
        damping_ratio=np.full(count, 0.01),
        shapes=shapes[:count],
        dofs=tuple(Dof(n, Direction.PLUS_Z) for n in (1, 2, 3)),
        natural_frequency_std_hz=np.full(count, std),
        damping_ratio_std=np.full(count, std),
        labels=("",) * count,
        flags=(("narrow",),) * count,
        method="oracle",
        outcome=Outcome.FOUND if count else Outcome.NOTHING_FOUND,
        advice=("look again",),
        settings={"order": "12"},
    )
    path = tmp_path_factory.mktemp("claim") / "claim.json"
    path.write_text(document_text(claim_document(Claim("oracle", (1.0, 35.0), model))), encoding="utf-8")
    again = read_claim(path)
    assert (again.identifier, again.band_hz) == ("oracle", (1.0, 35.0))
    np.testing.assert_array_equal(again.model.natural_frequency_hz, model.natural_frequency_hz)
    np.testing.assert_array_equal(again.model.natural_frequency_std_hz, model.natural_frequency_std_hz)
    np.testing.assert_array_equal(again.model.shapes, model.shapes if count else np.empty((0, 0)))
    assert again.model.outcome is model.outcome
    assert (again.model.flags, again.model.advice) == (model.flags, model.advice)
    assert again.model.settings == model.settings
