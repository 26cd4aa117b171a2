"""A name gives way to another that does better beside the others, and the search goes on from there."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.decision import exchanged as module
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.exchanged import exchanged, leads_further
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Thresholds, stored_thresholds

LIMITS = stored_thresholds()
Gains = dict[frozenset[str], float]


def thing(name: str, linear: bool = True) -> Any:
    """An effect with one parameter."""
    return SimpleNamespace(name=name, linear=linear, parameters=("size",))


def fit_of(*names: str, linear: bool = True, e: Any = None) -> Any:
    """A fit of some effects, the score of each its place among them."""
    scores = np.arange(len(names), dtype=float) if e is None else e
    return SimpleNamespace(
        problem=None, hypotheses=tuple(thing(n, linear) for n in names), e=scores, u=np.zeros(1), chi2=100.0,
        evidence_nats=0.0, held_out_chi2_per_dof=7.0,
    )  # fmt: skip


def names_of(fit: Any) -> list[str]:
    return [h.name for h in fit.hypotheses]


class FakeRival(SimpleNamespace):
    """What a fit adds last, and what that gains."""

    def convinces(self, thresholds: Thresholds) -> bool:
        return bool(self.gain_nats >= thresholds.evidence_nats)


def rival_of(fit: Any, nats: float) -> Any:
    return FakeRival(fit=fit, name=fit.hypotheses[-1].name, hypothesis=fit.hypotheses[-1], gain_nats=nats)


def rival(*names: str, nats: float, linear: bool = True) -> Any:
    return rival_of(fit_of(*names, linear=linear), nats)


def search(*rounds: tuple[Any, list[Any]], adequate: bool = False) -> Any:
    """What a search found: of each round the winner, and the other rivals."""
    made = tuple(Addition(w, (w,), (w, *others), 5.0) for w, others in rounds)
    final = made[-1].winner.fit if made else fit_of()
    return SimpleNamespace(rounds=made, final=final, null=fit_of(), final_residual=SimpleNamespace(adequate=adequate))


def absorber_and_mount(*others: Any, second: tuple[Any, ...] = ()) -> Any:
    """Two names, with what had lost to the first one, and to the second."""
    return search((rival("absorber", nats=100.0), list(others)), (rival("absorber", "mount", nats=60.0), list(second)))


@pytest.fixture(autouse=True)
def held_out(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether held-out data let what is ahead be: they do, unless a test says otherwise."""
    lets = [True]
    monkeypatch.setattr(module, "not_spoken_against", lambda found, names: lets[0])
    return lets


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """The models that were fitted, in order."""
    found: list[tuple[str, ...]] = []

    def fitted(problem: Any, hypotheses: Any, u: Any, e: Any, *rest: Any) -> Any:
        names = tuple(h.name for h in hypotheses)
        found.append(names)
        return fit_of(*names, e=e)

    monkeypatch.setattr(module, "fit_unless_behind", fitted)
    monkeypatch.setattr(module, "fit", fitted)
    monkeypatch.setattr(module, "implausible", lambda fit: ())
    monkeypatch.setattr(module, "as_good", lambda other, winner, nats: "spoken" not in names_of(other))
    monkeypatch.setattr(module, "controlled", lambda addition, *rest: addition)
    return found


def judged_by(monkeypatch: pytest.MonkeyPatch, gains: Gains) -> None:
    """What some effects together gain over none; evidence alike."""
    gains = {frozenset(): 0.0} | gains

    def nats(fit: Any) -> float:
        return gains[frozenset(h.name for h in fit.hypotheses)]

    def against(current: Any, fits: Any) -> tuple[Any, ...]:
        for f in fits:
            f.evidence_nats = nats(f)
        judged = [rival_of(f, nats(f) - nats(current)) for f in fits]
        return tuple(sorted(judged, key=lambda r: -r.gain_nats))

    monkeypatch.setattr(module, "against", against)
    alone = module._of_these

    def known(found: Any, chosen: Any, tell: Any) -> Any:
        there = alone(found, chosen, tell)
        if there is not None:
            there.evidence_nats = nats(there)
        return there

    monkeypatch.setattr(module, "_of_these", known)


def of(**nats: float) -> Gains:
    return {frozenset(names.split("_")): n for names, n in nats.items()}


def test_what_is_ahead_in_its_place_is_begun_from_what_does_best_alone(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]
) -> None:
    case = absorber_and_mount(rival("strain", nats=80.0), rival("mount", nats=90.0))
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=80.0))
    rounds = exchanged(case, LIMITS)
    # What is named already is not offered in the place of another.
    assert asked == [("mount", "strain"), ("mount",), ("strain",), ("mount", "strain")]
    assert [a.winner.name for a in rounds] == ["mount", "strain"]
    assert [a.winner.gain_nats for a in rounds] == [90.0, 110.0]
    assert all(a.equivalent == (a.winner,) and a.held_out_before == 7.0 for a in rounds)
    # All that the first round had compared is there to be shown, the winner as it is judged now.
    assert [r.name for r in rounds[0].rivals] == ["absorber", "mount", "strain"]
    assert rounds[1].rivals == (rounds[1].winner,)


