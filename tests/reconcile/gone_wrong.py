"""A first search that names a relative of what is there, with real fits: only an exchange of names puts it right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from vgvt.effects import available_effects
from vgvt.reconcile import searches
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds


@dataclass(frozen=True)
class Named:
    """An effect with the values that its fit begins with."""

    name: str
    values: Mapping[str, float]
    settings: Mapping[str, Any]

    def beside(self, current: Fit) -> Rival:
        """A fit with this effect more, as a rival."""
        hypothesis = Hypothesis(available_effects()[self.name], dict(self.settings))
        start = np.concatenate([current.e, hypothesis.scores(dict(self.values))])
        return against(current, [fit(current.problem, (*current.hypotheses, hypothesis), current.u, start, FAR)])[0]


@dataclass(frozen=True)
class GoneWrong:
    """A ``relative`` named in the place of the ``right`` effect, which had convinced too, and another one beside it."""

    relative: Named
    right: Named
    other: Named

    def search(self, start: Fit, thresholds: Thresholds) -> Attribution:
        """What such a search holds."""
        relative, right = self.relative.beside(start), self.right.beside(start)
        other = self.other.beside(relative.fit)
        rounds = (
            Addition(relative, (relative,), (right, relative), start.held_out_chi2_per_dof),
            Addition(other, (other,), (other,), relative.held_out),
        )
        before, after = residual(start, thresholds), residual(other.fit, thresholds)
        return Attribution(start, before, rounds, other.fit, after, (other,), ())

    def first(self, monkeypatch: pytest.MonkeyPatch, *, exchanging: bool) -> None:
        """The first search is this one, those after it as ever; no name is exchanged unless ``exchanging``."""
        begun, real = list[int](), searches.attribute

        def wrong(start: Fit, asked: Any, thresholds: Thresholds, **rest: Any) -> Attribution:
            begun.append(1)
            return self.search(start, thresholds) if len(begun) == 1 else real(start, asked, thresholds, **rest)

        monkeypatch.setattr(searches, "attribute", wrong)
        if not exchanging:
            monkeypatch.setattr(searches, "exchanged", lambda *given: ())
