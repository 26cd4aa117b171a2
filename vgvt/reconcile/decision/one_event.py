"""Names that begin with the same run: two things that were done then, or one event that no name explains.

Between two runs somebody opens the aircraft, hangs it up anew, comes back after a night. Several things may change in
one such break, and so may one that is not in the catalogue, whose relatives share what it does: another hang of the
aircraft was another payload and a cooler hangar, both from the second run on, and the data were met. No record tells
the two apart. Of the study's pairs with two changes between runs two of five began with the same run, up to seed 88; of
its effects that were taken out of the catalogue nine had several changes between runs for an answer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from vgvt.effects.protocol import Family
from vgvt.reconcile.question.hypothesis import Hypothesis

if TYPE_CHECKING:
    from vgvt.reconcile.fitting.fit import Fit


def begin_together(hypotheses: Sequence[Hypothesis], seen: Collection[int]) -> tuple[tuple[str, ...], int]:
    """Names of some hypotheses that begin with the same run, and that run, counted from 1; no names where none do.

    Of several such runs the first. ``seen`` are the runs that are fitted, counted from 1: two beginnings between which
    none of them lies are one to the fit.
    """
    began: dict[int, list[tuple[int, str]]] = {}
    for hypothesis in hypotheses:
        run = beginning_of(hypothesis)
        if run is not None:
            first_changed = min((r for r in seen if r >= run), default=run)
            began.setdefault(first_changed, []).append((run, hypothesis.name))
    together = [same for _, same in sorted(began.items()) if len(same) > 1]
    return (tuple(name for _, name in together[0]), min(together[0])[0]) if together else ((), 0)


def together_in(found: Fit) -> tuple[tuple[str, ...], int]:
    """:func:`begin_together` of a fit's hypotheses, by the runs that it was made to; the run as the campaign has it."""
    if len(found.hypotheses) < 2:
        return (), 0
    problem = found.problem
    fitted = zip(problem.measured.channels, problem.split.train, strict=True)
    names, run = begin_together(found.hypotheses, {channel.run + 1 for channel, train in fitted if train})
    # Hypotheses count the runs that are there, the log of the test those that were made.
    numbers = {channel.run + 1: channel.run_number for channel in problem.measured.channels}
    return names, numbers.get(run, run)


def beginning_of(hypothesis: Hypothesis) -> int | None:
    """The run, counted from 1, that a change between runs begins with; None of what is there always, or creeps."""
    if hypothesis.cls.family is not Family.BETWEEN_RUNS:  # type: ignore[attr-defined]
        return None
    stated = {f.name: f.default for f in dataclasses.fields(hypothesis.cls)}
    said = {**stated, **hypothesis.settings}
    run = said.get("from_run")
    return int(run) if isinstance(run, int) and said.get("shape", "step") == "step" else None