def test_what_each_had_been_fitted_with_is_where_it_begins(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]
) -> None:
    strain = rival_of(fit_of("strain", e=np.array([3.5])), 80.0)
    case = absorber_and_mount(strain)
    case.final.e[:] = [1.5, 2.5]
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=95.0))
    first, second = exchanged(case, LIMITS)
    np.testing.assert_array_equal(first.winner.fit.e, [3.5])
    np.testing.assert_array_equal(second.winner.fit.e, [3.5, 2.5])


def test_the_last_name_may_give_way_too(monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]) -> None:
    case = absorber_and_mount(second=(rival("absorber", "delay", nats=50.0),))
    judged_by(monkeypatch, of(absorber_mount=160.0, absorber_delay=170.0, absorber=100.0, delay=20.0))
    assert [a.winner.name for a in exchanged(case, LIMITS)] == ["absorber", "delay"]


@pytest.mark.parametrize(
    ("other", "behind", "stands"), [("twin", 0.1, True), ("twin", -0.1, False), ("spoken", 3.0, False)]
)
def test_what_does_as_well_in_the_same_place_stands_beside_the_new_name(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]], other: str, behind: float, stands: bool
) -> None:
    """Within what the data leave open, and where held-out data do not tell the two."""
    case = absorber_and_mount(rival("strain", nats=80.0), rival(other, nats=70.0))
    gains = of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=80.0)
    gains |= {frozenset(("mount", other)): 200.0 - LIMITS.set_nats + behind}
    judged_by(monkeypatch, gains)
    first, second = exchanged(case, LIMITS)
    assert [a.winner.name for a in (first, second)] == ["mount", "strain"]
    assert first.in_its_place == ()
    assert [names_of(r.fit) for r in second.in_its_place] == [["mount", "strain"], ["mount", other]] * stands


def test_what_does_as_well_in_another_place_is_no_other_answer(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]
) -> None:
    """A strain and the mount, or the absorber and a delay: no name stands in the place of another."""
    case = absorber_and_mount(rival("strain", nats=80.0), second=(rival("absorber", "delay", nats=50.0),))
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, absorber_delay=199.0, mount=90.0, strain=80.0))
    assert [a.in_its_place for a in exchanged(case, LIMITS)] == [(), ()]


@pytest.mark.parametrize(("more", "gives_way"), [(-0.1, False), (0.1, True)])
def test_a_hair_is_not_ahead(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]], more: float, gives_way: bool
) -> None:
    both = 160.0 + LIMITS.set_nats + more
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=both, mount=90.0, strain=80.0))
    assert bool(exchanged(absorber_and_mount(rival("strain", nats=80.0)), LIMITS)) is gives_way


def test_each_must_gain_a_name(monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]) -> None:
    """Ahead of two others together, and of one of the two alone by less than a name needs."""
    alone = 200.0 - LIMITS.evidence_nats + 0.1
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=alone, strain=80.0))
    assert exchanged(absorber_and_mount(rival("strain", nats=80.0)), LIMITS) == ()


def test_only_what_came_near_is_asked(monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]) -> None:
    """Of each round the best of two other linear effects that convinced, and gained a quarter of what the name did."""
    case = absorber_and_mount(
        rival("absorber", nats=99.0), rival("play", nats=90.0, linear=False), rival("strain", nats=80.0),
        rival("strain", nats=85.0), rival("little", nats=24.0), rival("a", nats=50.0), rival("b", nats=40.0),
        second=(rival("absorber", "none", nats=LIMITS.evidence_nats - 0.1),),
    )  # fmt: skip
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=0.0, mount_a=0.0))
    assert exchanged(case, LIMITS) == ()
    assert asked == [("mount", "strain"), ("mount", "a")]


def test_what_was_found_in_its_place_is_asked_before_the_rivals_of_its_round(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]
) -> None:
    """No round had tried it; and a name that is alone may give way to it, too."""
    case = absorber_and_mount(rival("a", nats=50.0), rival("b", nats=40.0))
    found = replace(
        case.rounds[0], in_its_place=(rival("mount", "absorber", nats=100.0), rival("mount", "strain", nats=99.0))
    )
    case.rounds = (found, case.rounds[1])
    judged_by(
        monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=80.0, mount_a=0.0, mount_b=0.0)
    )
    assert [a.winner.name for a in exchanged(case, LIMITS)] == ["mount", "strain"]
    assert asked[:3] == [("mount", "strain"), ("mount", "a"), ("mount", "b")]
    asked.clear()
    alone = search((rival("absorber", nats=100.0), [rival("a", nats=90.0)]))
    alone.rounds = (
        replace(alone.rounds[0], in_its_place=(rival("absorber", nats=100.0), rival("strain", nats=130.0))),
    )
    judged_by(monkeypatch, of(absorber=100.0, strain=130.0))
    assert [a.winner.name for a in exchanged(alone, LIMITS)] == ["strain"]
    assert ("a",) not in asked


