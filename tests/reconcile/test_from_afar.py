"""Where nothing near by comes to a name and something is left, a round looks from afar."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile.decision import attribute as rounds

THRESHOLDS: Any = SimpleNamespace(evidence_nats=9.0, set_nats=5.0)


def left_at(chi2_per_dof: float) -> Any:
    """A model without effects that leaves so much."""
    return SimpleNamespace(chi2_per_dof=chi2_per_dof, problem=None)


@pytest.mark.parametrize(
    ("near", "adequate", "swallowed", "looks"),
    [
        (3.0, False, False, [False, True]),
        (3.0, True, False, [False]),
        (3.0, False, True, [False]),
        (90.0, False, False, [False]),
    ],
)
def test_where_nothing_near_by_has_a_name_it_is_looked_for_from_afar(
    monkeypatch: pytest.MonkeyPatch, near: float, adequate: bool, swallowed: bool, looks: list[bool]
) -> None:
    """A loose surface promised -1e5 nats from a calibration that had moved seven deviations to imitate it.

    Not where the data are met, nor where something has a name, and what is bent is seen from afar as it is.
    """
    seen: list[bool] = []

    def tried(*given: Any, afar: bool = False) -> tuple[Any, ...]:
        seen.append(afar)
        return (gaining("loose surface", 650.0),) if afar else (gaining("cable", near),)

    monkeypatch.setattr(rounds, "swallowed", lambda current, before: swallowed)
    whatever_gains_enough(monkeypatch, tried, lambda fit: adequate)
    found = rounds.attribute(left_at(0.5), (), THRESHOLDS, most=1)
    assert seen == looks
    named = "loose surface" if looks[-1] else "cable" if near > THRESHOLDS.evidence_nats else None
    assert [a.winner.name for a in found.rounds] == ([] if named is None else [named])
    assert {"cable", "loose surface"} == {r.name for r in found.last_rivals} or not looks[-1]


@pytest.mark.parametrize("nats", [650.0, 3.0])
def test_what_only_led_to_a_better_valley_has_no_name_from_afar_either(
    monkeypatch: pytest.MonkeyPatch, nats: float
) -> None:
    """The calibration is begun anew where the best from afar arrived, and gains are counted from there."""
    better = left_at(0.3)

    def tried(*given: Any, afar: bool = False) -> tuple[Any, ...]:
        return (gaining("loose surface", 650.0),) if afar else ()

    whatever_gains_enough(monkeypatch, tried, lambda fit: fit is better)
    monkeypatch.setattr(rounds, "swallowed", lambda current, before: False)
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: better)
    monkeypatch.setattr(
        rounds,
        "against",
        lambda current, fits: tuple(gaining(f.name, nats if current is better else 650.0) for f in fits),
    )
    found = rounds.attribute(left_at(0.5), (), THRESHOLDS, most=1)
    assert found.null is better and found.null_residual.adequate
    assert [a.winner.name for a in found.rounds] == ["loose surface"] * (nats > THRESHOLDS.evidence_nats)


def gaining(name: str, nats: float) -> Any:
    """A rival that gains so much, whose fit meets the data and held-out ones."""
    fit = SimpleNamespace(name=name, nats=nats, chi2_per_dof=0.3)
    return SimpleNamespace(
        name=name, gain_nats=nats, fit=fit, held_out=0.3, convinces=lambda limits: nats >= limits.evidence_nats
    )


def whatever_gains_enough(monkeypatch: pytest.MonkeyPatch, tried: Any, adequate: Any) -> None:
    """Rounds that name what gains enough of what is ``tried``, held out or not, where a fit is not ``adequate``."""

    def left(fit: Any, thresholds: Any) -> Any:
        limits = SimpleNamespace(held_out_per_dof=1)
        return SimpleNamespace(
            adequate=adequate(fit),
            fitted_adequate=adequate(fit),
            held_out_chi2_per_dof=None,
            train_chi2_per_dof=0.5,
            limits=limits,
        )

    monkeypatch.setattr(rounds, "tried", tried)
    monkeypatch.setattr(rounds, "residual", left)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: null)
    monkeypatch.setattr(rounds, "distinct", list)
    monkeypatch.setattr(rounds, "against", lambda current, fits: tuple(gaining(f.name, f.nats) for f in fits))
    monkeypatch.setattr(rounds, "confirmed_by_held_out", lambda *given: True)
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "ended", lambda current, found, *given: tuple(found))
    monkeypatch.setattr(rounds, "straightened", lambda confirmed, set_nats: list(confirmed))
    monkeypatch.setattr(rounds, "likelier", lambda confirmed, equal: list(confirmed))
    monkeypatch.setattr(rounds, "plain_likenesses", lambda *given: ())
    monkeypatch.setattr(rounds, "controlled", lambda addition, *given: addition)
    monkeypatch.setattr(rounds, "needed", lambda found, current, thresholds: (found, current))
    monkeypatch.setattr(rounds, "nowhere", lambda addition: False)
    monkeypatch.setattr(rounds, "reconsidered", lambda found, *asked, met: found)


@pytest.mark.parametrize(("like", "asked"), [(("loose surface",), [["joint"]]), (("cable",), [["joint"]]), ((), [])])
def test_joints_that_a_name_from_afar_could_be_are_asked_then(
    monkeypatch: pytest.MonkeyPatch, like: tuple[str, ...], asked: list[list[str]]
) -> None:
    """What had passed near by, and took too little, had them asked for its own likenesses alone."""
    seen: list[list[str]] = []
    joint: Any = SimpleNamespace(name="joint", cls=SimpleNamespace(confused_with=like))

    def tried(*given: Any, afar: bool = False) -> tuple[Any, ...]:
        return (gaining("loose surface", 650.0),) if afar else (gaining("cable", 90.0),)

    def listed(current: Any, twins: Any, *given: Any) -> tuple[Any, ...]:
        seen.append([h.name for h in twins])
        return ()

    whatever_gains_enough(monkeypatch, tried, lambda fit: False)
    monkeypatch.setattr(rounds, "swallowed", lambda current, before: False)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: ([], [joint]))
    monkeypatch.setattr(rounds, "second_list", listed)
    monkeypatch.setattr(rounds, "fit_all", lambda *given, afar: ())
    monkeypatch.setattr(rounds, "takes_enough", lambda fit, *given: fit.name == "loose surface")
    found = rounds.attribute(left_at(0.5), (), THRESHOLDS, most=1)
    assert [a.winner.name for a in found.rounds] == ["loose surface"]
    # Of either look, and once.
    assert seen == asked
