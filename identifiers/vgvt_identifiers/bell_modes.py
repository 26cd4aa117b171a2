"""From peaks of singular values to modes: bells fitted over all runs and in every run alone, and their residues."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import modal_assurance
from vgvt_identifiers.line_averages import averaged, lines_to_average
from vgvt_identifiers.output_spectra import Decomposition
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.sigma_plot import SigmaPeak
from vgvt_identifiers.singular_bell import Bell, FittedBell, fit_bell, mode_bell
from vgvt_identifiers.spectra import LOCAL_HALF_WIDTH, CampaignSpectra

_NARROW_LINES = 3.0
_SURROUNDINGS = 40
_POOR_LOG_RMS = 0.2
_CORE_DB = 5.0
_LEAST_SIGNIFICANCE = 3.0
_LEAST_SHARE = 0.1
_LEAST_SECOND = 3e-3


@dataclass(frozen=True, slots=True)
class BellOptions:
    """What a bell may be; the settings of the method explain each."""

    least_mac: float = 0.8
    drop_db: float = 10.0
    general: bool = True
    largest_damping_ratio: float = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class BellMode:
    """One mode: its peak, bell, fit and remarks."""

    peak_hz: float
    bell: Bell
    fit: FittedBell
    flags: tuple[str, ...]

    @property
    def pole(self) -> complex:
        """The pole with positive imaginary part, rad/s."""
        return pole_of(self.fit)


def pole_of(fit: FittedBell) -> complex:
    """The pole of a fitted bell with positive imaginary part, rad/s."""
    omega, ratio = 2 * np.pi * fit.natural_frequency_hz, min(fit.damping_ratio, 1.0)
    return complex(omega * (-ratio + 1j * np.sqrt(1 - ratio**2)))


def bell_modes(
    found: Decomposition, peaks: list[tuple[int, int]], options: BellOptions
) -> tuple[tuple[BellMode, ...], tuple[str, ...]]:
    """Modes behind peaks given as (line, order of the singular value), in order of frequency; remarks on the others."""
    modes: list[BellMode] = []
    refused: dict[str, list[float]] = {}
    for line, order in peaks:
        at_hz = float(found.frequency_hz[line])
        used, bell, fit = _fitted(found, line, order, options)
        why = _refusal(used, fit, at_hz, options)
        if fit is None or why is not None:
            refused.setdefault(str(why), []).append(at_hz)
            continue
        mode = _mode(used, at_hz, bell, _with_doubt(used, bell, fit, options))
        modes.append(mode if used is found else _at_full_resolution(mode, found, used))
    distinct = _distinct(modes, refused)
    remarks = tuple(
        f"peaks not claimed, {why}: {', '.join(f'{f:.3f}' for f in sorted(at))} Hz" for why, at in refused.items()
    )
    return distinct, remarks


def _fitted(
    found: Decomposition, line: int, order: int, options: BellOptions
) -> tuple[Decomposition, Bell, FittedBell | None]:
    """The bell around a line and its fit; of averages of lines where single ones have no shape for their noise."""
    bell = mode_bell(found, line, options.least_mac, options.drop_db, order)
    fit = fit_bell(found, bell, options.general)
    lines = 1 if fit is not None else lines_to_average(found, line, order, options.least_mac)
    if not 1 < lines <= found.frequency_hz.size // 2:
        return found, bell, fit
    means = averaged(found, lines)
    bell = mode_bell(means, min(line // lines, means.frequency_hz.size - 1), options.least_mac, options.drop_db, order)
    return means, bell, fit_bell(means, bell, options.general)


def _at_full_resolution(mode: BellMode, found: Decomposition, means: Decomposition) -> BellMode:
    """The same with the single lines that its averages were made of."""
    lines = 0 if means.window is None else means.window[0].size
    every = (mode.bell.lines[:, None] * lines + np.arange(lines)).reshape(-1)
    bell = Bell(every, np.repeat(mode.bell.order, lines), mode.bell.vector)
    return replace(mode, bell=bell, flags=(*mode.flags, f"lines_averaged={lines}"))


def _refusal(found: Decomposition, fit: FittedBell | None, at_hz: float, options: BellOptions) -> str | None:
    if fit is None:
        return "as their lines are not the bell of one mode"
    step = float(found.frequency_hz[1] - found.frequency_hz[0])
    reach = 2 * max(fit.damping_ratio * fit.natural_frequency_hz, 2 * step)
    if abs(fit.natural_frequency_hz - at_hz) > reach:
        return "as the fitted frequency leaves the peak"
    if fit.damping_ratio > options.largest_damping_ratio:
        return "the fitted damping is above largest_damping_ratio"
    if not found.frequency_hz[0] <= fit.natural_frequency_hz <= found.frequency_hz[-1]:
        return "the fitted natural frequency is outside the band"
    if fit.damping_ratio_std > fit.damping_ratio and 2 * fit.damping_ratio * fit.natural_frequency_hz > 3 * step:
        return "as the fitted damping is not known to its own size"
    return None


def _with_doubt(found: Decomposition, bell: Bell, fit: FittedBell, options: BellOptions) -> FittedBell:
    """The fit with standard deviations that cover how far it moves when only the upper part of the bell is used.

    What neighbouring modes do to the flanks is no scatter; a fit that depends on its reach is worth less.
    """
    high = found.values[bell.order, bell.lines] >= 10 ** (-_CORE_DB / 10) * found.values[bell.order, bell.lines].max()
    core = fit_bell(found, Bell(bell.lines[high], bell.order[high], bell.vector), options.general)
    if high.all() or core is None:
        return fit
    moved_hz = abs(core.natural_frequency_hz - fit.natural_frequency_hz)
    moved_ratio = abs(core.damping_ratio - fit.damping_ratio)
    # A subset scatters about the whole by its own excess; only what goes beyond counts.
    excess_hz = np.sqrt(max(moved_hz**2 - core.natural_frequency_std_hz**2, 0.0))
    excess_ratio = np.sqrt(max(moved_ratio**2 - core.damping_ratio_std**2, 0.0))
    return replace(
        fit,
        natural_frequency_std_hz=float(np.hypot(fit.natural_frequency_std_hz, excess_hz)),
        damping_ratio_std=float(np.hypot(fit.damping_ratio_std, excess_ratio)),
    )


def _mode(found: Decomposition, at_hz: float, bell: Bell, fit: FittedBell) -> BellMode:
    step = float(found.frequency_hz[1] - found.frequency_hz[0])
    flags = [f"peak_hz={at_hz:.3f}"]
    poor = fit.log_rms > _POOR_LOG_RMS and fit.chi_square > 4
    if 2 * fit.damping_ratio * fit.natural_frequency_hz < _NARROW_LINES * step:
        flags.append("narrow")
        if poor and fit.resolved:
            # A record that is cut while the mode rings widens the bell by a fraction of a line.
            cut = step / 4 / fit.natural_frequency_hz
            fit = replace(fit, damping_ratio_std=float(np.hypot(fit.damping_ratio_std, cut)))
    if not fit.resolved:
        flags.append("doubtful: damping poorly known")
    if not fit.converged:
        flags.append("fit_not_converged")
    if poor:
        flags.append("poor_fit")
    if _ends_early(found, bell):
        flags.append("doubtful_shape_turns")
    return BellMode(at_hz, bell, fit, tuple(flags))


def _ends_early(found: Decomposition, bell: Bell) -> bool:
    """Whether the shape changes before half power on a side: what is under such a bell is more than one mode.

    Two modes closer than their half-power widths are one peak of a matrix of rank one; the fraction fits
    a part of it well, and its standard deviations say nothing of the other mode.
    """
    value = found.values[bell.order, bell.lines]
    inside = np.array([bell.lines[0] > 0, bell.lines[-1] < found.frequency_hz.size - 1])
    return bool((inside & (value[[0, -1]] > 0.5 * value.max())).any())


def _distinct(modes: list[BellMode], refused: dict[str, list[float]]) -> tuple[BellMode, ...]:
    """The modes in order of frequency, without second copies of one bell."""
    kept: list[BellMode] = []
    for mode in sorted(modes, key=lambda m: abs(m.fit.natural_frequency_hz - m.peak_hz)):
        half = mode.fit.damping_ratio * mode.fit.natural_frequency_hz
        again = any(
            abs(mode.fit.natural_frequency_hz - k.fit.natural_frequency_hz) < 0.3 * half
            and modal_assurance(mode.bell.vector, k.bell.vector)[0, 0] > 0.8
            for k in kept
        )
        if again:
            refused.setdefault("as another peak has the same bell", []).append(mode.peak_hz)
        else:
            kept.append(mode)
    return _overlapping(sorted(kept, key=lambda m: m.fit.natural_frequency_hz))


def _overlapping(modes: list[BellMode]) -> tuple[BellMode, ...]:
    """Flags neighbours closer than four of their half widths: a bell takes up the other's flank only in part."""
    if not modes:
        return ()
    half = [m.fit.damping_ratio * m.fit.natural_frequency_hz for m in modes]
    at = [m.fit.natural_frequency_hz for m in modes]
    close = [at[i + 1] - at[i] < 4 * (half[i] + half[i + 1]) for i in range(len(modes) - 1)]
    beside = [a or b for a, b in zip([False, *close], [*close, False], strict=True)]
    return tuple(
        replace(m, flags=(*m.flags, "overlapping")) if near else m for m, near in zip(modes, beside, strict=True)
    )


