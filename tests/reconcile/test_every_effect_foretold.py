"""What every effect of the catalogue does to A/F, as the loop foretells it, against the simulator's records."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
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
# Of a channel's median.
_SHALLOW = 0.05
_PAIRS = 40
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


class Laboratory:
    """A campaign without effects, and what the loop and the simulator say of it with some, as shares of A/F (C, L)."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.scenario = without_instrument_noise(roving_scenario())
        self.measured = data.measured_frfs(simulated_campaign(self.scenario, engine="linear"), lines=60)
        self.case = problem_of(self.measured, self.scenario)
        monkeypatch.setattr(data, "_chosen", lambda *given: self.measured.lines)
        self.u = np.zeros(self.case.size)
        self.u[self.case.unknowns.index(CELLS)] = -100.0  # as coarse a chain as the scenario says
        # How deep an antiresonance is, is no measure: half of an error's square had been at two lines of one.
        size = np.abs(self.measured.values)
        self.size = np.maximum(size, _SHALLOW * np.median(size, axis=1, keepdims=True))
        self.without = self.foretold(self.case, (), np.zeros(0))

    def foretold(self, there: Problem, hypotheses: tuple[Hypothesis, ...], e: Any) -> NDArray[np.complex128]:
        """What the loop foretells."""
        return anchor(there, self.u, hypotheses, e, slopes=False).predict(self.u, e) / self.size

    def missed(self, *hypotheses: Hypothesis) -> str:
        """By how much what some effects do is foretold wrongly, if it is."""
        values = [sized(h) for h in hypotheses]
        tables = tuple(EffectTable(name=h.name, **h.settings, **v) for h, v in zip(hypotheses, values, strict=True))
        with_them = simulated_campaign(self.scenario.model_copy(update={"effect": tables}), engine="linear")
        there = replace(self.case, measured=data.measured_frfs(with_them, lines=60))
        change = (there.measured.values - self.measured.values) / self.size
        e = np.concatenate([h.scores(v) for h, v in zip(hypotheses, values, strict=True)])
        missed = self.foretold(there, hypotheses, e) - self.without - change
        error, done = (float(np.sqrt(np.mean(np.abs(v) ** 2))) for v in (missed, change))
        return f"{error:.2g} of {done:.2g}" if error > _OF_THE_CHANGE * done + _OF_THE_WHOLE else ""


@pytest.mark.parametrize(("words", "every"), [(("axis",), 3), pytest.param(_WORDS, 1, marks=pytest.mark.slow)])
def test_every_effect_does_what_the_simulator_makes_it_do(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], every: int
) -> None:
    """Base strain about the roll axis was foretold fifteen times as large as it is. A third of them by default."""
    laboratory = Laboratory(monkeypatch)
    asked = variants(laboratory.case, words)
    assert len({h.name for h in asked}) > 40
    assert {h.label: wrong for h in asked[::every] if (wrong := laboratory.missed(h))} == {}


@pytest.mark.slow
def test_so_do_two_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Edits of one scenario, elements beside each other, runs of several structures: a sample of all 1035 pairs."""
    laboratory = Laboratory(monkeypatch)
    one = {h.name: h for h in variants(laboratory.case, ())}
    pairs = list(combinations(one.values(), 2))
    chosen = np.random.default_rng(7).choice(len(pairs), _PAIRS, replace=False)
    wrong = {f"{a.label} and {b.label}": laboratory.missed(a, b) for a, b in (pairs[k] for k in chosen)}
    assert {label: how for label, how in wrong.items() if how} == {}
