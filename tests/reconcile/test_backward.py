"""A name for a thing at a place needs one, where data are still missed: neither two places nor one off the aircraft."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.decision import backward
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.backward import nowhere
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed

ABSORBER = freed(Hypothesis(available_effects()["local-absorber"], {"x_m": 0.5, "y_m": 0.5}))
SOFT_ROOT = Hypothesis(available_effects()["root-compliance"], {"side": "right"})


def rival(x_m: float, y_m: float, hypothesis: Hypothesis = ABSORBER, name: str = "local-absorber") -> Any:
    """A fit of an effect at a place; the root has none."""
    values = {"x_m": (x_m, 0.01, "m"), "y_m": (y_m, 0.01, "m")} if hypothesis is ABSORBER else {}
    return SimpleNamespace(fit=SimpleNamespace(hypotheses=(hypothesis,), values=lambda k: values), name=name)


@pytest.mark.parametrize(
    ("winner", "equals", "none"),
    [
        (rival(0.5, 0.5), [], False),
        (rival(0.5, 0.5), [rival(0.55, 0.45)], False),
        (rival(0.5, 0.5), [rival(0.4, -0.5)], True),
        (rival(0.5, 0.5), [rival(0.4, -0.5, name="added-mass")], False),
        (rival(-0.6, 0.0), [], True),
        (rival(0.5, 1.7), [], True),
        (rival(0.0, 0.0, SOFT_ROOT, "root-compliance"), [], False),
    ],
)
def test_a_thing_has_one_place_on_the_aircraft(winner: Any, equals: list[Any], none: bool) -> None:
    assert nowhere(SimpleNamespace(winner=winner, equivalent=(winner, *equals))) is none  # type: ignore[arg-type]


@pytest.mark.parametrize(("adequate", "placeless", "kept"), [(False, True, 0), (True, True, 2), (False, False, 2)])
def test_without_one_it_gives_no_name_to_a_fit_that_misses_much(
    monkeypatch: pytest.MonkeyPatch, adequate: bool, placeless: bool, kept: int
) -> None:
    """Nor does what was named before it, where that has none either; what is left is what there was without them."""
    null: Any = SimpleNamespace(chi2_per_dof=20.0)
    things = tuple(SimpleNamespace(name=str(k)) for k in range(2))
    winners = [SimpleNamespace(fit=SimpleNamespace(hypotheses=things[: k + 1]), name=str(k)) for k in range(2)]
    begun = tuple(Addition(w, (), (f"tried beside {w.name}",), None) for w in winners)  # type: ignore[arg-type]
    monkeypatch.setattr(rounds, "residual", lambda fit, thresholds: SimpleNamespace(adequate=adequate, of=fit))
    monkeypatch.setattr(rounds, "needed", lambda found, current, thresholds: (found, current))
    asked = list[tuple[Any, ...]]()

    def asked_again(*given: Any, met: bool) -> Any:
        asked.append(given[:3])
        return given[0]

    monkeypatch.setattr(rounds, "reconsidered", asked_again)
    monkeypatch.setattr(rounds, "nowhere", lambda addition: placeless)
    null.problem = None
    found = rounds.attribute(null, (SOFT_ROOT,), SimpleNamespace(set_nats=5.0), most=2, begun=(null, begun, ()))
    assert len(found.rounds) == kept
    # What stays is asked again, beside the fit that stays.
    assert asked == [(list(found.rounds), found.final, (SOFT_ROOT,))]
    assert found.final is (winners[-1].fit if kept else null)
    assert list(found.vetoed) == ([] if kept else winners[::-1])
    # What has no name is judged by what was tried beside what stays.
    assert found.last_rivals == (f"tried beside {1 if kept else 0}",)


@pytest.mark.parametrize(
    ("line_by_line", "lasting", "stays"), [(20.0, 15.0, True), (20.0, 3.0, False), (3.0, 15.0, False)]
)
def test_an_earlier_name_stays_for_what_either_view_of_the_models_error_still_grants(
    monkeypatch: pytest.MonkeyPatch, line_by_line: float, lasting: float, stays: bool
) -> None:
    """Beside a later one it may be worth no more than an error of the model is."""
    things = tuple(SimpleNamespace(name=name, parameters=()) for name in ("first", "second"))
    whole: Any = SimpleNamespace(problem=None, hypotheses=things, u=None, e=np.zeros(0), evidence_nats=50.0, lasts=40.0)
    less: Any = SimpleNamespace(evidence_nats=50.0 - line_by_line, lasts=40.0 - lasting)
    monkeypatch.setattr(backward, "fit", lambda *given: less)
    monkeypatch.setattr(backward, "lasting_nats", lambda fit: fit.lasts)
    named: Any = ["first", "second"]
    kept = backward.needed(named, whole, SimpleNamespace(evidence_nats=9.0))
    assert kept == ((named, whole) if stays else (["second"], less))


def test_two_names_that_a_third_made_needless_both_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second is asked beside what is left once the first is gone."""
    things = tuple(SimpleNamespace(name=name, parameters=()) for name in ("first", "second", "third"))

    def model(hypotheses: Any) -> Any:
        return SimpleNamespace(problem=None, hypotheses=hypotheses, u=None, e=np.zeros(0), evidence_nats=50.0)

    monkeypatch.setattr(backward, "fit", lambda problem, kept, *rest: model(kept))
    monkeypatch.setattr(backward, "lasting_nats", lambda fit: 40.0)
    named: Any = ["first", "second", "third"]
    kept, left = backward.needed(named, model(things), SimpleNamespace(evidence_nats=9.0))  # type: ignore[arg-type]
    assert (kept, left.hypotheses) == (["third"], things[2:])
