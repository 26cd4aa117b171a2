"""From sigma-plot peaks to modes: the windowed rational fits and what they say about each peak."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.needed_leakage import blocks_that_leak
from vgvt_identifiers.rational_fit import Block, RationalFit, fit_rational, pole_evidence
from vgvt_identifiers.sigma_plot import SigmaPeak
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra
from vgvt_identifiers.weights import reweighted
from vgvt_identifiers.windows import Window, fit_windows

_NARROW_LINES = 3.0
_LINES_PER_POLE = 6
_LARGEST_RELATIVE_STD = 0.15
_OWN_STEPS = 12  # a run that tells a pole by itself needs few; others would wander, and are not asked
_LARGEST_SHARE = 10.0  # poles that large cancel one another: they mimic something that is no pole
_NO_POLE = "as leakage, noise or a neighbouring mode explains them"


@dataclass(frozen=True, slots=True)
class FitOptions:
    """What the fits may do; the settings of the method explain each."""

    window_widths: float = 4.0
    background_terms: int = 4
    largest_damping_ratio: float = 0.3
    own_frequency: bool = True
    least_share: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class FittedMode:
    """One mode of the fit: ``quadrature`` (all responses of all runs,) is the imaginary part at its frequency."""

    sigma_peak_hz: float
    natural_frequency_hz: float
    damping_ratio: float
    natural_frequency_std_hz: float
    damping_ratio_std: float
    quadrature: NDArray[np.float64]
    flags: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _WindowFit:
    """The fit of a window with poles common to all runs, and of each run with poles of its own."""

    common: RationalFit
    own: tuple[RationalFit, ...]
    step_hz: float

    def own_poles(self, which: int) -> NDArray[np.complex128]:
        """Pole (runs,) of one mode in each run, NaN where a run alone cannot tell."""
        reach = 2 * abs(self.common.poles[which].real) + 2 * np.pi * self.step_hz
        found = np.full(len(self.own), complex(np.nan))
        for run, fit in enumerate(self.own):
            near = abs(fit.poles[which] - self.common.poles[which]) < reach
            # A run with its sensors on the nodes of a mode fits something else there, much narrower or wider.
            alike = 0.5 < fit.poles[which].real / self.common.poles[which].real < 2.0
            if near and alike and fit.pole_std[which] < 0.1 * abs(self.common.poles[which].real):
                found[run] = fit.poles[which]
        return found


def fit_modes(
    spectra: CampaignSpectra, peaks: tuple[SigmaPeak, ...], options: FitOptions
) -> tuple[tuple[FittedMode, ...], tuple[str, ...]]:
    """The modes behind the peaks in order of frequency, and remarks on the peaks without an acceptable mode."""
    modes: list[FittedMode] = []
    refused: dict[str, list[float]] = {}
    for window in fit_windows(peaks, spectra.frequency_hz, options.window_widths):
        own = [window.peaks[i] for i in window.own]
        fit = _fit(spectra, window, options)
        pairs = [] if fit is None else _pairs(fit, own, spectra.frequency_hz[[window.low, window.high - 1]])
        for peak, which in pairs:
            problem = None if fit is None else _problem(fit, which, spectra, options)
            if fit is not None and problem is None:
                modes.append(_mode(fit, which, peak, options.own_frequency))
            else:
                refused.setdefault(str(problem), []).append(peak.frequency_hz)
        matched = {peak.line for peak, _ in pairs}
        refused.setdefault(_NO_POLE, []).extend(p.frequency_hz for p in own if p.line not in matched)
    return _distinct(modes, refused), _remarks(refused)


def _distinct(modes: list[FittedMode], refused: dict[str, list[float]]) -> tuple[FittedMode, ...]:
    """The modes in order of frequency, without second copies of a pole that two windows found from two peaks."""
    kept: list[FittedMode] = []
    for mode in sorted(modes, key=lambda m: abs(m.natural_frequency_hz - m.sigma_peak_hz)):
        half_width = mode.damping_ratio * mode.natural_frequency_hz
        if any(abs(mode.natural_frequency_hz - k.natural_frequency_hz) < 0.3 * half_width for k in kept):
            refused.setdefault(_NO_POLE, []).append(mode.sigma_peak_hz)
        else:
            kept.append(mode)
    return tuple(sorted(kept, key=lambda m: m.natural_frequency_hz))


def _remarks(refused: dict[str, list[float]]) -> tuple[str, ...]:
    return tuple(
        f"sigma-plot peaks not claimed, {why}: {', '.join(f'{f:.3f}' for f in sorted(peaks))} Hz"
        for why, peaks in refused.items()
        if peaks
    )


def _fit(spectra: CampaignSpectra, window: Window, options: FitOptions) -> _WindowFit | None:
    """The fit of a window with the poles that matter, None when none does."""
    frequency = spectra.frequency_hz[window.low : window.high]
    step = float(frequency[1] - frequency[0])
    blocks = tuple(_block(run, window) for run in spectra.runs)
    room = max(1, (frequency.size - options.background_terms - 2) // _LINES_PER_POLE)
    strongest = sorted(window.peaks, key=lambda p: -p.prominence_db)[:room]
    poles = np.array([2 * np.pi * (-max(p.width_hz, step) / 2 + 1j * p.frequency_hz) for p in strongest])
    common = fit_rational(frequency, blocks, poles, options.background_terms)
    leaks = blocks_that_leak(frequency, blocks, common, options.background_terms)
    if not leaks.all():
        kept = _with_leakage(blocks, leaks)
        common = fit_rational(frequency, kept, common.poles, options.background_terms, relocate=False)
    blocks = _with_leakage(reweighted(blocks, common), leaks)  # weights follow the force of every run
    common = fit_rational(frequency, blocks, common.poles, options.background_terms, relocate=False)
    while not (keep := _worth_keeping(frequency, blocks, common, options)).all():
        if not keep.any():
            return None
        common = fit_rational(frequency, blocks, common.poles[keep], options.background_terms, relocate=False)
    own = tuple(
        fit_rational(frequency, (b,), common.poles, options.background_terms, relocate=False, steps=_OWN_STEPS)
        for b in (blocks if len(blocks) > 1 else ())
    )
    return _WindowFit(common, own, step)


def _with_leakage(blocks: tuple[Block, ...], leaks: NDArray[np.bool_]) -> tuple[Block, ...]:
    return tuple(b if leaking else replace(b, leakage=None) for b, leaking in zip(blocks, leaks, strict=True))


def _worth_keeping(
    frequency: NDArray[np.float64], blocks: tuple[Block, ...], fit: RationalFit, options: FitOptions
) -> NDArray[np.bool_]:
    """Which poles (N,) stay: the visible ones; when all are, all but the weakest if its evidence is too little."""
    keep = _visible(fit, options.least_share)
    if keep.all():
        evidence = pole_evidence(frequency, blocks, fit, options.background_terms)
        weakest = int(np.argmin(evidence))
        keep[weakest] = evidence[weakest] > 0
    return keep


def _visible(fit: RationalFit, least_share: float) -> NDArray[np.bool_]:
    """Which poles (N,) make a visible part of the responses, free of leakage, and are known well enough to be real."""
    height = np.sqrt(sum((np.abs(r) ** 2).sum(axis=0) for r in fit.residues)) / np.abs(fit.poles.real)
    total = [
        np.sqrt(sum((np.abs(fit.at(abs(p) / (2 * np.pi), block)) ** 2).sum() for block in range(len(fit.residues))))
        for p in fit.poles
    ]
    known = fit.pole_std < _LARGEST_RELATIVE_STD * np.abs(fit.poles.real)
    share = height / np.maximum(total, 1e-300)
    return np.asarray((share >= least_share) & (share <= _LARGEST_SHARE) & known)


def _pairs(fit: _WindowFit, peaks: list[SigmaPeak], ends_hz: NDArray[np.float64]) -> list[tuple[SigmaPeak, int]]:
    """Peaks and the poles behind them, nearest first, each used once; a pole is within two widths of its peak."""
    natural = np.abs(fit.common.poles) / (2 * np.pi)
    inside = (natural >= ends_hz[0]) & (natural <= ends_hz[1])
    near = [
        (abs(natural[pole] - peak.frequency_hz), row, pole)
        for row, peak in enumerate(peaks)
        for pole in np.flatnonzero(inside)
        if abs(natural[pole] - peak.frequency_hz) <= 2 * max(peak.width_hz, 2 * fit.step_hz)
    ]
    rows: set[int] = set()
    poles: set[int] = set()
    pairs = []
    for _, row, pole in sorted(near):
        if row not in rows and pole not in poles:
            rows.add(row)
            poles.add(int(pole))
            pairs.append((peaks[row], int(pole)))
    return pairs


def _block(run: RunSpectra, window: Window) -> Block:
    cut = slice(window.low, window.high)
    size = np.maximum(np.abs(run.force[cut]), 1e-9 * np.abs(run.force).max())
    noise = np.median(run.variance[:, cut] * size**2, axis=1)
    floor = 1e-16 * (np.abs(run.accelerance[:, cut]) ** 2 * size**2).mean(axis=1).max()
    leakage = None if run.averaged else run.force[cut].conj() / size**2
    return Block(run.accelerance[:, cut], size, 1 / np.sqrt(noise + floor + 1e-300), leakage)


def _problem(fit: _WindowFit, which: int, spectra: CampaignSpectra, options: FitOptions) -> str | None:
    """Why a pole is not claimed as the mode behind a peak, None when it is."""
    pole = fit.common.poles[which]
    natural = float(abs(pole)) / (2 * np.pi)
    if -pole.real > options.largest_damping_ratio * abs(pole):
        return "the fitted damping is above largest_damping_ratio"
    if not spectra.frequency_hz[0] <= natural <= spectra.frequency_hz[-1]:
        return "the fitted natural frequency is outside the band"
    return None


def _mode(fit: _WindowFit, which: int, peak: SigmaPeak, own_frequency: bool) -> FittedMode:
    pole, std = fit.common.poles[which], float(fit.common.pole_std[which])
    natural = float(abs(pole)) / (2 * np.pi)
    damping = float(-pole.real / abs(pole))
    flags = [f"sigma_peak_hz={peak.frequency_hz:.3f}", f"prominence_db={peak.prominence_db:.1f}"]
    if 2 * damping * natural < _NARROW_LINES * fit.step_hz:
        flags.append("narrow")
    if not fit.common.converged:
        flags.append("fit_not_converged")
    own = fit.own_poles(which)
    known = own[np.isfinite(own)]
    std_hz, std_ratio = std / (2 * np.pi), std / float(abs(pole))
    if known.size > 1:
        scatter = float((np.abs(known) / (2 * np.pi)).std(ddof=1))
        flags.append(f"run_scatter_hz={scatter:.4f}")
        if scatter > damping * natural / 2:
            flags.append("runs_disagree")
        std_hz = max(std_hz, scatter / np.sqrt(known.size))
        std_ratio = max(std_ratio, float((-known.real / np.abs(known)).std(ddof=1)) / np.sqrt(known.size))
    own_hz = np.abs(own) / (2 * np.pi) if own_frequency else np.full(own.shape, np.nan)
    return FittedMode(
        peak.frequency_hz, natural, damping, std_hz, std_ratio, _quadrature(fit, natural, own_hz), tuple(flags)
    )


def _quadrature(fit: _WindowFit, natural_hz: float, own_hz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Imaginary part of every response of every run: at the run's own frequency where known, else at the common."""
    rows = []
    for run in range(len(fit.common.residues)):
        if run < own_hz.size and np.isfinite(own_hz[run]):
            rows.append(fit.own[run].at(float(own_hz[run]), 0).imag)
        else:
            rows.append(fit.common.at(natural_hz, run).imag)
    return np.concatenate(rows)
