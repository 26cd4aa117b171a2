"""Searches for names, each kept on disk: a first one, one on from exchanged names, one without implausible ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from vgvt.reconcile.checkpoint import Begun, Checkpoint
from vgvt.reconcile.decision.attribute import Attribution, attribute
from vgvt.reconcile.decision.exchanged import exchanged, leads_further
from vgvt.reconcile.decision.leads import does_without, strange_names, telling
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.progress import Progress, part, silent

# Of a search, what is there before names are exchanged, and before it is made again without what is no plausible thing.
_SEARCHED_ONCE, _SEARCHED = 0.94, 0.97


@dataclass(frozen=True, slots=True, eq=False)
class Searches:
    """What is asked of every search of one call: ``hypotheses``, limits, at ``most`` so many names.

    ``folder`` takes what was found, under what the answer rests on by name, ``provenance``, and any further
    ``settings``: a call that was broken off goes on from there. ``workers`` processes share the work.
    """

    hypotheses: Sequence[Hypothesis]
    thresholds: Thresholds
    most: int = 3
    workers: int = 1
    folder: Path | None = None
    provenance: dict[str, str] = field(default_factory=dict)
    settings: tuple[object, ...] = ()

    def made(self, start: Fit, name: str, tell: Progress = silent) -> Attribution:
        """The names that a search finds from a model without any; its files are called ``name``."""
        found = self._from(start, f"{name}.json", part(tell, 0.0, _SEARCHED_ONCE))
        further = f"{name}-exchanged.json"
        begun = self._exchanged(found, further, part(tell, _SEARCHED_ONCE, _SEARCHED_ONCE))
        if begun.rounds:
            tell(_SEARCHED_ONCE, f"again with {', '.join(a.winner.name for a in begun.rounds)}")
            other = self._from(found.null, further, part(tell, _SEARCHED_ONCE, _SEARCHED), begun=begun)
            found = other if leads_further(other, found, self.thresholds.set_nats) else found
        strange = strange_names(found)
        if not strange:
            return found
        tell(_SEARCHED, f"again without {', '.join(sorted(strange))}")
        without = self._from(start, f"{name}-plausible.json", part(tell, _SEARCHED, 1.0), without=strange)
        return telling(found, without) if does_without(found, without, self.thresholds.set_nats) else found

    def _from(
        self, start: Fit, file: str, tell: Progress, without: frozenset[str] = frozenset(), begun: Begun | None = None
    ) -> Attribution:
        """A search among all but some effects, on from what has ``begun``, or what a file kept of it."""
        asked = [h for h in self.hypotheses if h.name not in without]
        kept = self._checkpoint(file, without)
        if begun is None and kept is not None:
            begun = kept.begun(start.problem, asked)
        keep: Callable[..., None] | None = None if kept is None else kept.keep
        return attribute(
            start, asked, self.thresholds, most=self.most, workers=self.workers, progress=tell, begun=begun, keep=keep
        )

    def _exchanged(self, found: Attribution, file: str, tell: Progress) -> Begun:
        """The rounds of what was found with a name exchanged, and what was refused; no round where none gives way."""
        kept = self._checkpoint(file)
        begun = None if kept is None else kept.begun(found.null.problem, self.hypotheses)
        if begun is not None:
            return begun
        rounds = exchanged(found, self.thresholds, tell, self.workers)
        begun = Begun(found.null, rounds, tuple(r for r in found.vetoed if any(r in a.rivals for a in rounds)))
        if kept is not None:
            # That no name gives way is worth keeping, too.
            kept.keep(*begun)
        return begun

    def _checkpoint(self, file: str, without: frozenset[str] = frozenset()) -> Checkpoint | None:
        if self.folder is None:
            return None
        return Checkpoint.of(self.folder / file, self.provenance, *self.settings, self.most, sorted(without))
