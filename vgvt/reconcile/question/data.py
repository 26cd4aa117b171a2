"""What a campaign says: accelerance of every run and channel at full resolution, with how far to trust each line."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, Dof, InputError
from vgvt.data.shown import counted, headed
from vgvt.reconcile.mechanics.ending import Ending
from vgvt.reconcile.question.arguments import check_campaign, check_floor, check_lines
from vgvt.reconcile.question.excited import excited_lines
from vgvt.reconcile.question.harmonics import Harmonic, harmonics
from vgvt.reconcile.question.shared_noise import in_phase
from vgvt.reconcile.question.spectra import Spectra, spectra_of
from vgvt.reconcile.question.suitable import FEWEST_LINES, check_quantities
from vgvt.reconcile.question.variance import local_rational_noise, quiet_noise, repeat_noise
from vgvt.signals.local_polynomial import local_polynomial_fit
from vgvt.signals.usable import UsableRun, usable_runs

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LINES = 500
_WEAK_FORCE = 0.03
_TOUCHED = 0.01
_HALF_WIDTH, _ORDER = 8, 2
# Of its peak: a force acts from when it first reaches this to when it last does.
_ACTS = 0.1


@dataclass(frozen=True, slots=True)
class MeasuredChannel:
    """One response of one run; ``run`` counts from 0, ``instrument`` is its place among the run's sensors."""

    run: int
    run_number: int
    dof: Dof
    instrument: int

    def __repr__(self) -> str:
        return f"<{self.label}>"

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
    Forces are those along the positive axis: of a channel ``100-Z`` the samples are negated.
    A channel that could not be ``used`` (C,) has no values and an infinite ``sigma``: its sensor loads the aircraft,
    and nothing is asked of it.
    ``harmonics`` are those that no linear answer explains, and those that one does, of every run that is a sweep.
    ``endings`` are those of the runs' records, by which these leave something out. ``of_force`` (C, L) is the root
    of the share of ``noise`` that the force's makes, which a run's channels have in common, in phase with ``values``.
    ``largest_m_per_s2`` is the largest acceleration in any record; nothing where none is at hand.
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
    pushed: Array
    remarks: tuple[str, ...] = ()
    harmonics: tuple[Harmonic, ...] = ()
    endings: tuple[Ending, ...] = ()
    lost: NDArray[np.bool_] | None = None
    of_force: ComplexArray | None = None
    largest_m_per_s2: float = 0.0

    def __repr__(self) -> str:
        f, points = self.frequency_hz, len({c.dof for c in self.channels})
        lines = counted(f.size, "line") + (f" from {f[0]:.4g} to {f[-1]:.4g} Hz" if f.size else "")
        unused = int((~self.used).sum())
        return headed(
            f"Measured: A/F in (m/s^2)/N of {counted(len(self.runs), 'run')}, {counted(len(self.channels), 'channel')} "
            f"at {counted(points, 'point')}, {lines}{f'; not used: {unused}' if unused else ''}",
            self.remarks,
            most=3,
        )

    @property
    def level_n(self) -> Array:
        """Root mean square of the force of every run (R,), N, while it acts."""
        return level_of(self.pushed)

    @property
    def used(self) -> NDArray[np.bool_]:
        """Which channels hold data, (C,)."""
        return np.ones(len(self.channels), dtype=bool) if self.lost is None else ~self.lost

    @property
    def run_numbers(self) -> tuple[int, ...]:
        """What the campaign calls its runs, (R,); one without any channel is called by its place."""
        known = {c.run: c.run_number for c in self.channels}
        return tuple(known.get(r, r + 1) for r in range(len(self.runs)))

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


def level_of(pushed: Array) -> Array:
    """Root mean square of forces (R, N) while they act, (R,): however long one does, a level is one."""
    found = np.zeros(len(pushed))
    for r, force in enumerate(np.abs(pushed)):
        acts = np.flatnonzero(force >= _ACTS * force.max())
        found[r] = np.sqrt(np.mean(force[acts[0] : acts[-1] + 1] ** 2))
    return found


