"""How well the frequency responses of a modal model meet measured ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data.dof import Dof
from vgvt.data.shown import counted, headed, listed


@dataclass(frozen=True, slots=True, eq=False)
class FrfFit:
    """NRMSE fit in percent of every frequency response (R, I), and the pointwise ν-gap (F,) of all of them together.

    Responses and references are those that both sides know. The ν-gap is that of accelerances in g/N.
    """

    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    fit_percent: NDArray[np.float64]
    frequency_hz: NDArray[np.float64]
    nu_gap: NDArray[np.float64]

    def __repr__(self) -> str:
        of = f"{counted(len(self.responses), 'response')}, force at {listed(self.references)}"
        if not (self.fit_percent.size and self.nu_gap.size):
            return headed(f"FrfFit: {of}")
        i, j = np.unravel_index(int(np.argmin(self.fit_percent)), self.fit_percent.shape)
        worst = f"{self.fit_percent[i, j]:.1f} % (at {self.responses[i]})"
        largest = int(np.argmax(self.nu_gap))
        gap = f"ν-gap at most {self.nu_gap[largest]:.3f}, at {self.frequency_hz[largest]:.4g} Hz"
        return headed(
            f"FrfFit: {of}; NRMSE fit in the median {np.median(self.fit_percent):.1f} %, worst {worst}; {gap}"
        )

    def as_dict(self, accepted_percent: float = 70.0) -> dict[str, Any]:
        """The fit with the keys of the JSON contract, plain types only; ``accepted_percent`` parts good from poor."""
        fits = [
            {"response": str(response), "reference": str(reference), "fit_percent": float(self.fit_percent[i, j])}
            for j, reference in enumerate(self.references)
            for i, response in enumerate(self.responses)
        ]
        largest = int(np.argmax(self.nu_gap))
        return {
            "nrmse": fits,
            "median_fit_percent": float(np.median(self.fit_percent)),
            "accepted_percent": accepted_percent,
            "below": int((self.fit_percent < accepted_percent).sum()),
            "largest_nu_gap": float(self.nu_gap[largest]),
            "largest_nu_gap_hz": float(self.frequency_hz[largest]),
            "mean_nu_gap": float(self.nu_gap.mean()),
        }
