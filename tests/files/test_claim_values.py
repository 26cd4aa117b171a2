"""A claim that someone else wrote: what may be left open is, and what no mode can have is told with its key."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.files.claim import Claim, claim_document, read_claim


def point(dof: str) -> dict[str, Any]:
    return {"dof": dof, "real": 1.0, "imag": 0.0}


def mode(**changes: Any) -> dict[str, Any]:
    """A mode of two DOFs, with other values for some of its keys."""
    return {"frequency_hz": 8.0, "damping_ratio": 0.01, "shape": [point("1+Z"), point("2+Z")], **changes}


def read(folder: Path, **changes: Any) -> Claim:
    """The claim of a file with the least that one must say, and ``changes``."""
    document = {"identifier": "x", "band_hz": [3, 35], "modes": [mode()], **changes}
    path = folder / "claim.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return read_claim(path)


def test_what_is_null_is_not_known(tmp_path: Path) -> None:
    keys = ("settings", "advice", "method", "campaign", "residues", "candidates", "output_only")
    open_mode = mode(frequency_std_hz=None, damping_ratio=None, damping_ratio_std=None, label=None, flags=None)
    claim = read(tmp_path, modes=[open_mode], **dict.fromkeys(keys))
    model = claim.model
    assert (model.settings, model.advice, model.method, claim.campaign) == ({}, (), "", "")
    assert (model.residues, model.candidates, model.labels, model.flags) == (None, (), ("",), ((),))
    assert model.output_only is False
    assert np.isnan([model.damping_ratio[0], model.natural_frequency_std_hz[0], model.damping_ratio_std[0]]).all()


def test_a_claim_without_the_force_says_so_in_its_file(tmp_path: Path) -> None:
    claim = read(tmp_path, output_only=True)
    assert claim.model.output_only
    assert claim_document(claim)["output_only"] is True
    assert claim_document(read(tmp_path))["output_only"] is False


@pytest.mark.parametrize("ratio", [-0.3, -1e-6, 0.0, 0.999])
def test_an_unstable_pole_is_a_claim_like_any_other(tmp_path: Path, ratio: float) -> None:
    assert read(tmp_path, modes=[mode(damping_ratio=ratio)]).model.damping_ratio[0] == ratio


HUGE = 10**400


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"identifier": None}, "identifier: expected text, got None"),
        ({"settings": []}, r"settings: expected an object, got \[\]"),
        ({"advice": "hello"}, "advice: expected a list of texts, got 'hello'"),
        ({"method": 3}, "method: expected text, got 3"),
        ({"output_only": "yes"}, "output_only: expected true or false, got 'yes'"),
        ({"band_hz": [3, float("inf")]}, r"band_hz: expected \[low, high\]"),
        ({"band_hz": [False, True]}, r"band_hz: expected \[low, high\]"),
        ({"band_hz": [3, HUGE]}, r"band_hz: expected \[low, high\]"),
        ({"candidates": 3}, "candidates: expected a list of poles"),
        ({"candidates": [{"frequency_hz": 8.0, "damping_ratio": 0.1, "order": 2.5, "kept": True}]}, "whole number"),
        ({"candidates": [{"frequency_hz": 8.0, "damping_ratio": 0.1, "order": 2, "kept": "no"}]}, "true or false"),
        (
            {"residues": {"references": ["9+Z"], "real_m_per_n_s": [[[HUGE], [1]]], "imag_m_per_n_s": [[[1], [1]]]}},
            "residues: real_m_per_n_s is no list of numbers",
        ),
        (
            {"residues": {"references": ["9+Z", "9-Z"], "real_m_per_n_s": [[[1, 1]] * 2]}},
            "residues: a reference is listed twice",
        ),
    ],
)
def test_a_wrong_value_is_told_with_its_key(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=rf"claim\.json: .*{words}"):
        read(tmp_path, **changes)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"flags": 3}, "flags: expected a list of texts, got 3"),
        ({"flags": [3]}, "flags: expected a list of texts"),
        ({"label": ["a"]}, "label: expected text"),
        ({"frequency_hz": HUGE}, r"frequency_hz: expected a number, got 1000.*\.\.\."),
        ({"frequency_hz": True}, "frequency_hz: expected a number, got True"),
        ({"frequency_hz": -8.0}, "frequency_hz: expected a number of at least 0, got -8"),
        ({"frequency_std_hz": -1.0}, "frequency_std_hz: expected a number of at least 0"),
        ({"damping_ratio_std": -1.0}, "damping_ratio_std: expected a number of at least 0"),
        ({"damping_ratio": 1.0}, r"damping_ratio: expected a fraction .*not per cent.*got 1\n"),
        ({"damping_ratio": -1.5}, "damping_ratio: expected a fraction"),
        ({"shape": [point("1+Z"), point("1+Z")]}, r"shape: 1\+Z and 1\+Z are one DOF"),
        ({"shape": [point("1+Z"), point("1-Z")]}, r"shape: 1\+Z and 1-Z are one DOF"),
    ],
)
def test_a_wrong_value_of_a_mode_is_told_with_its_key(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=rf"claim\.json: modes\[0\]\.{words}"):
        read(tmp_path, modes=[mode(**changes)])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"identifier": ' + "[" * 100_000, "nested too deeply"),
        ('{"identifier": ' + "9" * 10_000 + "}", "not a JSON document"),
        ("[]", "a claim is a JSON object"),
        ("{", "not a JSON document"),
    ],
)
def test_a_document_that_is_no_claim(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "claim.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_claim(path)
