"""What the page shows stands in ``verdict.json``, too: channels, calibrated quantities, every candidate."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from account_by_hand import account

from vgvt.view.reconcile_document import account_document


def document(told: Any = None) -> Any:
    """As it is read back: plain values alone."""
    return json.loads(json.dumps(account_document(told or account()), allow_nan=False))


def test_each_channel_says_what_it_was_for_and_what_is_left_of_it() -> None:
    """A prediction that is wrong by a tenth of a channel everywhere: its χ² by hand, and those of its bands."""
    told = account()
    wrong = told.measured * np.array([1.0, 1.1, 1.0, 1.0])[:, None]
    told = replace(
        told, before=replace(told.before, predicted=wrong), after=replace(told.after, predicted=told.measured)
    )
    found = document(told)
    assert found["hold_out"] == {"channels": ["run 1, 2+Z"], "runs": ["run 2, 1+Z", "run 2, 2+Z"], "turned": False}
    assert [c["held_out"] for c in found["channels"]] == [None, "channel", "run", "run"]
    assert [c["channel"] for c in found["channels"]] == [c.label for c in told.channels]
    left = found["channels"][1]["before"]
    wanted = np.mean((0.1 * np.abs(told.measured[1]) / told.sigma[1]) ** 2)
    assert left["chi2_per_dof"] == pytest.approx(wanted)
    spread = np.linalg.norm(told.measured[1] - told.measured[1].mean())
    assert left["nrmse_percent"] == pytest.approx(100 * (1 - 0.1 * np.linalg.norm(told.measured[1]) / spread))
    assert left["by_band"] == pytest.approx(told.before.table[1].tolist())
    assert len(found["bands_hz"]) == len(left["by_band"]) + 1
    assert found["channels"][0]["before"]["chi2_per_dof"] == found["channels"][1]["after"]["chi2_per_dof"] == 0.0


def test_a_band_without_a_line_is_null() -> None:
    told = account()
    table = np.where(np.arange(told.before.table.shape[1]) == 0, np.nan, told.before.table)
    found = document(replace(told, before=replace(told.before, table=table)))
    assert found["channels"][2]["before"]["by_band"][0] is None


def test_every_candidate_stands_there_with_what_became_of_it() -> None:
    told = account()
    again = replace(told.candidates[1], round=2, standing="beaten", converged=False)
    found = document(replace(told, candidates=(*told.candidates, again)))["candidates"]
    assert [(c["round"], c["standing"]) for c in found] == [
        (1, "named"), (1, "equivalent"), (1, "too little evidence"), (1, "refused by held-out data"), (2, "beaten"),
    ]  # fmt: skip
    assert found[0]["fitted"] == "mass_kg 0.05 kg" and found[0]["held_out"] == 1.1 and found[-1]["converged"] is False


def test_what_was_calibrated_stands_there_in_deviations_and_in_words() -> None:
    found = document()
    assert found["calibrated"][0] == {
        "name": "EI wing", "what": "EI of the wing", "score": -4.2, "std_score": 0.3, "change": "× 0.66 ± 0.02",
        "stated": None, "calibrated": None, "factor": None, "factor_std": None, "shift": None, "shift_std": None,
        "stated_value": None, "calibrated_value": None, "calibrated_value_std": None, "unit": "",
    }  # fmt: skip
    assert found["calibrated"][1]["calibrated"] == "0.6355 m"
    assert found["modes"][0]["after_hz"] == 15.0 and found["located_at"] == "the calibrated scenario"


def test_what_was_calibrated_stands_there_in_numbers_with_their_unit() -> None:
    """Words round "× 1.0002" to "× 1", and a number in a string has to be taken apart."""
    told = account()
    figures = {"factor": 1.000179, "factor_std": 0.0046, "stated": 0.0028, "calibrated": 0.0028005}
    row = replace(told.posterior[1], figures=figures | {"calibrated_std": 1.3e-5}, unit="kg")
    (found,) = document(replace(told, posterior=(row,)))["calibrated"]
    assert (found["factor"], found["factor_std"], found["shift"]) == (1.000179, 0.0046, None)
    assert (found["stated_value"], found["calibrated_value"], found["calibrated_value_std"], found["unit"]) == (
        0.0028, 0.0028005, 1.3e-5, "kg",
    )  # fmt: skip
    assert found["stated"] == "0.635 m"


def test_the_contract_s_page_lists_every_key(repository_root: Path) -> None:
    page = (repository_root / "docs/reference/json-contract.md").read_text(encoding="utf-8")
    verdict = page.split("## A verdict", 1)[1].split("\n## ", 1)[0]
    found = document()
    keys = {*found, *found["hold_out"], *found["channels"][0], *found["channels"][0]["before"]}
    keys |= {key for name in ("calibrated", "candidates", "modes") for key in found[name][0]}
    assert not {key for key in keys if not re.search(rf"`{key}`", verdict)}
