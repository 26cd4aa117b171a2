"""The fits of a round's short list: which begin anew, and what lies beside them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile.decision import fitted_list


@pytest.mark.parametrize(
    ("afar", "leaves", "named", "anew"),
    [
        (True, 10.0, (), True),
        (True, 0.8, (), False),
        (False, 1.6, (), False),
        (True, 1.6, (), True),
        (True, 10.0, ("an effect",), False),
    ],
)
def test_candidates_begin_anew_where_a_first_round_leaves_much(
    monkeypatch: pytest.MonkeyPatch, afar: bool, leaves: float, named: tuple[str, ...], anew: bool
) -> None:
    """From where peaks overlap, those that were screened, with the least that a fit has left."""
    current: Any = SimpleNamespace(evidence_nats=0.0, chi2=1000.0, hypotheses=named)
    chosen: Any = [SimpleNamespace(hypothesis=name, gain_nats=1.0, upright=False) for name in ("first", "second")]
    left = iter((leaves + 5.0, leaves))

    def fitted(*args: Any) -> Any:
        chi2 = next(left)
        return SimpleNamespace(evidence_nats=1.0, chi2_per_dof=chi2, chi2=100 * chi2)

    seen: list[Any] = []

    def begun(current: Any, screened: Any, best: float, tell: Any, team: Any) -> list[str]:
        seen.append(([s.hypothesis for s in screened], best))
        return ["begun anew"]

    monkeypatch.setattr(fitted_list, "finalists", lambda current, chosen, tell, team: tuple(chosen))
    monkeypatch.setattr(fitted_list, "fitted_from", fitted)
    monkeypatch.setattr(fitted_list, "begun_anew", begun)
    monkeypatch.setattr(fitted_list, "best_course", lambda found, hypotheses: found)
    monkeypatch.setattr(fitted_list, "distinct", list)
    monkeypatch.setattr(fitted_list, "in_other_courses", lambda *given: [])
    monkeypatch.setattr(fitted_list, "at_next_items", lambda *given, placed: [])
    monkeypatch.setattr(fitted_list, "against", lambda current, fits: tuple(fits))
    rivals = fitted_list.fit_all(current, chosen, (), lambda fraction, message: None, afar=afar)
    assert (rivals[-1] == "begun anew") is anew
    assert seen == ([(["first", "second"], 100 * leaves)] if anew else [])


@pytest.mark.parametrize("far", [False, True])
def test_what_lies_beside_the_fits_of_a_round_is_among_its_rivals(monkeypatch: pytest.MonkeyPatch, far: bool) -> None:
    """Other courses of a change, and other items of a thing, of all that was fitted before them.

    Far off, what swings at a place may be an item that is there.
    """
    current: Any = SimpleNamespace(evidence_nats=0.0, chi2=1000.0, hypotheses=("an effect",))
    chosen: Any = [SimpleNamespace(hypothesis="first", gain_nats=1.0, upright=False)]
    first = SimpleNamespace(evidence_nats=1.0, chi2_per_dof=0.8, chi2=80.0)
    seen: list[list[Any]] = []

    def beside(more: str) -> Any:
        def asked(current: Any, found: Any, hypotheses: Any, tell: Any, team: Any, **placed: bool) -> list[str]:
            seen.append(list(found))
            assert placed == ({"placed": far} if more == "an item" else {})
            return [more]

        return asked

    monkeypatch.setattr(fitted_list, "fitted_from", lambda *_: first)
    monkeypatch.setattr(fitted_list, "in_other_courses", beside("a course"))
    monkeypatch.setattr(fitted_list, "at_next_items", beside("an item"))
    monkeypatch.setattr(fitted_list, "best_course", lambda found, hypotheses: found)
    monkeypatch.setattr(fitted_list, "distinct", list)
    monkeypatch.setattr(fitted_list, "against", lambda current, fits: tuple(fits))
    monkeypatch.setattr(fitted_list, "finalists", lambda current, chosen, tell, team: tuple(chosen))
    rivals = fitted_list.fit_all(current, chosen, (), lambda fraction, message: None, afar=far)
    assert rivals == (first, "a course", "an item")
    assert seen == [[first], [first, "a course"]]
