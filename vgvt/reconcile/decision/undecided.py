"""What a next test has to tell apart: the explanations that one campaign leaves beside each other."""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.data.shown import listed
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.place_control import distinct_places
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.suggest import COMPARED, in_its_place
from vgvt.reconcile.question.hypothesis import Hypothesis


def undecided(found: Attribution) -> tuple[Fit, ...]:
    """The fits that a next test has to tell apart: of the last round that names several effects, the best fit of each.

    Where no round does, all that the last one with several holds: one effect at several places. Else what the last
    round holds: an effect that is alone, at one level. Nothing where there is no round: no name, nothing to tell.
    """
    return _compared(found)[1]


def _compared(found: Attribution) -> tuple[Addition | None, tuple[Fit, ...]]:
    """:func:`undecided` with the round that names them, None where none does."""
    for addition in reversed(found.rounds):
        best: dict[str, Fit] = {}
        rivals = (addition.winner, *addition.equivalent)
        if addition.in_its_place:
            # Fits that hold the same others: what they foretell differs by the one alone.
            beside = addition.in_its_place[0].fit.hypotheses[:-1]
            same = (r for r in addition.equivalent if _all_same(r.fit.hypotheses[:-1], beside))
            rivals = (*addition.in_its_place, *same)
        for r in rivals:
            best.setdefault(r.name, r.fit)
        if len(best) > 1:
            return addition, tuple(best.values())
    apart = [(addition, _apart(addition.equivalent)) for addition in reversed(found.rounds)]
    if not apart:
        return None, ()
    of, rivals_apart = next((several for several in apart if len(several[1]) > 1), apart[0])
    return of, tuple(r.fit for r in rivals_apart)


def words_of_the_rest(found: Attribution) -> tuple[str, ...]:
    """What is said of explanations that no test was compared for: those of a round beyond three, and of other rounds.

    An effect at several places is called by these.
    """
    of, fits = _compared(found)
    names = [fit.hypotheses[-1].name for fit in fits]
    called = names if len(set(names)) == len(names) else [in_its_place(fit) for fit in fits]
    rest = [*called[COMPARED:], *(() if of is None else (n for n in _names(of) if n not in names))]
    said = list[str]()
    if rest:
        verb = "explains" if len(rest) == 1 else "explain"
        said.append(
            f"Tests were compared for {listed(called[:COMPARED], COMPARED)}; {listed(rest, len(rest))} {verb} the data "
            "as well, to be told from what is left of them"
        )
    for other in found.rounds:
        if other is not of and len(_names(other)) > 1:
            said.append(
                f"Which of {' or '.join(_names(other))} is there is the next question: no test was compared for it"
            )
    return tuple(said)


def _names(addition: Addition) -> list[str]:
    """Names of all that explains the data as well in a round, each once."""
    return list(dict.fromkeys(r.name for r in addition.alike))


def _all_same(some: Sequence[Hypothesis], others: Sequence[Hypothesis]) -> bool:
    """Whether two models hold the same variants, in order."""
    return len(some) == len(others) and all(a.same(b) for a, b in zip(some, others, strict=True))


def _apart(rivals: tuple[Rival, ...]) -> list[Rival]:
    """Those of rivals with one name that say different things: two starts of one variant that met say the same."""
    kept: list[Rival] = []
    for r in rivals:
        if not any(r.hypothesis.same(o.hypothesis) and len(distinct_places([o.fit, r.fit])) < 2 for o in kept):
            kept.append(r)
    return kept


def next_best(found: Attribution) -> tuple[Fit, ...]:
    """What the last name that depends on level would have to be told from at another one, where it is alone.

    Its fit, and that of the effect of another name that came nearest; nothing where there is none.
    """
    for addition in reversed(found.rounds):
        winner = addition.winner
        if not winner.hypothesis.linear:
            others = [r for r in addition.rivals if r.name != winner.name]
            return (winner.fit, max(others, key=lambda r: r.gain_nats).fit) if others else ()
    return ()
