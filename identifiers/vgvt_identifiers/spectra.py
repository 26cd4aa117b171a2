"""Whole-record spectra of every run, as the rows that the methods of this package fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Quantity, Record
from vgvt.signals.local_polynomial import LocalFit, local_polynomial_fit
from vgvt.signals.usable import doubt_of, fault_of
from vgvt_identifiers.common_lines import CommonLines, Measured, common_lines
from vgvt_identifiers.deaf_bands import deaf_bands
from vgvt_identifiers.named_dofs import named_once

DIFFERENTIATIONS = {Quantity.ACCELERATION: 0, Quantity.VELOCITY: 1, Quantity.DISPLACEMENT: 2}
"""How often each kind of motion is differentiated to be an acceleration."""
_NOISE_HALF_WIDTH = 12
_MEDIAN_OF_NOISE = 0.953  # median of chi-square over its mean, 14 degrees of freedom: 13 lines less 6 unknowns, complex
LOCAL_HALF_WIDTH = 6
FEWEST_LINES = 2 * _NOISE_HALF_WIDTH + 5
"""Lines that a band must hold before noise can be told from signal."""


@dataclass(frozen=True, slots=True, eq=False)
class RunSpectra:
    """One run: force (K,), accelerances (R, K) of its responses and their noise variance E|e|^2 (R, K).

    ``accelerance`` is the ratio of single transforms, no window and no average
    (Gupta, Seiler and Danowsky, AIAA 2016-1753, eq. 1); lines without any force are zero.
    ``local`` and ``local_variance`` (R, K) are the local polynomial estimate,
    free of leakage, which blurs what is narrower than its 13 lines. Where a part of a record was used,
    the force has the scale that gives it and the noise together the size of noise in the whole record.
    """

    run: int
    reference: Dof
    responses: tuple[Dof, ...]
    force: NDArray[np.complex128]
    accelerance: NDArray[np.complex128]
    variance: NDArray[np.float64]
    local: NDArray[np.complex128]
    local_variance: NDArray[np.float64]

    @property
    def averaged(self) -> bool:
        """Whether only ratios are known, the force standing as one: what a record leaks cannot be told from them."""
        return bool(np.all(self.force == 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class CampaignSpectra:
    """The usable runs on a common frequency axis (K,), and remarks on what was left out.

    ``added_decay_rad_per_s`` is what an exponential window has added to every decay rate.
    """

    frequency_hz: NDArray[np.float64]
    runs: tuple[RunSpectra, ...]
    remarks: tuple[str, ...]
    added_decay_rad_per_s: float = 0.0

    @property
    def power(self) -> NDArray[np.float64]:
        """Square of the sigma plot, sum of |H|^2 over every response of every run, (K,)."""
        return np.asarray(sum((np.abs(r.accelerance) ** 2).sum(axis=0) for r in self.runs))

    @property
    def responses(self) -> tuple[Dof, ...]:
        """Every response DOF once, in order of appearance."""
        return named_once(d for r in self.runs for d in r.responses)


def campaign_spectra(campaign: Campaign, band_hz: tuple[float, float]) -> CampaignSpectra:
    """Spectra of the runs that have one sound force and sound responses, on the lines inside ``band_hz``.

    Channels with samples that are not finite or all the same are left out with
    a remark, and so are runs without one usable force; where several act at once, each run is
    there once for every force. Runs of different lengths share the lines of the shorter ones (``common_lines``).
    Returns no runs when nothing is usable.
    """
    if any(len(r.select(ChannelRole.REFERENCE)[0]) > 1 for r in campaign.runs):
        # Imported here: that module gives its answer as the spectra that are defined in this one.
        from vgvt_identifiers.frf_spectra import several_forces_spectra

        return several_forces_spectra(campaign, band_hz)
    remarks: list[str] = []
    sound = [s for r in campaign.runs if (s := _sound_run(r, remarks)) is not None]
    if not sound:
        return CampaignSpectra(np.empty(0), (), tuple(remarks))
    common = common_lines([s.measured for s in sound], band_hz)
    highest = min(s.record.sample_rate_hz for s in sound) / 2
    if highest < band_hz[1] and len({s.record.sample_rate_hz for s in sound}) > 1:
        remarks.append(f"frequency lines end at {highest:.4g} Hz, half the lowest sample rate of the runs")
    numbers = np.arange(1, int(highest * common.length_s + 1e-9) + 1)
    frequency = numbers / common.length_s
    inside = (frequency >= band_hz[0]) & (frequency <= band_hz[1])
    numbers, frequency = numbers[inside], frequency[inside]
    runs = [_run_spectra(s, common, numbers) for s in sound if s.record.run in common.samples]
    return CampaignSpectra(frequency, tuple(runs), (*remarks, *common.remarks, *_deaf_bands(frequency, runs)))


def _deaf_bands(frequency_hz: NDArray[np.float64], runs: list[RunSpectra]) -> list[str]:
    """A remark for every part of the band in which what follows the force is less than the noise."""
    if frequency_hz.size < FEWEST_LINES or not runs:
        return []
    power = np.sum([(np.abs(r.accelerance) ** 2).sum(axis=0) for r in runs], axis=0)
    noise = np.sum([r.variance.sum(axis=0) for r in runs], axis=0)
    return [
        f"{low:.3g} to {high:.3g} Hz: the responses do not follow the force (coherence under 0.5), so what is claimed "
        "there is noise; drive these frequencies longer or harder"
        for low, high in deaf_bands(frequency_hz, power, noise)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _SoundRun:
    """A record with its one force and its responses that measure a motion."""

    record: Record
    force: tuple[Channel, NDArray[np.floating]]
    responses: tuple[tuple[Channel, NDArray[np.floating]], ...]

    @property
    def measured(self) -> Measured:
        """What the choice of common lines asks for."""
        return Measured(self.record.run, self.record.sample_rate_hz, self.force[1], len(self.responses))


def _sound_run(record: Record, remarks: list[str]) -> _SoundRun | None:
    sound = []
    for channel, samples in zip(record.channels, record.samples, strict=True):
        fault = None if channel.role is ChannelRole.DRIVE else fault_of(samples, record.sample_rate_hz)
        if fault is None and channel.role is ChannelRole.RESPONSE and channel.quantity not in DIFFERENTIATIONS:
            fault = "it measures no motion"
        if fault is None:
            sound.append((channel, samples))
            doubt = None if channel.role is ChannelRole.DRIVE else doubt_of(samples)
            if doubt is not None:
                remarks.append(f"run {record.run}: {channel.name} ({channel.dof}): {doubt}")
        else:
            remarks.append(f"run {record.run}: {channel.name} ({channel.dof}) left out, {fault}")
    forces = [(c, x) for c, x in sound if c.role is ChannelRole.REFERENCE]
    responses = tuple((c, x) for c, x in sound if c.role is ChannelRole.RESPONSE)
    if len(forces) != 1 or not responses:
        what = f"{len(forces)} usable forces, one is needed" if responses else "no usable response"
        remarks.append(f"run {record.run} left out: {what}")
        return None
    return _SoundRun(record, forces[0], responses)


def _run_spectra(run: _SoundRun, common: CommonLines, lines: NDArray[np.intp]) -> RunSpectra:
    number, rate_hz = run.record.run, run.record.sample_rate_hz
    used, omega = common.samples[number], 2j * np.pi * lines / common.length_s
    scale = np.sqrt(run.force[1].size / used)
    force = scale * common.transform(run.force[1][:used], rate_hz, lines)
    spectra = [
        scale * common.transform(x[:used], rate_hz, lines) * omega ** DIFFERENTIATIONS[c.quantity]
        for c, x in run.responses
    ]
    reference, dofs = _dof(run.force[0]), tuple(_dof(c) for c, _ in run.responses)
    ratio = _ratio(np.array(spectra), force)
    if lines.size < FEWEST_LINES:
        blank = np.full(ratio.shape, np.inf)
        return RunSpectra(number, reference, dofs, force, ratio, blank, ratio, blank)
    local = _local_fit(ratio, force)
    variance = line_variance(ratio, force, local.noise_power)
    return RunSpectra(number, reference, dofs, force, ratio, variance, local.values[:, 0], local.variance[:, 0])


def _dof(channel: Channel) -> Dof:
    assert channel.dof is not None  # a Channel that is no drive has a DOF
    return channel.dof


def _ratio(response: NDArray[np.complex128], force: NDArray[np.complex128]) -> NDArray[np.complex128]:
    alive = np.abs(force) > 1e-12 * np.abs(force).max(initial=0.0)
    return np.divide(response, force, out=np.zeros_like(response), where=alive)


def line_variance(
    ratio: NDArray[np.complex128], force: NDArray[np.complex128], local_noise_power: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Variance E|e|^2 (R, K) of ratios (R, K), the smaller of two estimates, each a median over 25 lines.

    The fourth difference of the ratio over lines removes what is smooth, but
    not leakage; the local polynomial fit leaves ``local_noise_power`` (R, K)
    E|n|^2 of the response, free of leakage, but takes narrow resonances for noise.
    """
    magnitude = np.maximum(np.abs(force), 1e-12 * np.abs(force).max())
    taps = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
    lines = force.size
    difference = sum(t * ratio[:, i : lines - 4 + i] for i, t in enumerate(taps))
    spread = sum(t**2 / magnitude[i : lines - 4 + i] ** 2 for i, t in enumerate(taps))
    rough = np.pad(np.abs(difference) ** 2 / spread, ((0, 0), (2, 2)), mode="edge")
    level = np.minimum(running_median(rough) / np.log(2), running_median(local_noise_power) / _MEDIAN_OF_NOISE)
    return np.asarray(level / magnitude**2)


def running_median(noise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Median (R, K) over the 25 lines around every line of powers (R, K)."""
    from scipy.ndimage import median_filter

    # Row by row: the filter of one dimension is several times faster than the same one in two.
    return np.array([median_filter(row, size=2 * _NOISE_HALF_WIDTH + 1, mode="nearest") for row in noise])


def _local_fit(ratio: NDArray[np.complex128], force: NDArray[np.complex128]) -> LocalFit:
    """Local polynomial estimate on every line; the method wants the 0 Hz line in front, which it never uses."""
    response = np.pad(ratio * force, ((0, 0), (1, 0)))
    lines = np.arange(1, force.size + 1)
    return local_polynomial_fit(response, np.pad(force, (1, 0))[None], lines, half_width=LOCAL_HALF_WIDTH)
