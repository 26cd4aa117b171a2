"""What a campaign says: accelerance of every run and channel at full resolution, with how far to trust each line."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, Dof, InputError
from vgvt.reconcile.mechanics.ending import Ending
from vgvt.reconcile.question.harmonics import Harmonic, harmonics
from vgvt.reconcile.question.shared_noise import in_phase
from vgvt.reconcile.question.variance import local_rational_noise, quiet_noise, repeat_noise
from vgvt.signals.local_polynomial import local_polynomial_fit
from vgvt.signals.usable import UsableRun, usable_runs

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LINES = 500
_TAPER_S = 1.5
_AT_REST = 0.02
_WEAK_FORCE = 0.03
_TOUCHED = 0.01
_HALF_WIDTH, _ORDER = 8, 2


@dataclass(frozen=True, slots=True)
class MeasuredChannel:
    """One response of one run; ``run`` counts from 0, ``instrument`` is its place among the run's sensors."""

    run: int
    run_number: int
    dof: Dof
    instrument: int

    @property
    def label(self) -> str:
        """``run 3, 12+Z``."""
        return f"run {self.run_number}, {self.dof}"


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Accelerances A/F of every run and channel at the chosen lines, SI.

    ``frequency_hz`` (L,); ``values`` (C, L); ``noise`` (C, L) is the variance E|G - EG|² of the measurement, by
    local rational models; ``variances`` holds it and cruder ones to compare with; ``sigma`` (C, L) is the standard
    deviation to judge a model by, with its floor; ``force`` (R, L) are the force spectra and ``lines`` (L,) their
    indices at ``resolution_hz``; ``pushed`` (R, N) is the force itself, N, over the longest record, no taper on it.
    A channel that could not be ``used`` (C,) has no values and an infinite ``sigma``: its sensor loads the aircraft,
    and nothing is asked of it.
    ``harmonics`` are those that no linear answer explains, and those that one does, of every run that is a sweep.
    ``endings`` are those of the runs' records, by which these leave something out. ``of_force`` (C, L) is the root
    of the share of ``noise`` that the force's makes, which a run's channels have in common, in phase with ``values``.
    """

    frequency_hz: Array
    channels: tuple[MeasuredChannel, ...]
    values: ComplexArray
    noise: Array
    variances: dict[str, Array]
    sigma: Array
    force: ComplexArray
    lines: NDArray[np.intp]
    resolution_hz: float
    runs: tuple[tuple[int, ...], ...]
    sample_rate_hz: float
    level_n: Array
    pushed: Array
    remarks: tuple[str, ...] = ()
    harmonics: tuple[Harmonic, ...] = ()
    endings: tuple[Ending, ...] = ()
    lost: NDArray[np.bool_] | None = None
    of_force: ComplexArray | None = None

    @property
    def used(self) -> NDArray[np.bool_]:
        """Which channels hold data, (C,)."""
        return np.ones(len(self.channels), dtype=bool) if self.lost is None else ~self.lost

    def with_floor(self, floor: float) -> Measured:
        """The same data judged with another relative model-form floor."""
        return replace(self, sigma=np.where(self.used[:, None], _sigma(self.values, self.noise, floor), np.inf))

    def some(self, keep: NDArray[np.bool_]) -> Measured:
        """Only some channels (C,) bool; runs stay."""
        index = np.flatnonzero(keep)
        return replace(
            self,
            channels=tuple(self.channels[i] for i in index),
            values=self.values[index],
            noise=self.noise[index],
            variances={name: v[index] for name, v in self.variances.items()},
            sigma=self.sigma[index],
            lost=None if self.lost is None else self.lost[index],
            of_force=None if self.of_force is None else self.of_force[index],
        )


def measured_frfs(
    campaign: Campaign, *, lines: int = LINES, floor: float = 0.004, band_hz: tuple[float, float] | None = None
) -> Measured:
    """The accelerances of a campaign, thinned to about ``lines`` lines that are denser where something happens.

    Whole-record spectra, zero-padded to the longest record; one that ends ringing is tapered, and the lines where the
    taper touches the force are left out. Variance by local rational models (McKelvey and Guérin, IFAC Proc. 45(16),
    2012): local polynomials (Schoukens et al., European Journal of Control 15, 2009) and quiet times take a light mode
    for noise, repeats take drift for noise. InputError without a single usable reference.
    """
    runs, remarks = usable_runs(campaign, every_run=True)
    for run in runs:
        if len(run.references) != 1:
            raise InputError(
                f"{campaign.name}, run {run.run}",
                f"{len(run.references)} forces act at once",
                "reconcile takes one shaker at a time: leave the other runs out",
            )
    rates = {run.sample_rate_hz for run in runs}
    if len(rates) > 1:
        raise InputError(campaign.name, f"runs of different sample rates: {sorted(rates)}", "resample them to one rate")
    rate = rates.pop()
    spectra, said = _spectra(runs, rate)
    frequency = np.asarray(np.arange(spectra.samples // 2 + 1) * (rate / spectra.samples), dtype=np.float64)
    low, high = band_hz or campaign.band_hz
    usable = _usable_lines(spectra, frequency, (low, high))
    channels, rows = _channels(runs)
    chosen = _chosen(spectra, usable, lines)
    values = np.array([spectra.response[i][chosen] / spectra.force[c.run][chosen] for c, i in rows])
    variances, of_force = _variances(runs, spectra, rows, chosen, rate)
    noise = variances["local rational"]
    force = spectra.force[:, chosen]
    level = np.sqrt(np.mean(np.abs(force) ** 2, axis=1)) * 2 / spectra.samples
    found = Measured(
        frequency[chosen], channels, values, noise, variances, _sigma(values, noise, floor), force, chosen,
        rate / spectra.samples, tuple(tuple(_dof(c).node for c in run.mounted) for run in runs), rate, level,
        spectra.pushed, (*remarks, *said), _harmonics(runs, spectra, rows, rate, (low, high)),
        tuple(
            Ending.of(end.force, rate, end.tapered, frequency[chosen], force[r]) for r, end in enumerate(spectra.ends)
        ), of_force=in_phase(of_force, values),
    )  # fmt: skip
    return _with_mounted(found, runs)


def _with_mounted(found: Measured, runs: tuple[UsableRun, ...]) -> Measured:
    """The same with rows for every sensor on the aircraft, in the order of the records' channels."""
    every = tuple(
        MeasuredChannel(r, run.run, _dof(channel), k)
        for r, run in enumerate(runs)
        for k, channel in enumerate(run.mounted)
    )
    if len(every) == len(found.channels):
        return found
    row = {channel: i for i, channel in enumerate(found.channels)}
    at = np.array([row.get(channel, -1) for channel in every])

    def spread(values: NDArray[Any], missing: float) -> NDArray[Any]:
        out: NDArray[Any] = values[at]
        out[at < 0] = missing
        return out

    return replace(
        found, channels=every, values=spread(found.values, 0.0), noise=spread(found.noise, 0.0),
        variances={name: spread(v, 0.0) for name, v in found.variances.items()}, sigma=spread(found.sigma, np.inf),
        lost=at < 0, of_force=None if found.of_force is None else spread(found.of_force, 0.0),
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    """The force (N,) of a record as it was, and how many of its last samples are tapered."""

    force: Array
    tapered: int


@dataclass(frozen=True, slots=True, eq=False)
class _Spectra:
    """Whole-record spectra: force (R, K), response (all channels in order, K), what the taper touches (R, K).

    ``pushed`` (R, N) is the force that they are of; ``ends`` are those of the records.
    """

    force: ComplexArray
    response: ComplexArray
    touched: ComplexArray | None
    pushed: Array
    ends: tuple[_End, ...]

    @property
    def samples(self) -> int:
        """Length of the longest record."""
        return int(self.pushed.shape[1])


def _dof(channel: Channel) -> Dof:
    assert channel.dof is not None, "Channel refuses responses without a DOF"
    return channel.dof


def _channels(runs: tuple[UsableRun, ...]) -> tuple[tuple[MeasuredChannel, ...], list[tuple[MeasuredChannel, int]]]:
    found = [
        MeasuredChannel(r, run.run, _dof(channel), run.mounted.index(channel))
        for r, run in enumerate(runs)
        for channel in run.responses
    ]
    return tuple(found), [(channel, i) for i, channel in enumerate(found)]


def _spectra(runs: tuple[UsableRun, ...], rate: float) -> tuple[_Spectra, tuple[str, ...]]:
    samples = max(run.samples for run in runs)
    force: list[ComplexArray] = []
    response: list[ComplexArray] = []
    touched: list[ComplexArray] = []
    pushed = np.zeros((len(runs), samples))
    remarks: list[str] = []
    ends: list[_End] = []
    for r, run in enumerate(runs):
        signals = np.array([run.reference_samples[0], *run.response_samples], dtype=float)
        signals -= signals.mean(axis=1, keepdims=True)
        pushed[r, : signals.shape[1]] = signals[0]
        window = _window(signals, rate)
        if window is not None:
            said = f"its last {_TAPER_S:g} s are tapered, which predictions know"
            remarks.append(f"run {run.run}: the record ends ringing; {said}")
            ends.append(_End(signals[0], int((window < 1).sum())))
            touched.append(np.fft.rfft(signals[0] * window * (1 - window), samples))
            signals = signals * window
        else:
            ends.append(_End(signals[0], 0))
            touched.append(np.zeros(samples // 2 + 1, dtype=complex))
        spectrum = np.fft.rfft(signals, samples, axis=1)
        force.append(spectrum[0])
        response.extend(spectrum[1:])
    return _Spectra(np.array(force), np.array(response), np.array(touched), pushed, tuple(ends)), tuple(remarks)


def _window(signals: Array, rate: float) -> Array | None:
    """A taper of the end where the record does not end at rest, else None."""
    tail = signals[:, -max(2, round(0.25 * rate)) :]
    # Ringing fills few of the tail's frequencies; what fills half of them is noise, and rests as it ever does.
    power = np.abs(np.fft.rfft(tail * np.hanning(tail.shape[1]), axis=1)) ** 2
    excess = np.clip(1 - 2 * np.median(power, axis=1) / power.mean(axis=1), 0, None)
    ringing = np.sqrt(excess * (tail**2).mean(axis=1)) > _AT_REST * np.sqrt((signals**2).mean(axis=1))
    if not ringing.any():
        return None
    count = min(round(_TAPER_S * rate), signals.shape[1] // 4)
    window = np.ones(signals.shape[1])
    window[-count:] = 0.5 * (1 + np.cos(np.pi * (np.arange(count) + 0.5) / count))
    return window


def _usable_lines(spectra: _Spectra, frequency: Array, band: tuple[float, float]) -> NDArray[np.intp]:
    inside = (frequency >= band[0]) & (frequency <= band[1]) & (frequency > 0)
    force = np.abs(spectra.force)
    loud = (force > _WEAK_FORCE * np.median(force[:, inside], axis=1, keepdims=True)).all(axis=0)
    keep = inside & loud
    if spectra.touched is not None:
        clear = (np.abs(spectra.touched) < _TOUCHED * force).all(axis=0)
        # A noise-like excitation has no line that the end does not touch: then all must do.
        keep = keep & clear if (keep & clear).sum() > 0.5 * keep.sum() else keep
    lines = np.flatnonzero(keep)
    if lines.size < 4 * _HALF_WIDTH:
        raise InputError(
            "campaign",
            f"only {lines.size} lines of the band hold enough force",
            "widen the band, or use longer records",
        )
    return lines


def _chosen(spectra: _Spectra, usable: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Lines at equal steps of an even share plus how fast the responses change, (lines,)."""
    if usable.size <= count:
        return usable
    width = max(1, usable.size // 2000)
    activity = np.zeros(usable.size)
    for row in spectra.response:
        level = np.convolve(np.abs(row[usable]), np.ones(2 * width + 1) / (2 * width + 1), mode="same")
        activity += np.abs(np.gradient(np.log(level + 1e-3 * np.median(level))))
    activity = np.convolve(activity, np.ones(9) / 9, mode="same")
    density = 1.0 / usable.size + activity / activity.sum()
    quantile = np.cumsum(density) / density.sum()
    picked = np.searchsorted(quantile, (np.arange(count) + 0.5) / count)
    return usable[np.unique(np.clip(picked, 0, usable.size - 1))]


def _variances(
    runs: tuple[UsableRun, ...],
    spectra: _Spectra,
    rows: list[tuple[MeasuredChannel, int]],
    chosen: NDArray[np.intp],
    rate: float,
) -> tuple[dict[str, Array], Array]:
    """Variances (C, L) of A/F by name, and the share (C, L) of the local rational one that is the force's."""
    polynomial, rational, quiet, of_force = np.empty((4, len(rows), chosen.size))
    for r, run in enumerate(runs):
        mine = [i for c, i in rows if c.run == r]
        if not mine:
            continue
        force = spectra.force[r]
        fit = local_polynomial_fit(spectra.response[mine], force[None], chosen, _ORDER, _HALF_WIDTH)
        power = np.abs(force[chosen]) ** 2
        polynomial[mine] = fit.noise_power / power
        whole, of_force[mine] = local_rational_noise(spectra.response[mine], force, chosen)
        rational[mine] = whole / power
        frequency = chosen * rate / spectra.samples
        base = np.array([quiet_noise(x, rate, frequency) for x in run.response_samples])
        pushed = quiet_noise(run.reference_samples[0], rate, frequency)
        # A one-sided density S over T seconds is a variance of S fs N / 2 in the plain sum of N samples.
        values = np.abs(spectra.response[mine][:, chosen] / force[chosen]) ** 2
        quiet[mine] = (base + values * pushed) * rate * run.samples / 2 / power
    found = {"local polynomial": polynomial, "local rational": rational}
    # Where every frequency is excited at every time there is no quiet.
    if np.median(quiet) < 10 * np.median(polynomial):
        found["quiet times"] = quiet
    repeats = repeat_noise(spectra.response, spectra.force, rows, chosen)
    if repeats is not None:
        found["repeats"] = repeats
    return found, of_force


def _harmonics(
    runs: tuple[UsableRun, ...],
    spectra: _Spectra,
    rows: list[tuple[MeasuredChannel, int]],
    rate: float,
    band: tuple[float, float],
) -> tuple[Harmonic, ...]:
    """Orders 2 and 3 of every run."""
    found: list[Harmonic] = []
    for r, run in enumerate(runs):
        mine = [i for c, i in rows if c.run == r]
        if mine:
            found += harmonics(spectra.response[mine], spectra.force[r], spectra.samples, rate, band, run.run)
    return tuple(found)


def _sigma(values: ComplexArray, noise: Array, floor: float) -> Array:
    """Standard deviation to judge a model by: noise, relative floor, and the same share of each channel's median."""
    size = np.abs(values)
    middle = np.median(size, axis=1, keepdims=True)
    return np.asarray(np.sqrt(noise + (floor * size) ** 2 + (floor * middle) ** 2))
