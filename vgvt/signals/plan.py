"""What all runs of an estimate must share: cuts, frequency axis, quantity and the sign of each direction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Channel, ChannelRole, Dof, InputError, Quantity
from vgvt.signals.averages import Averages
from vgvt.signals.dwells import DwellSchedule, fit_dwells
from vgvt.signals.impact import ImpactWindows, cut_at_hits
from vgvt.signals.spectra import Cut, welch_segments, whole_record
from vgvt.signals.usable import UsableRun

_TIME_DERIVATIVES = {Quantity.DISPLACEMENT: 0, Quantity.VELOCITY: 1, Quantity.ACCELERATION: 2}


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """How the runs of a campaign are brought to common frequency lines, labels and one quantity.

    ``frequency_hz`` are all lines of the spectra, ``lines`` the indices of those
    asked for. ``labels`` gives the first-seen label of each unsigned DOF.
    ``added_decay_rad_per_s`` is what an exponential window adds to every decay rate.
    """

    cuts: dict[int, Cut]
    frequency_hz: NDArray[np.float64]
    lines: NDArray[np.intp]
    quantity: Quantity
    labels: dict[Dof, Dof]
    added_decay_rad_per_s: float = 0.0

    def spectrum(self, run: int, channel: Channel, samples: NDArray[np.floating]) -> NDArray[np.complex128]:
        """Spectra (segments, all lines) of a channel along its labelled direction, responses in ``quantity``."""
        spectrum = self.cuts[run].spectra(samples, force=channel.role is ChannelRole.REFERENCE)
        if dof_of(channel).direction.sign != self.label(channel).direction.sign:
            spectrum *= -1
        if channel.quantity in _TIME_DERIVATIVES and channel.quantity is not self.quantity:
            steps = _TIME_DERIVATIVES[self.quantity] - _TIME_DERIVATIVES[channel.quantity]
            # Through exp(-t/τ) a derivative is s = 1/τ + iω, not iω.
            spectrum *= (self.added_decay_rad_per_s + 2j * np.pi * self.frequency_hz) ** steps
        return spectrum

    def forces(self, run: UsableRun) -> tuple[tuple[Dof, ...], NDArray[np.complex128]]:
        """The references of a run in the order of their DOFs, and their spectra (R, segments, all lines)."""
        order = sorted(range(len(run.references)), key=lambda i: dof_of(run.references[i]).unsigned)
        spectra = [self.spectrum(run.run, run.references[i], run.reference_samples[i]) for i in order]
        return tuple(self.label(run.references[i]) for i in order), np.array(spectra)

    def label(self, channel: Channel) -> Dof:
        """The label under which the DOF of a channel was first seen, whatever its sign."""
        return self.labels[dof_of(channel).unsigned]


def make_plan(
    where: str,
    runs: tuple[UsableRun, ...],
    averages: Averages,
    band_hz: tuple[float, float] | None,
    special: DwellSchedule | ImpactWindows | None = None,
    *,
    own_lines: bool = False,
) -> tuple[Plan, tuple[str, ...]]:
    """The plan and remarks on it; InputError when the runs cannot be brought together.

    ``special`` cuts the records at the dwells of a stepped sine or the hits of a hammer. With ``own_lines`` whole
    records may differ in length and rate: the lines are those of the coarsest that all of them reach.
    """
    special_remarks: tuple[str, ...] = ()
    if isinstance(special, DwellSchedule):
        cuts = _cuts_at_dwells(where, runs, special)
    elif isinstance(special, ImpactWindows):
        cuts, special_remarks = _cuts_at_hits(where, runs, special)
    elif own_lines:
        cuts = {run.run: whole_record(run.samples) for run in runs}
    else:
        cuts = _cuts(where, runs, averages)
    coarsest = max(runs, key=lambda run: run.sample_rate_hz / run.samples) if own_lines else runs[0]
    frequency = cuts[coarsest.run].frequency_hz(coarsest.sample_rate_hz)
    if own_lines:
        frequency = frequency[frequency <= min(run.sample_rate_hz for run in runs) / 2]
    low, high = band_hz or (0.0, np.inf)
    lines = np.flatnonzero((frequency >= low) & (frequency <= high) & (frequency > 0))
    if lines.size < 2:
        raise InputError(where, f"fewer than two frequency lines in {low:g} to {high:g} Hz", "widen the band")
    quantity, remarks = _common_quantity(where, runs)
    labels: dict[Dof, Dof] = {}
    for channel in (c for run in runs for c in (*run.references, *run.responses)):
        labels.setdefault(dof_of(channel).unsigned, dof_of(channel))
    added = special.added_decay_rad_per_s if isinstance(special, ImpactWindows) else 0.0
    return Plan(cuts, frequency, lines, quantity, labels, added), (*special_remarks, *remarks)


def dof_of(channel: Channel) -> Dof:
    """The DOF of a response or reference, which always has one."""
    assert channel.dof is not None, "Channel refuses responses and references without a DOF"
    return channel.dof


def _common_quantity(where: str, runs: tuple[UsableRun, ...]) -> tuple[Quantity, tuple[str, ...]]:
    """The quantity that all responses share, else acceleration, to which the others are differentiated."""
    found = {c.quantity for run in runs for c in run.responses}
    if len(found) == 1:
        return found.pop(), ()
    if not found <= set(_TIME_DERIVATIVES):
        raise InputError(
            where,
            f"responses of different kinds: {', '.join(sorted(q.name.lower() for q in found))}",
            "only displacement, velocity and acceleration can be brought to one quantity; estimate the rest separately",
        )
    return Quantity.ACCELERATION, ("displacements and velocities are differentiated to acceleration",)


def _cuts(where: str, runs: tuple[UsableRun, ...], averages: Averages) -> dict[int, Cut]:
    """How each run is cut; InputError unless all end up on the same frequency axis."""
    _check_common(where, "sample rate", "Hz", {r.run: r.sample_rate_hz for r in runs}, "resample them to one rate")
    if averages.segment_s is None:
        advice = "cut or zero-pad them to one length, or use 'h1' with segment_s"
        _check_common(where, "length", "samples", {r.run: float(r.samples) for r in runs}, advice)
        return {r.run: whole_record(r.samples) for r in runs}
    shortest = min(runs, key=lambda r: r.samples)
    segment = round(averages.segment_s * shortest.sample_rate_hz)
    first = round(averages.lead_in_s * shortest.sample_rate_hz)
    if not 2 <= segment <= shortest.samples - first:
        after = f" after a lead-in of {averages.lead_in_s:g} s" if first else ""
        raise InputError(
            "segment_s",
            f"a segment of {averages.segment_s} s does not fit run {shortest.run}{after}",
            f"write at most {max(shortest.samples - first, 0) / shortest.sample_rate_hz:.4g} s",
        )
    return {r.run: welch_segments(r.samples, segment, averages.window, averages.overlap, first) for r in runs}


def _cuts_at_dwells(where: str, runs: tuple[UsableRun, ...], schedule: DwellSchedule) -> dict[int, Cut]:
    shapes = {(run.samples, run.sample_rate_hz) for run in runs}
    fits = {shape: fit_dwells(where, schedule, *shape) for shape in shapes}
    return {run.run: fits[run.samples, run.sample_rate_hz] for run in runs}


def _cuts_at_hits(
    where: str, runs: tuple[UsableRun, ...], windows: ImpactWindows
) -> tuple[dict[int, Cut], tuple[str, ...]]:
    _check_common(where, "sample rate", "Hz", {r.run: r.sample_rate_hz for r in runs}, "resample them to one rate")
    several = [run.run for run in runs if len(run.references) != 1]
    if several:
        raise InputError(where, f"{several[0]} does not have one force", "a hammer hits one point at a time")
    cuts: dict[int, Cut] = {}
    remarks = []
    for run in runs:
        cut = cut_at_hits(f"{where}, run {run.run}", run.reference_samples[0], run.sample_rate_hz, windows)
        cuts[run.run] = cut
        if cut.doubles:
            remarks.append(f"run {run.run}: {cut.doubles} of {cut.begin.size + cut.doubles} hits left out, hit twice")
    if windows.added_decay_rad_per_s > 0:
        remarks.append(
            f"the exponential window adds {windows.added_decay_rad_per_s:.4g} rad/s to the decay rate of every mode"
        )
    return cuts, tuple(remarks)


def _check_common(where: str, what: str, unit: str, of_run: Mapping[int, float], advice: str) -> None:
    first = next(iter(of_run.values()))
    if all(abs(v - first) <= 1e-9 * abs(first) for v in of_run.values()):
        return
    by_value = sorted(of_run.items(), key=lambda item: item[1])
    lists = [
        f"{value:.10g} {unit} in run {', '.join(str(run) for run, _ in members)}"
        for value, members in groupby(by_value, key=lambda item: item[1])
    ]
    raise InputError(where, f"the runs differ in {what}: {'; '.join(lists)}", f"{advice}; or estimate them separately")
