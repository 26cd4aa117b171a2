"""Fits that may give their name are gone on with to their ends before they are compared, and no others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision import last_steps
from vgvt.reconcile.fitting import finished
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.shortlist import BIASED

NEEDS: Any = SimpleNamespace(set_nats=5.0, evidence_nats=9.0)
NULL: Any = None
MASS = Hypothesis(available_effects()["added-mass"])
AIR = Hypothesis(available_effects()["entrained-air"])


def told(fraction: float, message: str) -> None:
    pass


def rival(
    name: str,
    gain_nats: float,
    held_out: float | None = None,
    left: float = 0.8,
    arrived: bool = True,
    effect: Any = MASS,
    lasting: float = 100.0,
) -> Any:
    fit = SimpleNamespace(name=name, converged=arrived, chi2_per_dof=left, hypotheses=(effect,))
    return SimpleNamespace(name=name, fit=fit, gain_nats=gain_nats, lasting_nats=lasting, held_out=held_out)


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """The names of the fits that were judged together, those gone on with marked."""
    seen: list[tuple[str, ...]] = []

    def against(current: Any, fits: Any) -> Any:
        seen.append(tuple(f.name for f in fits))
        return ("judged",)

    monkeypatch.setattr(last_steps, "against", against)
    monkeypatch.setattr(last_steps, "distinct", list)

    def gone_on(word: str) -> Any:
        return lambda found, *_, **__: SimpleNamespace(**{**vars(found), "name": f"{found.name}, {word}"})

    monkeypatch.setattr(last_steps, "finished", gone_on("ended"))
    monkeypatch.setattr(last_steps, "leaner", gone_on("leaner"))
    return seen


def test_a_fit_is_gone_on_with_unless_it_has_arrived_or_becomes_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    further: Any = SimpleNamespace(evidence_nats=30.0, converged=True)
    monkeypatch.setattr(finished, "fit", lambda *given, exact, follow: further)
    monkeypatch.setattr(finished, "origin_at", lambda *_: None)
    monkeypatch.setattr(finished, "depends_on_level", lambda problem, hypothesis: False)
    effect = SimpleNamespace(name="it")
    known: dict[str, Any] = {"problem": None, "hypotheses": (effect,), "u": None, "e": None, "followed": False}
    stopped: Any = SimpleNamespace(converged=False, evidence_nats=20.0, **known)
    assert finished.finished(stopped, told) is further
    arrived: Any = SimpleNamespace(converged=True, **known)
    assert finished.finished(arrived, told) is arrived
    further.evidence_nats = 10.0
    assert finished.finished(stopped, told) is stopped


def test_two_starts_that_meet_at_their_end_are_one_rival(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else what is named stood beside itself, as what explains the data as well."""

    def at(size: float, evidence_nats: float) -> Any:
        fit = SimpleNamespace(hypotheses=(AIR,), e=np.array([size]), evidence_nats=evidence_nats, converged=False)
        return SimpleNamespace(fit=fit, gain_nats=evidence_nats, lasting_nats=evidence_nats, held_out=None)

    low, high, elsewhere = at(0.4, 20.0), at(0.9, 19.0), at(5.0, 18.0)
    ends = {0.4: at(0.61, 24.0).fit, 0.9: at(0.6, 25.0).fit, 5.0: at(5.0, 22.0).fit}
    monkeypatch.setattr(last_steps, "_in_reach", lambda confirmed, set_nats: {id(r) for r in confirmed})
    monkeypatch.setattr(last_steps, "_at_its_end", lambda found, tell: ends[float(found.e[0])])
    monkeypatch.setattr(last_steps, "against", lambda current, fits: tuple(fits))
    rivals = (low, high, elsewhere)
    assert last_steps.ended(NULL, rivals, rivals, NEEDS, told) == (ends[0.9], ends[5.0])


@pytest.mark.parametrize("converged", [True, False])
def test_rivals_at_their_ends_are_judged_together(judged: list[tuple[str, ...]], converged: bool) -> None:
    """What a fit is worth follows from the best of them: one judged by itself could not be compared."""
    first, near, behind = rival("first", 100.0), rival("near", 92.0), rival("behind", 80.0, arrived=False)
    refused = rival("refused", 101.0, arrived=converged)
    # Held-out data may have refused what had not arrived yet, were other rivals confirmed or not.
    said = "refused" if converged else "refused, ended"
    rivals = (refused, first, near, behind)
    assert last_steps.ended(NULL, rivals, (first, near, behind), NEEDS, told) == ("judged",)
    assert judged.pop() == (said, "first, ended", "near, ended", "behind")
    last_steps.ended(NULL, rivals, (), NEEDS, told)
    assert judged.pop() == (said, "first", "near", "behind")


@pytest.mark.parametrize(
    ("left", "ended"),
    [
        (BIASED - 0.1, ("most, ended", "as good", "may yet", "far")),
        (BIASED + 0.1, ("most, ended", "as good, ended", "may yet, ended", "far")),
    ],
)
def test_where_held_out_data_decide_all_that_they_may_prefer_are_ended(
    judged: list[tuple[str, ...]], left: float, ended: tuple[str, ...]
) -> None:
    """A surge stopped on its way missed held-out data by 30, at its end by 27, where the winner missed them by 26."""
    rows = (("most", 900.0, 25.7), ("as good", 400.0, 27.0), ("may yet", 300.0, 30.1), ("far", 200.0, 60.0))
    confirmed = [rival(*row, left=left) for row in rows]
    last_steps.ended(NULL, confirmed, confirmed, NEEDS, told)
    assert judged == [ended]


def test_what_lasts_refuses_nothing_for_a_size_that_it_does_not_need(judged: list[tuple[str, ...]]) -> None:
    """Air's drag alone gained 26 nats, 13 where errors last; with its mass, which was not there, 19 and 6: no name."""
    marched: Any = SimpleNamespace(linear=False, parameters=AIR.parameters)
    rivals = [
        rival("air", 19.0, effect=AIR, lasting=6.0),
        rival("mass", 12.0, lasting=4.0),
        rival("march", 12.0, effect=marched, lasting=4.0),
        rival("less air", 8.0, effect=AIR, lasting=4.0),
        rival("air beside more", 12.0, effect=AIR, lasting=4.0, left=BIASED),
        rival("named air", 12.0, effect=AIR),
    ]
    rest = ("mass", "march", "less air", "air beside more")
    last_steps.ended(NULL, rivals, (), NEEDS, told)
    assert judged.pop() == ("air, ended, leaner", *rest, "named air")
    last_steps.ended(NULL, rivals, (rivals[-1],), NEEDS, told)
    assert judged.pop() == ("air, ended, leaner", *rest, "named air, ended, leaner")
