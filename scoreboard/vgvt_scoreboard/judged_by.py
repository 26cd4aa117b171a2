"""Which true modes a claim is judged by: those as tested, or with the shaker attached where no force was used.

The measured force divides the shaker out of A/F. Responses alone show the poles of aircraft and shaker together, and
no method can know better from them: how far these lie from the aircraft's own is the error of the procedure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel, TrueModes, Truth
from vgvt_scoreboard.counterparts import counterparts
from vgvt_scoreboard.merged_truth import MergedTruth, merge_truth
from vgvt_scoreboard.reach import reachable

_NOT_THERE = (
    "the force is not used, but this truth holds no modes with the shaker attached; judged by those as tested, where "
    "errors and ± are also for what the shaker changes"
)
_WITH_THE_SHAKER = (
    "the force is not used: judged by the modes with the shaker attached, which are all that responses show by "
    "themselves"
)


@dataclass(frozen=True, slots=True, eq=False)
class JudgedBy:
    """The true modes of ``merged`` that a claim is held against, and the mode ``as_tested`` that each is.

    ``counterpart`` (M,) are indices among those as tested, -1 for a resonance that is like none of them.
    ``fallen_back`` says that a claim without the force had to be judged as tested.
    """

    which: TrueModes
    merged: MergedTruth
    as_tested: ModalModel
    counterpart: NDArray[np.intp]
    fallen_back: bool = False

    def reached(self, dofs: tuple[Dof, ...]) -> NDArray[np.bool_]:
        """Which modes, (M,), the records of these sensors hold enough about."""
        return reachable(self.merged.model.at(dofs))

    def as_tested_at(self, i: int) -> tuple[float | None, float | None]:
        """Frequency, Hz, and damping ratio of a mode as tested; None where judged by those, or it is like none."""
        j = int(self.counterpart[i])
        if self.which is TrueModes.AS_TESTED or j < 0:
            return None, None
        return float(self.as_tested.natural_frequency_hz[j]), float(self.as_tested.damping_ratio[j])

    def remarks(self, band_hz: tuple[float, float], dofs: tuple[Dof, ...]) -> tuple[str, ...]:
        """What to know about a claim that was made without the force; nothing about others."""
        if self.which is TrueModes.AS_TESTED:
            return (_NOT_THERE,) if self.fallen_back else ()
        hertz, low, high = self.merged.model.natural_frequency_hz, *band_hz
        named = self.counterpart >= 0
        here = np.flatnonzero(named & self.reached(dofs) & (hertz >= low) & (hertz <= high))
        there = self.counterpart[here]
        said = _WITH_THE_SHAKER
        if here.size:
            away = np.abs(hertz[here] / self.as_tested.natural_frequency_hz[there] - 1).max()
            damping = np.abs(np.log(self.merged.model.damping_ratio[here] / self.as_tested.damping_ratio[there]))
            said += (
                f"; the same as tested lie up to {100 * away:.2g} % away in frequency and a factor of "
                f"{np.exp(damping.max()):.2g} in damping: that is an error of the procedure, not of the method"
            )
        return (said, *self._lost(band_hz, dofs))

    def _lost(self, band_hz: tuple[float, float], dofs: tuple[Dof, ...]) -> tuple[str, ...]:
        """A line on modes as tested that are to be seen, but belong to no mode with the shaker."""
        tested, (low, high) = self.as_tested, band_hz
        asked = (tested.natural_frequency_hz >= low) & (tested.natural_frequency_hz <= high)
        lost = np.setdiff1d(np.flatnonzero(asked & reachable(tested.at(dofs))), self.counterpart)
        if not lost.size:
            return ()
        names = [f"{tested.labels[i] if tested.labels else ''} ({_hertz(tested, i)})".strip() for i in lost]
        return (f"with the shaker attached, no mode is recognised as that as tested: {', '.join(names)}",)


def judged_by(truth: Truth, claim: ModalModel) -> JudgedBy:
    """The true modes that a claim can be expected to find, on average over the runs.

    InputError when the truth holds no run.
    """
    tested = merge_truth(truth)
    if not claim.output_only or not all(len(model) for model in truth.coupled):
        return JudgedBy(TrueModes.AS_TESTED, tested, tested.model, np.arange(len(tested.model)), claim.output_only)
    merged = merge_truth(truth, TrueModes.COUPLED)
    theirs = counterparts(merged.model, tested.model)
    labels = tuple(tested.model.labels[i] if i >= 0 and tested.model.labels else "" for i in theirs)
    named = replace(merged, model=replace(merged.model, labels=labels))
    return JudgedBy(TrueModes.COUPLED, named, tested.model, theirs)


def _hertz(model: ModalModel, i: int) -> str:
    return f"{model.natural_frequency_hz[i]:.2f} Hz"
