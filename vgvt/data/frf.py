"""A set of frequency response functions with labels."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data.channel import Quantity
from vgvt.data.dof import Dof
from vgvt.data.errors import InputError
from vgvt.data.shown import counted, headed, listed

_OVER_FORCE = {
    Quantity.ACCELERATION: "accelerances",
    Quantity.VELOCITY: "mobilities",
    Quantity.DISPLACEMENT: "receptances",
}


@dataclass(frozen=True, slots=True, eq=False)
class FrequencyResponseSet:
    """Frequency response functions ``values[response, reference, frequency]``, in SI.

    With ``quantity`` acceleration these are accelerances in (m/s^2)/N
    (ISO 7626-1). ``variance`` (same shape, real) is the variance of the complex
    value, E|G - E G|^2; ``coherence`` is the ordinary or multiple coherence.
    Both are None where the estimator cannot tell. ``runs`` gives the run each
    response was first measured in, shape (responses,): responses of different
    runs were never measured together. ``remarks`` name what was left out, and why.
    ``added_decay_rad_per_s`` is what an exponential window has added to every decay
    rate: values are then those along s = added + iω, at which ``synthesise`` gives them too.
    """

    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    frequency_hz: NDArray[np.float64]
    values: NDArray[np.complex128]
    runs: tuple[int, ...]
    quantity: Quantity = Quantity.ACCELERATION
    variance: NDArray[np.float64] | None = None
    coherence: NDArray[np.float64] | None = None
    remarks: tuple[str, ...] = ()
    added_decay_rad_per_s: float = 0.0

    def __post_init__(self) -> None:
        shape = (len(self.responses), len(self.references), self.frequency_hz.size)
        for name in ("values", "variance", "coherence"):
            array = getattr(self, name)
            if array is not None and array.shape != shape:
                raise ValueError(f"{name} must be (responses, references, frequency) = {shape}, got {array.shape}")
        if len(self.runs) != len(self.responses):
            raise ValueError(f"runs must name one run a response ({len(self.responses)}), got {len(self.runs)}")
        if np.any(np.diff(self.frequency_hz) <= 0):
            raise ValueError("frequency_hz must increase strictly")

    def __repr__(self) -> str:
        f, unit = self.frequency_hz, self.quantity.si_unit
        per_force = f" in {f'({unit})' if '/' in unit else unit}/N" if unit else ""
        what = f"{_OVER_FORCE.get(self.quantity, 'responses')}{per_force}"
        lines = counted(f.size, "line") + (f" from {f[0]:.4g} to {f[-1]:.4g} Hz" if f.size else "")
        known = [name for name in ("variance", "coherence") if getattr(self, name) is not None]
        beside = f", with {' and '.join(known)}" if known else ""
        sides = f"{counted(len(self.responses), 'response')}, force at {listed(self.references)}"
        return headed(f"FrequencyResponseSet: {what}, {sides}, {lines}{beside}", self.remarks, most=3)

    @property
    def resolution_hz(self) -> float:
        """Spacing of the first two lines."""
        return float(self.frequency_hz[1] - self.frequency_hz[0])

    def band(self, low_hz: float, high_hz: float) -> FrequencyResponseSet:
        """The lines with low_hz <= f <= high_hz; none of them where it falls between two lines.

        InputError for a band that ends before it begins, and for one on one side of all lines.
        """
        asked = f"band {low_hz:g} to {high_hz:g} Hz"
        if not low_hz <= high_hz:
            raise InputError("frequency responses", f"{asked} is not low <= high", "give its lower end first")
        if self.frequency_hz.size and (low_hz > self.frequency_hz[-1] or high_hz < self.frequency_hz[0]):
            lines = f"{self.frequency_hz[0]:g} to {self.frequency_hz[-1]:g} Hz"
            raise InputError("frequency responses", f"{asked} lies outside the lines, {lines}", "take a band in there")
        return self.lines((self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz))

    def lines(self, keep: NDArray[np.bool_]) -> FrequencyResponseSet:
        """The lines at which ``keep`` (frequency,) is true, be it none."""
        return replace(
            self,
            frequency_hz=self.frequency_hz[keep],
            values=self.values[:, :, keep],
            variance=None if self.variance is None else self.variance[:, :, keep],
            coherence=None if self.coherence is None else self.coherence[:, :, keep],
        )

    def sigma(self) -> NDArray[np.float64]:
        """Largest singular value over frequency, shape (frequency,): the 'sigma plot'.

        With one reference this is the root of the sum of squares over the responses.
        """
        if len(self.references) == 1:
            return np.asarray(np.sqrt((np.abs(self.values[:, 0]) ** 2).sum(axis=0)))
        return np.asarray(np.linalg.svd(self.values.transpose(2, 0, 1), compute_uv=False)[:, 0])