def test_what_did_not_convince_or_could_not_be_is_not_asked(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]
) -> None:
    """However little the name of the round had gained itself."""
    less = LIMITS.evidence_nats - 0.1
    case = absorber_and_mount(rival("absurd", nats=80.0))
    case.rounds[1].winner.gain_nats = 1.5 * less
    case.rounds = (case.rounds[0], Addition(case.rounds[1].winner, (), (rival("absorber", "faint", nats=less),), 5.0))
    monkeypatch.setattr(module, "implausible", lambda fit: fit.hypotheses[-1].name == "absurd")
    judged_by(monkeypatch, of(absorber_mount=160.0))
    assert exchanged(case, LIMITS) == ()
    assert asked == []


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(search(), id="nothing found"),
        pytest.param(search((rival("a", nats=90.0), [rival("b", nats=80.0)])), id="one name"),
        pytest.param(
            search((rival("a", nats=90.0), [rival("b", nats=80.0)]), (rival("a", "c", nats=80.0), []), adequate=True),
            id="nothing left",
        ),
        pytest.param(
            search((rival("a", nats=90.0), [rival("b", nats=80.0)]), (rival("a", "gone", "c", nats=80.0), [])),
            id="another model at the end",
        ),
        pytest.param(
            search(
                (rival("a", nats=90.0), [rival("b", nats=80.0)]),
                (rival("a", "play", nats=80.0, linear=False), [rival("a", "c", nats=70.0)]),
            ),
            id="depends on level",
        ),
    ],
)
def test_elsewhere_nothing_is_asked(case: Any, asked: list[tuple[str, ...]]) -> None:
    assert exchanged(case, LIMITS) == ()
    assert asked == []


def test_what_hangs_nowhere_is_left_out(monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]]) -> None:
    def falls(*rest: Any) -> Any:
        raise NoStructureError("no aircraft")

    case = absorber_and_mount(rival("strain", nats=80.0))
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=80.0))
    monkeypatch.setattr(module, "fit", falls)
    assert exchanged(case, LIMITS) == ()
    assert asked == [("mount", "strain")]
    monkeypatch.setattr(module, "fit_unless_behind", falls)
    assert exchanged(case, LIMITS) == ()


@pytest.mark.parametrize(
    ("nats", "adequate", "further"),
    [(160.0 + LIMITS.set_nats + 0.1, False, True), (160.0, False, False), (150.0, True, True)],
)
def test_the_search_that_went_on_counts_where_it_leads_further(
    monkeypatch: pytest.MonkeyPatch, nats: float, adequate: bool, further: bool
) -> None:
    """By evidence, or because nothing is left."""
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=nats))
    other = search((rival("mount", nats=90.0), []), (rival("mount", "strain", nats=9.0), []), adequate=adequate)
    assert leads_further(other, absorber_and_mount(), LIMITS.set_nats) is further


def test_held_out_data_may_speak_for_the_names_that_were_found(
    monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]], held_out: list[bool]
) -> None:
    held_out[:] = [False]
    case = absorber_and_mount(rival("strain", nats=80.0))
    judged_by(monkeypatch, of(absorber_mount=160.0, mount_strain=200.0, mount=90.0, strain=80.0))
    assert exchanged(case, LIMITS) == ()
    other = search((rival("mount", nats=90.0), []), (rival("mount", "strain", nats=9.0), []), adequate=True)
    assert not leads_further(other, case, LIMITS.set_nats)


def test_no_name_is_no_way_on(monkeypatch: pytest.MonkeyPatch) -> None:
    judged_by(monkeypatch, of(absorber_mount=160.0))
    assert not leads_further(search(adequate=True), absorber_and_mount(), LIMITS.set_nats)


def test_nothing_is_ahead_of_itself_however_little_the_data_leave_open(monkeypatch: pytest.MonkeyPatch) -> None:
    judged_by(monkeypatch, of(absorber=100.0, mount=100.0, mass=101.0))
    absorber, mount, mass = map(fit_of, ("absorber", "mount", "mass"))
    null = fit_of()
    assert module.ahead_of(null, absorber, [mount], 0.0) is None
    assert module.ahead_of(null, absorber, [mount, mass], 0.0) is mass
    assert module.ahead_of(null, absorber, [mass], 1.0) is None