def confirmed(spectra: CampaignSpectra, peak: SigmaPeak) -> bool:
    """Whether a peak of the raw ratio is more than a ripple that leakage makes.

    The local polynomial fit takes leakage up in its transient. A resonance wider than its window stays in
    the fit, a narrower one in its residual; a ripple is in neither.
    """
    step = float(spectra.frequency_hz[1] - spectra.frequency_hz[0])
    if max(peak.smoothing_lines, peak.width_hz / step) > 2 * LOCAL_HALF_WIDTH:
        return True
    line, lines = peak.line, spectra.frequency_hz.size
    near = slice(max(line - LOCAL_HALF_WIDTH, 0), line + LOCAL_HALF_WIDTH + 1)
    around = slice(max(line - _SURROUNDINGS, 0), min(line + _SURROUNDINGS + 1, lines))
    fitted = np.sum([(np.abs(r.local) ** 2).sum(axis=0) for r in spectra.runs], axis=0)
    missed = np.sum([(r.local_variance * np.abs(r.force) ** 2).sum(axis=0) for r in spectra.runs], axis=0)
    raw = np.sum([(np.abs(r.accelerance) ** 2).sum(axis=0) for r in spectra.runs], axis=0)
    seen = fitted[near].max() > 0.25 * raw[near].max() and _stands_out(fitted, near, around, 2.0)
    return bool(seen or _stands_out(missed, near, around, 8.0))


