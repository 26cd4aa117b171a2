"""What every effect of the catalogue does to A/F, as the loop foretells it, against the simulator's records."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question import data
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, problem_of
from vgvt.reconcile.search.candidates import candidates
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign

# Of what an effect does, and of A/F: at the end of a sweep records are worth three ten-thousandths.
_OF_THE_CHANGE, _OF_THE_WHOLE = 0.01, 4e-4
_WORDS = ("axis", "side", "shape", "kind")
# A clock of its own and lost samples are no filter of a spectrum, and nothing foretells them: the how-to says so.
# A soft stinger changes the force, and A/F by nothing but what a short record makes of less force.
_NOT_FORETOLD = {"clock-skew", "dropped-samples", "stinger-compliance"}


def variants(case: Problem, words: tuple[str, ...]) -> list[Hypothesis]:
    """One of each effect for every one of its settings of some words, as far out on a wing as there is."""
    catalogue: dict[str, Any] = available_effects()
    linear = {n: c for n, c in catalogue.items() if c.linear and n not in _NOT_FORETOLD}
    found: dict[tuple[object, ...], Hypothesis] = {}
    for h in sorted(candidates(case, linear), key=lambda h: -abs(h.settings.get("y_m", 0.0))):
        found.setdefault((h.name, *(h.settings.get(word) for word in words)), h)
    return list(found.values())


def sized(h: Hypothesis) -> dict[str, float]:
    """Values in the middle of the ranges; of what may have either sign, half of the largest."""
    middle = h.values(np.zeros(len(h.parameters)))
    return {p.name: 0.5 * p.high if middle[p.name] == 0 else middle[p.name] for p in h.parameters}


@pytest.mark.parametrize("words", [("axis",), pytest.param(_WORDS, marks=pytest.mark.slow)], ids=" ".join)
def test_every_effect_does_what_the_simulator_makes_it_do(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    """Base strain about the roll axis was foretold fifteen times as large as it is."""
    scenario = without_instrument_noise(roving_scenario())
    measured = data.measured_frfs(simulated_campaign(scenario, engine="linear"), lines=60)
    case = problem_of(measured, scenario)
    monkeypatch.setattr(data, "_chosen", lambda *given: measured.lines)
    u = np.zeros(case.size)
    u[case.unknowns.index(CELLS)] = -100.0  # as coarse a chain as the scenario says
    size = np.abs(measured.values)

    def foretold(there: Problem, hypotheses: tuple[Hypothesis, ...], e: Any) -> NDArray[np.complex128]:
        return anchor(there, u, hypotheses, e, slopes=False).predict(u, e) / size

    without, wrong, asked = foretold(case, (), np.zeros(0)), {}, variants(case, words)
    assert len({h.name for h in asked}) > 40
    for h in asked:
        values = sized(h)
        table = EffectTable(name=h.name, **h.settings, **values)
        with_it = simulated_campaign(scenario.model_copy(update={"effect": (table,)}), engine="linear")
        there = replace(case, measured=data.measured_frfs(with_it, lines=60))
        change = (there.measured.values - measured.values) / size
        missed = foretold(there, (h,), h.scores(values)) - without - change
        error, done = (float(np.sqrt(np.mean(np.abs(v) ** 2))) for v in (missed, change))
        if error > _OF_THE_CHANGE * done + _OF_THE_WHOLE:
            wrong[h.label] = f"{error:.2g} of {done:.2g}"
    assert wrong == {}
