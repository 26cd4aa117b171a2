"""Hammer records: segments that start at the hits, a force window, an exponential window and its damping.

Force and responses of a segment are multiplied by the same exp(-t/τ), the force after its own
window has silenced everything but the hit. For a structure at rest before the hit this changes
every pole λ to λ - 1/τ and nothing else, exactly: `without_window_damping` takes it back.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, PoleCandidate, Quantity

NOTE = "impacts"
# A hit stands out of the record by this much, and a second one of a double hit out of the first.
_TRIGGER_LEVEL = 0.2
_DOUBLE_LEVEL = 0.1
# Of s, in which a window moves the frequency response of a motion measured beside that of the poles.
_POWERS = {Quantity.ACCELERATION: 2, Quantity.VELOCITY: 1, Quantity.DISPLACEMENT: 0}

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ImpactWindows:
    """How hammer records are cut: a segment begins ``pre_trigger_s`` before its hit.

    The force window lets ``force_s`` from there through, with a cosine fall; ``decay_s`` is τ of the
    exponential window, infinite for none. With ``reject_double_hits`` a segment that was hit twice
    is left out as long as one good one remains in the run.
    """

    segment_s: float
    pre_trigger_s: float = 0.02
    force_s: float = 0.1
    decay_s: float = np.inf
    reject_double_hits: bool = True

    @property
    def added_decay_rad_per_s(self) -> float:
        """What the exponential window adds to the decay rate ζω of every mode."""
        return 1.0 / self.decay_s

    def note(self) -> str:
        """The windows as a campaign's notes carry them, under the key 'impacts'."""
        return json.dumps({k: v for k, v in asdict(self).items() if v != np.inf})


def impact_windows(campaign: Campaign) -> ImpactWindows | None:
    """The windows that a campaign's notes propose, None without any; InputError for a note that cannot be read."""
    if NOTE not in campaign.notes:
        return None
    try:
        return ImpactWindows(**json.loads(campaign.notes[NOTE]))
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{campaign.name}, note {NOTE!r}", str(error), f"write it like {ImpactWindows(4.0).note()}"
        ) from error


