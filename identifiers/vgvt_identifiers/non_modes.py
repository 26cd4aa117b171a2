"""Lines that are no modes: orders of the drive, tones at a fixed frequency, and what is found where nothing answers.

Any method wires it in with one line at the end of its ``identify``::

    return flag_non_modes(campaign, model)

Modes keep their place in the claim; a doubtful one gets the flag ``doubtful_order=3``,
``doubtful_fixed_line=50.00`` or ``doubtful_no_coherence``, and the advice says why.

A sweep is at one frequency at a time, so when power arrives at a claimed frequency tells where it comes
from: of a mode when the drive passes it and for as long as it rings down; of the order k when the drive is at
1/k of it; of a fixed tone all the time, above all before the drive has come near. Without a sweep only
tones are judged: a tone keeps its phase through the record, a mode, however lightly damped, does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, ModalModel, Record
from vgvt.signals.order import DriveTrack, track_drive
from vgvt.signals.usable import fault_of
from vgvt_identifiers.deaf_bands import deaf_bands_of

ORDERS = (2, 3, 4, 5)
_CHANNELS = 4
_NARROW_LINES = 6.0
_LEAST_EXCESS = 0.3
_LEAST_EARLY = 0.3
_LEAST_TONALITY = 0.8
_LEAST_TONALITY_EARLY = 0.7
_FEWEST_WINDOWS = 6
_LEAST_OF_PASS = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class _Watched:
    """One run at one frequency: power of responses and force in windows of time, and when the drive was where."""

    time_s: NDArray[np.float64]
    window_s: float
    response: NDArray[np.float64]
    force: NDArray[np.float64]
    passes: dict[int, float | None]
    lines: NDArray[np.complex128]


def flag_non_modes(campaign: Campaign, claim: ModalModel) -> ModalModel:
    """The claim with a flag on every mode that is rather an order of the drive or a fixed tone, and advice why."""
    if not len(claim):
        return claim
    deaf = deaf_bands_of(campaign, campaign.band_hz)
    tracks = {record.run: _track(record) for record in campaign.runs}
    flags = [list(f) for f in claim.flags] if claim.flags else [[] for _ in range(len(claim))]
    advice: list[str] = []
    for mode in range(len(claim)):
        at_hz = float(claim.natural_frequency_hz[mode])
        found = _unheard(at_hz, deaf) or _verdict(campaign, claim, mode, tracks)
        if found is not None:
            flags[mode].append(found[0])
            advice.append(found[1])
    if not advice:
        return claim
    return replace(claim, flags=tuple(map(tuple, flags)), advice=(*claim.advice, *advice))


def _unheard(at_hz: float, deaf: tuple[tuple[float, float], ...]) -> tuple[str, str] | None:
    for low, high in deaf:
        if low <= at_hz <= high:
            why = (
                f"{at_hz:.3f} Hz is doubtful: from {low:.3g} to {high:.3g} Hz the coherence with the force is under 0.5"
            )
            return "doubtful_no_coherence", why
    return None


def _verdict(
    campaign: Campaign, claim: ModalModel, mode: int, tracks: dict[int, DriveTrack | None]
) -> tuple[str, str] | None:
    at_hz, damping = float(claim.natural_frequency_hz[mode]), float(claim.damping_ratio[mode])
    narrow = 2 * damping * at_hz * max(r.duration_s for r in campaign.runs) < _NARROW_LINES
    suspects = [k for k in ORDERS if _near_a_mode(claim, at_hz / k)]
    if not narrow and not suspects:
        return None
    watched = [w for r in campaign.runs if (w := _watch(r, tracks[r.run], at_hz)) is not None]
    if not watched:
        return None
    if narrow and _is_fixed(watched, 2 * np.pi * at_hz * damping):
        tone = "the power line" if _is_mains(at_hz) else "a fixed tone"
        why = f"{at_hz:.3f} Hz is there all the time, also while the drive is elsewhere: {tone}, not a mode"
        return f"doubtful_fixed_line={at_hz:.2f}", why
    for order in suspects:
        if _is_order(watched, order):
            why = f"{at_hz:.3f} Hz comes when the drive is at {at_hz / order:.3f} Hz: its order {order}, not a mode"
            return f"doubtful_order={order}", why
    return None


def _is_mains(at_hz: float) -> bool:
    """Within 0.5 % of 50 or 60 Hz, half of what EN 50160 allows, or of their second and third harmonics."""
    return any(abs(at_hz / (n * line) - 1) < 0.005 for n in (1, 2, 3) for line in (50.0, 60.0))


def _near_a_mode(claim: ModalModel, at_hz: float) -> bool:
    """An order is only seen as a line of its own where the drive meets a resonance."""
    return bool(np.any(np.abs(claim.natural_frequency_hz / at_hz - 1) < 0.03))


def _track(record: Record) -> DriveTrack | None:
    for role in (ChannelRole.DRIVE, ChannelRole.REFERENCE):
        channels, samples = record.select(role)
        if len(channels) == 1:
            return track_drive(samples[0], record.sample_rate_hz)
    return None


def _watch(record: Record, track: DriveTrack | None, at_hz: float) -> _Watched | None:
    """Power over time at one frequency, of the strongest response channels and of the force."""
    _, responses = record.select(ChannelRole.RESPONSE)
    _, forces = record.select(ChannelRole.REFERENCE)
    sound = [x for x in responses if fault_of(x, record.sample_rate_hz) is None]
    if not sound:
        return None
    window_s = _window_s(record, track, at_hz)
    turned = np.exp(-2j * np.pi * at_hz * record.time_s)
    lines = np.array([_amplitudes(x, turned, window_s * record.sample_rate_hz) for x in sound])
    strongest = np.argsort(-(np.abs(lines) ** 2).sum(axis=1))[:_CHANNELS]
    lines = lines[strongest]
    force = [_amplitudes(x, turned, window_s * record.sample_rate_hz) for x in forces]
    passes = {} if track is None else {k: track.passes(at_hz / k, record.sample_rate_hz) for k in (1, *ORDERS)}
    return _Watched(
        time_s=(np.arange(lines.shape[1]) / 2 + 0.5) * window_s,
        window_s=window_s,
        response=(np.abs(lines) ** 2).sum(axis=0),
        force=(np.abs(np.array(force)) ** 2).sum(axis=0) if force else np.zeros(lines.shape[1]),
        passes=passes,
        lines=lines,
    )


def _window_s(record: Record, track: DriveTrack | None, at_hz: float) -> float:
    """Windows as long as a sweep needs to cross their own resolution, else a tenth of the record."""
    least = max(6 / at_hz, record.duration_s / 400)
    if track is None:
        return max(least, record.duration_s / 10)
    inside = np.flatnonzero(track.alive)
    swept = float(np.ptp(track.frequency_hz[inside])) * record.sample_rate_hz / max(inside.size, 1)
    return float(min(max(least, 1.5 / np.sqrt(max(swept, 1e-3))), record.duration_s / 8))


def _amplitudes(samples: NDArray[np.floating], turned: NDArray[np.complex128], window: float) -> NDArray[np.complex128]:
    """Complex amplitude in Hann windows that overlap by half, (J,)."""
    half = max(int(window / 2), 4)
    count = samples.size // half
    shape = np.hanning(2 * half + 1)[:-1] / half
    product = (np.asarray(samples, dtype=np.float64) - float(np.mean(samples))) * turned
    pieces = product[: count * half].reshape(count, half)
    return np.asarray(pieces[:-1] @ shape[:half] + pieces[1:] @ shape[half:])


def _tonality(lines: NDArray[np.complex128]) -> float:
    """How well one constant tone near the frequency explains amplitudes over time (C, J), 0 to 1."""
    total = float((np.abs(lines) ** 2).sum()) * lines.shape[1]
    spectrum = np.abs(np.fft.fft(lines, 8 * lines.shape[1], axis=1)) ** 2
    return float(spectrum.sum(axis=0).max() / max(total, 1e-300))


def _is_fixed(watched: list[_Watched], decay_per_s: float) -> bool:
    """Whether the power is there before the drive comes, or without a sweep, holds its phase longer than a mode can."""
    early = [e for w in watched if (e := _early(w)) is not None]
    if early:
        tonality, share = np.median(np.array(early), axis=0)
        return bool(tonality > _LEAST_TONALITY_EARLY and share > _LEAST_EARLY)
    # A drive that is never elsewhere, such as a dwell, leaves no time at which a tone could be told from it.
    lasts = decay_per_s * max(float(np.ptp(w.time_s)) for w in watched) < 1
    return lasts and all(_tonality(w.lines) > _LEAST_TONALITY and not w.passes for w in watched)


def _early(watched: _Watched) -> tuple[float, float] | None:
    """Tonality before the drive comes, and power then over that after it has gone; None: too little time before."""
    first = watched.passes.get(1)
    if first is None:
        return None
    before = watched.time_s < first - 2 * watched.window_s
    if before.sum() < _FEWEST_WINDOWS:
        return None
    after = watched.time_s > first + 3 * watched.window_s
    enough = after.sum() >= _FEWEST_WINDOWS
    # At the end of a sweep the pass itself must do: a tone that matters over a record is no small part of it.
    level = float(np.median(watched.response[after]) if enough else _LEAST_OF_PASS * watched.response.max())
    return _tonality(watched.lines[:, before]), float(np.median(watched.response[before])) / max(level, 1e-300)


def _is_order(watched: list[_Watched], order: int) -> bool:
    """Whether more power comes with the order than the force at that time explains, against the drive's own pass."""
    excess, plain = 0.0, 0.0
    for w in watched:
        first, later = w.passes.get(1), w.passes.get(order)
        if first is None or later is None:
            continue
        own, own_force = _peak(w, w.response, first), _peak(w, w.force, first)
        multiple, multiple_force = _peak(w, w.response, later), _peak(w, w.force, later)
        excess += multiple - own * multiple_force / max(own_force, 1e-300)
        plain += own
    return excess > _LEAST_EXCESS * plain > 0


def _peak(watched: _Watched, power: NDArray[np.float64], at_s: float) -> float:
    near = np.abs(watched.time_s - at_s) <= 2 * watched.window_s
    return float(power[near].max()) if near.any() else 0.0
