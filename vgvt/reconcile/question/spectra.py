"""Spectra of whole records: of every run on the lines of the longest, and of each on its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.signals.usable import UsableRun

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_TAPER_S = 1.5
_AT_REST = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """The force (N,) of a record as it was, and how many of its last samples are tapered."""

    force: Array
    tapered: int


@dataclass(frozen=True, slots=True, eq=False)
class OwnSpectra:
    """One run's force (K,) and responses (C_r, K) on the lines of its own record of so many ``samples``.

    A shorter record that is padded to the longest has lines between its own, where noise is interpolated: what asks
    whether neighbouring lines belong together takes such noise for an answer of the structure.
    """

    samples: int
    force: ComplexArray
    responses: ComplexArray

    def nearest(self, lines: NDArray[np.intp], samples: int) -> NDArray[np.intp]:
        """Its lines (L,) next to those of a record of ``samples`` samples; the mean is none."""
        found = np.rint(lines * (self.samples / samples)).astype(np.intp)
        return np.asarray(np.clip(found, 1, self.force.size - 1), dtype=np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class Spectra:
    """Spectra on common lines: force (R, K), response (all channels in order, K), what the taper touches (R, K).

    ``pushed`` (R, N) is the force that they are of, along the positive axis; ``ends`` are those of the
    records, ``own`` their own lines. ``largest`` is the farthest that any response's record is from its mean.
    """

    force: ComplexArray
    response: ComplexArray
    touched: ComplexArray
    pushed: Array
    ends: tuple[End, ...]
    own: tuple[OwnSpectra, ...]
    largest: float

    @property
    def samples(self) -> int:
        """Length of the longest record."""
        return int(self.pushed.shape[1])


def spectra_of(
    runs: tuple[UsableRun, ...], rate: float, tapers_s: Sequence[float] | None = None
) -> tuple[Spectra, tuple[str, ...]]:
    """Spectra of runs of one sample rate, Hz, padded to the longest; and remarks on those that end ringing.

    Tapered are those that do, or by so many seconds a run as somebody else's were who is to be compared with.
    Forces are those along the positive axis, whichever way round their gauge was read.
    """
    samples = max(run.samples for run in runs)
    touched = np.zeros((len(runs), samples // 2 + 1), dtype=complex)
    pushed = np.zeros((len(runs), samples))
    common: list[ComplexArray] = []
    own: list[OwnSpectra] = []
    remarks: list[str] = []
    ends: list[End] = []
    largest = 0.0
    for r, run in enumerate(runs):
        signals = np.array([run.reference_samples[0], *run.response_samples], dtype=float)
        # All that comes of the force does so here: A/F, levels, and what marches and endings are pushed with.
        signals[0] *= _sign_of_force(run)
        signals -= signals.mean(axis=1, keepdims=True)
        pushed[r, : run.samples] = signals[0]
        largest = max(largest, float(np.abs(signals[1:]).max(initial=0.0)))
        window = _window(signals, rate) if tapers_s is None else _taper(signals.shape[1], round(tapers_s[r] * rate))
        ends.append(End(signals[0], 0 if window is None else int((window < 1).sum())))
        if window is not None:
            said = f"its last {_TAPER_S:g} s are tapered, which predictions know"
            remarks.append(f"run {run.run}: the record ends ringing; {said}")
            touched[r] = np.fft.rfft(signals[0] * window * (1 - window), samples)
            signals = signals * window
        common.append(np.fft.rfft(signals, samples, axis=1))
        alone = common[-1] if run.samples == samples else np.fft.rfft(signals, axis=1)
        own.append(OwnSpectra(run.samples, alone[0], alone[1:]))
    force, response = np.array([c[0] for c in common]), np.concatenate([c[1:] for c in common])
    return Spectra(force, response, touched, pushed, tuple(ends), tuple(own), largest), tuple(remarks)


def _sign_of_force(run: UsableRun) -> int:
    """-1 where the gauge was read against the positive axis: ``100-Z`` holds the force along ``100+Z`` negated."""
    dof = run.references[0].dof
    assert dof is not None, "Channel refuses references without a DOF"
    return dof.direction.sign


def _window(signals: Array, rate: float) -> Array | None:
    """A taper of the end where the record does not end at rest, else None."""
    tail = signals[:, -max(2, round(0.25 * rate)) :]
    # Ringing fills few of the tail's frequencies; what fills half of them is noise, and rests as it ever does.
    power = np.abs(np.fft.rfft(tail * np.hanning(tail.shape[1]), axis=1)) ** 2
    excess = np.clip(1 - 2 * np.median(power, axis=1) / power.mean(axis=1), 0, None)
    ringing = np.sqrt(excess * (tail**2).mean(axis=1)) > _AT_REST * np.sqrt((signals**2).mean(axis=1))
    if not ringing.any():
        return None
    return _taper(signals.shape[1], min(round(_TAPER_S * rate), signals.shape[1] // 4))


def _taper(samples: int, count: int) -> Array | None:
    """Half a cosine over the last ``count`` samples; None where there are none."""
    if count == 0:
        return None
    window = np.ones(samples)
    window[-count:] = 0.5 * (1 + np.cos(np.pi * (np.arange(count) + 0.5) / count))
    return window