def _stands_out(power: NDArray[np.float64], near: slice, around: slice, factor: float) -> bool:
    """Whether the largest value near a line exceeds the lower quartile of its surroundings by a factor."""
    return bool(power[near].max() > factor * np.percentile(power[around], 25))


def visible(spectra: CampaignSpectra, modes: tuple[BellMode, ...]) -> tuple[BellMode, ...]:
    """The modes that a fit of all residues with leakage needs: above their errors, and no small part of the whole.

    Beside the poles of the others and what they still ring with, a ripple has nothing left to explain.
    """
    if not modes:
        return ()
    poles = np.array([m.pole for m in modes])
    at = [int(np.argmin(np.abs(spectra.frequency_hz - m.fit.natural_frequency_hz))) for m in modes]
    height, total, signal, rows = np.zeros(poles.size), np.zeros(poles.size), np.zeros(poles.size), 0
    for run in spectra.runs:
        fit = fit_residues(run, spectra.frequency_hz, poles)
        height += (np.abs(fit.residues * poles**2 / poles.real) ** 2).sum(axis=0)
        total += (np.abs(fit.fitted[:, at]) ** 2).sum(axis=0)
        signal += (np.abs(fit.residues) ** 2 / np.maximum(fit.std, 1e-300) ** 2).sum(axis=0)
        rows += len(run.responses)
    needed = (signal > _LEAST_SIGNIFICANCE**2 * rows) & (height > _LEAST_SHARE**2 * total)
    return tuple(m for m, keep in zip(modes, needed, strict=True) if keep)


def second_peaks(
    found: Decomposition, modes: tuple[BellMode, ...], false_alarm: float, orders: int = 2
) -> list[tuple[int, int]]:
    """Peaks (line, order) of the singular values below the first, up to ``orders``, that no mode so far explains."""
    from scipy.signal import find_peaks
    from scipy.stats import norm

    sigmas = float(norm.isf(false_alarm / max(found.frequency_hz.size, 1)))
    extra: list[tuple[int, int]] = []
    for order in range(1, min(orders, found.values.shape[0])):
        level = np.maximum(found.values[order] - found.noise[order], 1e-6 * found.noise[order] + 1e-300)
        tops, facts = find_peaks(np.log(level), prominence=0.7)
        for top, prominence in zip(tops, facts["prominences"], strict=True):
            weak = found.values[order, top] < _LEAST_SECOND * found.values[0, top]
            if weak or prominence < 2 * sigmas * found.relative_std[order, top]:
                continue
            vector = found.vectors[top, :, order]
            known = any(
                abs(m.fit.natural_frequency_hz - found.frequency_hz[top]) < 0.05 * found.frequency_hz[top]
                and modal_assurance(vector, m.bell.vector)[0, 0] > 0.5
                for m in modes
            )
            # Where the largest singular value belongs to the same shape, the peak is a crossing, not a mode.
            first = modal_assurance(vector, found.vectors[top, :, 0])[0, 0] > 0.5
            if not known and not first:
                extra.append((int(top), order))
    return extra


def own_fits(runs: tuple[Decomposition, ...], mode: BellMode, options: BellOptions) -> tuple[FittedBell | None, ...]:
    """The bell of one mode fitted in every run alone, None where a run cannot tell."""
    found = []
    half = mode.fit.damping_ratio * mode.fit.natural_frequency_hz
    for alone in runs:
        bell = Bell(mode.bell.lines, np.zeros_like(mode.bell.order), mode.bell.vector)
        fit = fit_bell(alone, bell, options.general)
        sound = (
            fit is not None
            and abs(fit.natural_frequency_hz - mode.fit.natural_frequency_hz) < 2 * half
            and 0.5 < fit.damping_ratio / mode.fit.damping_ratio < 2.0
            and fit.natural_frequency_std_hz < 0.1 * half
        )
        found.append(fit if sound else None)
    return tuple(found)