@dataclass(frozen=True, slots=True, eq=False)
class ImpactSegments:
    """A run cut at its hits: ``begin`` (segments,) first samples, windows (length,) of force and response.

    ``quiet`` samples at the start hold nothing yet; ``doubles`` counts the segments that were left out because
    the hammer bounced.
    """

    begin: NDArray[np.intp]
    force_window: Array
    response_window: Array
    quiet: int
    doubles: int

    def frequency_hz(self, sample_rate_hz: float) -> Array:
        """Frequency of every line, 0 to Nyquist."""
        length = self.force_window.size
        return np.asarray(np.arange(length // 2 + 1) * (sample_rate_hz / length), dtype=np.float64)

    def effective_averages(self) -> float:
        """Every hit is an average of its own."""
        return float(self.begin.size)

    def spectra(self, samples: NDArray[np.floating], *, force: bool = False) -> NDArray[np.complex128]:
        """Spectra (segments, lines) of one channel (N,): a force less its mean before each hit, a response its own."""
        window = self.force_window if force else self.response_window
        values = np.asarray(samples, dtype=np.float64)
        pieces = values[self.begin[:, None] + np.arange(window.size)]
        if not force:
            # Before a hit a response may still ring from the last one: its offset is the mean of the whole record.
            pieces = pieces - values.mean()
        elif self.quiet:
            # The offset of a force gauge, let through by the force window, would be a second, long hit. It is read
            # well before the trigger, which the hit's own rise precedes.
            pieces = pieces - pieces[:, : self.quiet].mean(axis=1, keepdims=True)
        return np.asarray(np.fft.rfft(pieces * window, axis=1))


def cut_at_hits(where: str, force: NDArray[np.floating], rate_hz: float, windows: ImpactWindows) -> ImpactSegments:
    """The segments of a run from its force (N,).

    A hit is where the force's size passes a fifth of the record's largest; the next may come a segment
    later. InputError where no whole segment is left.
    """
    length, before = round(windows.segment_s * rate_hz), round(windows.pre_trigger_s * rate_hz)
    strength = np.abs(np.asarray(force, dtype=float) - np.median(force))
    begin: list[int] = []
    for hit in np.flatnonzero(strength > _TRIGGER_LEVEL * strength.max()):
        first = int(hit) - before
        if first >= 0 and first + length <= strength.size and (not begin or first >= begin[-1] + length):
            begin.append(first)
    if not begin:
        raise InputError(
            where,
            f"no hit with {windows.pre_trigger_s:g} s before it and {windows.segment_s:g} s in all",
            "shorten the segment or the time before the trigger",
        )
    double = [_hit_twice(strength[first : first + length]) for first in begin]
    good = [first for first, twice in zip(begin, double, strict=True) if not twice]
    kept = good if windows.reject_double_hits and good else begin
    time = (np.arange(length) - before) / rate_hz
    # One exponential from the start of the segment on: a hit begins before it triggers, and a bend in the window there
    # would be a force that the responses do not know of.
    decay = np.exp(-time / windows.decay_s) if np.isfinite(windows.decay_s) else np.ones(length)
    passed = time + before / rate_hz - windows.force_s
    fall = max(0.25 * windows.force_s, 1.0 / rate_hz)
    gate = np.where(passed <= 0, 1.0, np.where(passed < fall, 0.5 + 0.5 * np.cos(np.pi * passed / fall), 0.0))
    return ImpactSegments(np.array(kept), gate * decay, decay, before // 2, len(begin) - len(kept))


def without_window_damping(
    modes: ModalModel, added_decay_rad_per_s: float, measured: Quantity = Quantity.ACCELERATION
) -> ModalModel:
    """The modes as they are without the exponential window that they were found through: poles μ + 1/τ.

    A mode that the window damped less than that, which noise can make, keeps a damping ratio of zero.
    Close modes may change their order; the candidates change with them. ``measured`` is what the sensors
    gave, which the residues depend on. InputError for what is no motion.

    Through the window an accelerance s² H is known along s + 1/τ. A method that takes it for s² H finds at
    μ = λ - 1/τ the residue R λ²/μ² instead of the receptance's R: this is taken back, and so is R λ/μ of
    velocities. Modal masses follow as those of modes whose shapes are real without the window. Standard deviations
    stay those of the pole itself, in rad/s: a damping ratio of a tenth of what was seen is ten times less well known.
    """
    if measured not in _POWERS:
        known = ", ".join(q.name.lower() for q in _POWERS)
        raise InputError("without_window_damping", f"{measured.name.lower()} is no motion", f"give one of {known}")
    true = _without(modes.poles, added_decay_rad_per_s)
    order = np.argsort(np.abs(true), kind="stable")
    # Without frequencies, as a model keeps its modes in the order of these.
    again = replace(modes, natural_frequency_hz=np.zeros(len(modes))).select(order)
    seen, true = modes.poles[order], true[order]
    change = np.divide(seen, true, out=np.ones_like(true), where=true != 0) ** _POWERS[measured]
    mass, residues = again.modal_mass_kg, again.residues
    std_hz, ratio_std = _std_without(seen, true, again.natural_frequency_std_hz, again.damping_ratio_std)
    return replace(
        again,
        natural_frequency_hz=np.abs(true) / (2 * np.pi),
        damping_ratio=_damping_ratio(true),
        natural_frequency_std_hz=std_hz,
        damping_ratio_std=ratio_std,
        residues=None if residues is None else residues * change[:, None, None],
        modal_mass_kg=None if mass is None else np.where(change.real > 0, mass / change.real, np.nan),
        candidates=tuple(_candidate_without(c, added_decay_rad_per_s) for c in modes.candidates),
    )


def _without(poles: NDArray[np.complex128], added_decay_rad_per_s: float) -> NDArray[np.complex128]:
    return np.asarray(np.minimum(poles.real + added_decay_rad_per_s, 0.0) + 1j * poles.imag)


def _damping_ratio(poles: NDArray[np.complex128]) -> Array:
    size = np.abs(poles)
    return np.asarray(np.divide(-poles.real, size, out=np.zeros_like(size), where=size > 0))


def _std_without(
    seen: NDArray[np.complex128], true: NDArray[np.complex128], std_hz: Array | None, ratio_std: Array | None
) -> tuple[Array | None, Array | None]:
    """Standard deviations (M,) of frequency and damping ratio at poles ``true`` (M,) from those at ``seen`` (M,).

    They are those of the pole along its own direction and across it, which turns; unchanged where one is not known.
    """
    if std_hz is None or ratio_std is None:
        return std_hz, ratio_std
    root = np.sqrt(np.maximum(1 - np.array([_damping_ratio(seen), _damping_ratio(true)]) ** 2, 0.0))
    known = np.isfinite(std_hz) & np.isfinite(ratio_std) & (root > 0).all(axis=0) & (true != 0)
    along, before, after = 2 * np.pi * std_hz[known], root[0, known], root[1, known]
    across = ratio_std[known] / before * np.abs(seen[known])
    angle = np.angle(true[known] / seen[known])
    turned_hz, turned_ratio = std_hz.copy(), ratio_std.copy()
    turned_hz[known] = np.hypot(np.cos(angle) * along, np.sin(angle) * across) / (2 * np.pi)
    turned = np.hypot(np.sin(angle) * along, np.cos(angle) * across)
    turned_ratio[known] = turned * after / np.abs(true[known])
    return turned_hz, turned_ratio


def _candidate_without(candidate: PoleCandidate, added_decay_rad_per_s: float) -> PoleCandidate:
    ratio = candidate.damping_ratio
    seen = 2 * np.pi * candidate.frequency_hz * (-ratio + 1j * np.sqrt(max(1 - ratio**2, 0.0)))
    true = _without(np.array([seen]), added_decay_rad_per_s)
    return replace(
        candidate, frequency_hz=float(np.abs(true[0])) / (2 * np.pi), damping_ratio=float(_damping_ratio(true)[0])
    )


def _hit_twice(strength: Array) -> bool:
    """Whether the force (length,) of a segment rises again after it has fallen from its first hit."""
    high = strength > _DOUBLE_LEVEL * strength.max()
    return int(np.count_nonzero(np.diff(high.astype(int)) == 1)) + int(high[0]) > 1
