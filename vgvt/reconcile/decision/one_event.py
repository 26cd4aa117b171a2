"""Names that begin with the same run: two things that were done then, or one event that no name explains.

Between two runs somebody opens the aircraft, hangs it up anew, comes back after a night. Several things may change in
one such break, and so may one that is not in the catalogue, whose relatives share what it does: another hang of the
aircraft was another payload and a cooler hangar, both from the second run on, and the data were met. No record tells
the two apart. Of the study's pairs with two changes between runs two of five began with the same run, up to seed 88; of
its effects that were taken out of the catalogue nine had several changes between runs for an answer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from vgvt.effects.protocol import Family
from vgvt.reconcile.question.hypothesis import Hypothesis


def begin_together(hypotheses: Sequence[Hypothesis]) -> tuple[tuple[str, ...], int]:
    """Names of some hypotheses that begin with the same run, and that run, counted from 1; no names where none do.

    Of several such runs the first.
    """
    began: dict[int, list[str]] = {}
    for hypothesis in hypotheses:
        run = beginning_of(hypothesis)
        if run is not None:
            began.setdefault(run, []).append(hypothesis.name)
    together = [(run, names) for run, names in sorted(began.items()) if len(names) > 1]
    return (tuple(together[0][1]), together[0][0]) if together else ((), 0)


def beginning_of(hypothesis: Hypothesis) -> int | None:
    """The run, counted from 1, that a change between runs begins with; None of what is there always, or creeps."""
    if hypothesis.cls.family is not Family.BETWEEN_RUNS:  # type: ignore[attr-defined]
        return None
    stated = {f.name: f.default for f in dataclasses.fields(hypothesis.cls)}
    said = {**stated, **hypothesis.settings}
    run = said.get("from_run")
    return int(run) if isinstance(run, int) and said.get("shape", "step") == "step" else None
