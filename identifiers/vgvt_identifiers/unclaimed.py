"""Advice on what stands far above the noise and is in no claim: peaks of the sigma plot, and the ends of the band."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel
from vgvt_identifiers.bell_modes import confirmed
from vgvt_identifiers.pole_verdict import ONE_FLANK, Verdict
from vgvt_identifiers.sigma_plot import sigma_peaks
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra

_FAR_DB = 10.0  # leakage of lightly damped modes makes ripples of up to eight
_FALSE_ALARM = 0.01
_END = 0.02  # part of the lines at each end of the band that is its end


def unclaimed_advice(spectra: CampaignSpectra, model: ModalModel) -> tuple[str, ...]:
    """A line that names the peaks (Hz) at which ``model`` claims no mode, and one for each end the responses rise to.

    For methods that taper the ends of the band, where they see little of a mode. No line where all is claimed.
    """
    frequency = spectra.frequency_hz
    if not spectra.runs or frequency.size < FEWEST_LINES:
        return ()
    step = float(frequency[1] - frequency[0])
    half = model.damping_ratio * model.natural_frequency_hz
    said = []
    peaks = [
        peak.frequency_hz
        for peak in sigma_peaks(spectra, _FAR_DB, _FALSE_ALARM)
        if not _claimed(model, half, peak.frequency_hz, 2 * max(peak.width_hz, 2 * step)) and confirmed(spectra, peak)
    ]
    if peaks:
        listed = ", ".join(f"{f:.3f}" for f in peaks)
        said.append(
            f"sigma-plot peaks far above the noise that no mode claimed explains: {listed} Hz; widen the band, as its "
            "ends are tapered, or ask another method"
        )
    power = np.sum([(np.abs(run.accelerance) ** 2).sum(axis=0) for run in spectra.runs], axis=0)
    size = max(3, round(_END * frequency.size))
    for end, line in ((power[:size], 0), (power[-size:], -1)):
        far = end.max() > 10 ** (_FAR_DB / 10) * np.median(power) and end.max() >= power[_around(line, size)].max()
        at = float(frequency[line])
        if far and not _claimed(model, half, at, 2 * size * step):
            said.append(
                f"the responses rise towards the end of the band at {at:.3f} Hz, and no mode is claimed there: widen it"
            )
    return tuple(said)


def _around(line: int, size: int) -> slice:
    return slice(0, 3 * size) if line == 0 else slice(-3 * size, None)


def _claimed(model: ModalModel, half_hz: NDArray[np.float64], at_hz: float, reach_hz: float) -> bool:
    return bool((np.abs(model.natural_frequency_hz - at_hz) < np.maximum(reach_hz, 2 * half_hz)).any())


def one_flank_advice(poles_rad_s: NDArray[np.complex128], verdicts: tuple[Verdict, ...]) -> tuple[str, ...]:
    """A line that names the poles (N,) that are left out because the band ends inside their half-power width."""
    at = [abs(p) / (2 * np.pi) for p, v in zip(poles_rad_s, verdicts, strict=True) if v.reason == ONE_FLANK]
    if not at:
        return ()
    listed = ", ".join(f"{f:.3f}" for f in sorted(at))
    return (f"not claimed, as the band ends inside the half-power width: {listed} Hz; widen the band",)
