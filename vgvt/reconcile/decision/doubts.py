"""What speaks against a name although its evidence speaks for it: fits that had not converged, strained unknowns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.one_event import together_in
from vgvt.reconcile.question.problem import CELLS

if TYPE_CHECKING:
    from vgvt.reconcile.decision.attribute import Attribution
    from vgvt.reconcile.fitting.fit import Fit

_FAR, _VERY_FAR = 4.0, 6.0
# One score in sixteen thousand lies beyond four standard deviations: one may be a tolerance that is stated too tight.
_MOST_FAR = 1
_SHOWN = 4


def doubts(found: Attribution) -> tuple[str, ...]:
    """Reasons, in plain words, not to take what was named for the whole truth; none without a name.

    A calibration that never settles is one where the final model leaves something, too. Where that leaves noise alone,
    what the calibration was on its way to does not matter: it was tried again from the final model's unknowns.
    """
    if not found.rounds:
        return ()
    said = []
    if not found.null.converged and not found.final_residual.adequate:
        said.append(
            "The calibration without effects had not converged: part of what the name gains may be its own way down"
        )
    if not found.final.converged:
        said.append("The fit with what was named had not converged: its parameters and errors are not final")
    strained = far_scores(found.final)
    if strained_too_much(found.final):
        said.append(f"The fit with what was named needs {strained}: something else is still missing, or a tolerance")
    if found.still is not None:
        said.append(
            f"A {found.still.words} that is smooth over frequency would still explain {found.still.nats:.0f} nats more "
            "than chance does: what was named is not quite what is there, or not alone"
        )
    together, run = together_in(found.final)
    if together:
        said.append(
            f"{' and '.join(together)} begin together, from run {run} on: one event that is in no catalogue can look "
            "like them, and no record tells; the log of the test does"
        )
    if found.nameless is not None:
        said.append(f"Not alone: one thing that has no name, {found.nameless.in_words}")
    return tuple(said)


def strained_too_much(fit: Fit) -> bool:
    """Whether more scores than chance explains, or one by far, left their tolerances."""
    size = np.abs(_stated(fit))
    return bool((size > _FAR).sum() > _MOST_FAR or (size > _VERY_FAR).any())


def far_scores(fit: Fit) -> str:
    """``EI wing at +5.2 sd``, … of the scores beyond four standard deviations, the farthest first; empty without."""
    scores = _stated(fit)
    far = [int(k) for k in np.argsort(-np.abs(scores)) if abs(scores[k]) > _FAR]
    names = (*fit.problem.names, *(f"{h.name} {p.name}" for h in fit.hypotheses for p in h.parameters))
    words = [f"{names[k]} at {scores[k]:+.1f} sd" for k in far[:_SHOWN]]
    more = len(far) - len(words)
    return ", ".join(words) + (f" and {more} more beyond {_FAR:.0f} sd" if more > 0 else "")


def _stated(fit: Fit) -> NDArray[np.float64]:
    """Scores, with a zero for how coarse a chain the data come from: no scenario states a tolerance for it."""
    scores = np.array(fit.scores, dtype=float)
    scores[[k for k, name in enumerate(fit.problem.names) if name == CELLS.name]] = 0.0
    return scores
