"""One round of the selection: the effect that it names, what explains the data as well, and all that was compared."""

from __future__ import annotations

from dataclasses import dataclass

from vgvt.data.shown import headed, listed
from vgvt.reconcile.evidence.rivals import Rival


@dataclass(frozen=True, slots=True, eq=False)
class Addition:
    """One round: the winner, everything within reach of it (its equivalence set, best first), and all rivals.

    Of a lead, within reach is what comes nearly as near (:mod:`vgvt.reconcile.decision.near_leads`), too.
    ``in_its_place`` is what was found to do as well beside all that later rounds added: the winner itself first, then
    these, each the last effect of a fit with the others; empty where nothing was. ``exchanged`` rounds are those of
    names of which one took another's place (:mod:`vgvt.reconcile.decision.exchanged`): compared before, and elsewhere.
    """

    winner: Rival
    equivalent: tuple[Rival, ...]
    rivals: tuple[Rival, ...]
    held_out_before: float | None
    in_its_place: tuple[Rival, ...] = ()
    exchanged: bool = False

    def __repr__(self) -> str:
        return headed(f"Addition of {self.in_words}")

    @property
    def in_words(self) -> str:
        """The winner, what it gained, and what explains the data as well."""
        before, after = self.held_out_before, self.winner.held_out
        held = "" if before is None or after is None else f", held out {before:.3g} → {after:.3g}"
        others = dict.fromkeys(r.hypothesis.label for r in self.alike if r is not self.winner)
        equals = f"; as well: {listed(others, 2)}" if others else ""
        label = self.winner.hypothesis.label
        return f"{label}: {self.winner.gain_nats:.1f} nats{held}; {len(self.rivals)} tried{equals}"

    @property
    def alike(self) -> tuple[Rival, ...]:
        """All that explains the data as well as the winner, when it was chosen or at the end."""
        return (*self.equivalent, *self.in_its_place[1:])
