"""With a campaign, what could be seen is said beside what was named: the model without it may be no model at all."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from account_by_hand import account
from reconciled_case import problem

from vgvt.cli.reconcile import _power
from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.view.reconcile_page import render_reconcile_page
from vgvt.view.reconcile_sections import power_section

KNOWN = available_effects()
HEAVY = Hypothesis(KNOWN["added-mass"], {"x_m": 0.9, "y_m": 1.1})
TRANSDUCER = Hypothesis(KNOWN["transducer-mass"])


@pytest.fixture(scope="module")
def ends(tmp_path_factory: pytest.TempPathFactory) -> tuple[Fit, Fit]:
    """The model without a mass of 0.3 kg, as stated, and the one with it."""
    case = problem(tmp_path_factory.mktemp("beside"), 1)
    stated = np.zeros(case.size)
    null = fit(case, (), stated, np.zeros(0), ())
    return null, fit(case, (HEAVY,), stated, HEAVY.scores({"mass_kg": 0.3}), ())


def asked(null: Fit, final: Fit) -> tuple[Any, ...]:
    verdict: Any = SimpleNamespace(attribution=SimpleNamespace(null=null, final=final), thresholds=stored_thresholds())
    return _power(verdict, (HEAVY, TRANSDUCER), lambda fraction, message: None)


def test_power_stands_on_the_model_with_its_names(ends: tuple[Fit, Fit]) -> None:
    """A mass at the tip moves every peak: the size of a mass on the gauge that shows is another one."""
    null, final = ends
    (beside,) = asked(null, final)
    (without, with_it) = (power(f, (TRANSDUCER,), None, stored_thresholds())[0] for f in (null, final))
    assert (beside.effect, beside.smallest, beside.named) == ("transducer-mass", with_it.smallest, with_it.named)
    assert abs(np.log(without.smallest / beside.smallest)) > 0.02
    # Where nothing was named everything is asked.
    assert [p.effect for p in asked(null, null)] == ["added-mass", "transducer-mass"]


def test_the_page_says_beside_what_it_stands() -> None:
    rows = account().power
    assert "Beside " not in power_section(rows)
    told = power_section(rows, ["added-mass"])
    assert "Beside what was named (added-mass), which is in the model and has no row here." in told
    assert power_section((), ["added-mass"]) == ""
    assert "Beside what was named" in render_reconcile_page(account("explained"))