def measured_frfs(
    campaign: Campaign, *, lines: int = LINES, floor: float = 0.004, band_hz: tuple[float, float] | None = None
) -> Measured:
    """The accelerances of a campaign, thinned to about ``lines`` lines that are denser where something happens.

    Whole-record spectra, zero-padded to the longest record; one that ends ringing is tapered, and the lines where the
    taper touches the force are left out. Variance by local rational models (McKelvey and Guérin, IFAC Proc. 45(16),
    2012): local polynomials (Schoukens et al., European Journal of Control 15, 2009) and quiet times take a light mode
    for noise, repeats take drift for noise. InputError without a single usable reference, of what is no acceleration or
    force in SI, where too few lines are asked for or left, and for a ``floor`` that is no relative error.
    """
    check_campaign(campaign)
    check_lines(lines)
    check_floor(floor)
    check_quantities(campaign)
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
    spectra, said = spectra_of(runs, rate)
    frequency = np.asarray(np.arange(spectra.samples // 2 + 1) * (rate / spectra.samples), dtype=np.float64)
    low, high = band_hz or campaign.band_hz
    usable = _usable_lines(spectra, frequency, (low, high), campaign.name)
    channels, rows = _channels(runs)
    excited = np.zeros(frequency.size, dtype=bool)
    band_lines = np.flatnonzero((frequency >= low) & (frequency <= high) & (frequency > 0))
    excited[band_lines] = excited_lines(np.abs(spectra.force[:, band_lines]))
    chosen = _chosen(spectra, usable, excited, lines)
    values = np.array([spectra.response[i][chosen] / spectra.force[c.run][chosen] for c, i in rows])
    variances, of_force = _variances(runs, spectra, rows, chosen, rate)
    noise = variances["local rational"]
    force = spectra.force[:, chosen]
    found = Measured(
        frequency[chosen], channels, values, noise, variances, _sigma(values, noise, floor), force, chosen,
        rate / spectra.samples, tuple(tuple(_dof(c).node for c in run.mounted) for run in runs), rate,
        spectra.pushed, (*remarks, *said), _harmonics(runs, spectra, rate, (low, high)),
        tuple(
            Ending.of(end.force, rate, end.tapered, frequency[chosen], force[r]) for r, end in enumerate(spectra.ends)
        ), of_force=in_phase(of_force, values), largest_m_per_s2=spectra.largest,
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


def _usable_lines(spectra: Spectra, frequency: Array, band: tuple[float, float], name: str) -> NDArray[np.intp]:
    inside = (frequency >= band[0]) & (frequency <= band[1]) & (frequency > 0)
    force = np.abs(spectra.force)
    loud = (force > _WEAK_FORCE * np.median(force[:, inside], axis=1, keepdims=True)).all(axis=0)
    keep = inside & loud
    clear = (np.abs(spectra.touched) < _TOUCHED * force).all(axis=0)
    # A noise-like excitation has no line that the end does not touch: then all must do.
    keep = keep & clear if (keep & clear).sum() > 0.5 * keep.sum() else keep
    lines = np.flatnonzero(keep)
    if lines.size < FEWEST_LINES:
        raise InputError(
            name,
            f"only {lines.size} lines from {band[0]:g} to {band[1]:g} Hz hold enough force in every run, and "
            f"{FEWEST_LINES} are needed",
            "widen --band, leave out runs that end before their sweep does, or use longer records",
        )
    return lines


def _chosen(spectra: Spectra, usable: NDArray[np.intp], excited: NDArray[np.bool_], count: int) -> NDArray[np.intp]:
    """About ``count`` of the usable lines, those that are ``excited`` (K,) first: between them noise alone answers.

    Half as many are enough; where there are fewer, lines between them, on which little force is, join them.
    """
    lit = usable[excited[usable]]
    if 2 * lit.size >= count or lit.size == usable.size:
        return _thinned(spectra, lit, count)
    dark = usable[~excited[usable]]
    return np.sort(np.concatenate([lit, _thinned(spectra, dark, count - lit.size)]))


def _thinned(spectra: Spectra, usable: NDArray[np.intp], count: int) -> NDArray[np.intp]:
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
    spectra: Spectra,
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
        force, own = spectra.force[r], spectra.own[r]
        # White noise has the same power on the lines of a record and between them.
        at, power = own.nearest(chosen, spectra.samples), np.abs(force[chosen]) ** 2
        fit = local_polynomial_fit(own.responses, own.force[None], at, _ORDER, _HALF_WIDTH)
        polynomial[mine] = fit.noise_power / power
        whole, of_force[mine] = local_rational_noise(own.responses, own.force, at)
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
    runs: tuple[UsableRun, ...], spectra: Spectra, rate: float, band: tuple[float, float]
) -> tuple[Harmonic, ...]:
    """Orders 2 and 3 of every run."""
    found: list[Harmonic] = []
    for run, own in zip(runs, spectra.own, strict=True):
        if len(own.responses):
            found += harmonics(own.responses, own.force, own.samples, rate, band, run.run)
    return tuple(found)


def _sigma(values: ComplexArray, noise: Array, floor: float) -> Array:
    """Standard deviation to judge a model by: noise, relative floor, and the same share of each channel's median."""
    size = np.abs(values)
    middle = np.median(size, axis=1, keepdims=True)
    return np.asarray(np.sqrt(noise + (floor * size) ** 2 + (floor * middle) ** 2))
