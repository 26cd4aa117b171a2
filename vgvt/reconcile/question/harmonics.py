"""Harmonics in the responses that the harmonics of the force do not explain: a structure that is not linear.

A sweep is at each frequency once; what a response holds at 2f while the force is at f is a harmonic of the force passed
on by a linear structure, or one that the structure made. Taking the linear answer off leaves the second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.question.variance import local_rational_rest

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_ORDERS = (2.0, 3.0)
# Where no mechanism makes harmonics: what is seen there is noise, and what the linear answer misses.
_BETWEEN = (1.5, 2.5)
_PIECE_S = 1.0
_SWEEP = 30.0
_FEWEST = 6
# The mean of an exponential variable over its median.
_MEAN_PER_MEDIAN = 1 / np.log(2.0)
_TIMES_BETWEEN, _TIMES_NOISE = 2.0, 4.0
# Between multiples a linear answer misses up to some six times the noise of a real aircraft's records, twice that of
# simulated ones; where a joint slips, has play or stiffens a lot, hundreds and thousands of times.
_JAGGED = 30.0


@dataclass(frozen=True, slots=True)
class Harmonic:
    """Power of one order along a sweep, over the noise at the same frequencies at other times (1 is noise).

    ``between`` is the same of orders that nothing makes; ``run_number`` counts as the campaign does.
    """

    run_number: int
    order: int
    power: float
    between: float

    @property
    def unexplained(self) -> bool:
        """Whether it stands clear of noise and of what the linear answer misses anyway."""
        return self.power > _TIMES_NOISE and self.power > _TIMES_BETWEEN * self.between


def harmonics(
    responses: ComplexArray, force: ComplexArray, samples: int, rate_hz: float, band_hz: tuple[float, float], run: int
) -> tuple[Harmonic, ...]:
    """Orders 2 and 3 in what no linear answer explains of a run's responses; nothing where the force is no sweep.

    ``responses`` (C, K) and ``force`` (K,) are whole-record spectra of ``samples`` samples; ``band_hz`` is the band
    that the force sweeps, in which harmonics are looked for.
    """
    frequency = np.arange(force.size) * rate_hz / samples
    inside = np.flatnonzero((frequency >= band_hz[0]) & (frequency <= band_hz[1]))
    length = max(16, round(_PIECE_S * rate_hz))
    if inside.size < 64 or samples < 6 * length:
        return ()
    power, at_hz = _over_time(_banded(force[None], inside, samples), length, rate_hz)
    loudest, usual = power[0].max(axis=0), np.median(power[0], axis=0)
    known = (at_hz >= band_hz[0]) & (at_hz <= band_hz[1])
    if not known.any() or np.median(loudest[known] / usual[known]) < _SWEEP:
        return ()
    when = power[0].argmax(axis=0)
    rest = np.zeros_like(responses)
    rest[:, inside] = local_rational_rest(responses, force, inside)
    left, _ = _over_time(_banded(rest, inside, samples), length, rate_hz)
    noise = np.maximum(np.median(left, axis=1, keepdims=True) * _MEAN_PER_MEDIAN, 1e-300)
    relative = left / noise
    found = {order: _along(relative, when, at_hz, order, band_hz) for order in (*_ORDERS, *_BETWEEN)}
    between = [v for order in _BETWEEN if (v := found[order]) is not None]
    if not between:
        return ()
    return tuple(Harmonic(run, int(o), v, max(between)) for o in _ORDERS if (v := found[o]) is not None)


def answers_jaggedly(found: tuple[Harmonic, ...]) -> bool:
    """Whether some run holds much between multiples of its sweep that no linear answer to its force explains.

    A joint that slips throws what it makes all over the band: beside it no multiple stands out. Harmonics alone are no
    such thing: a joint that makes these is like a linear one, and is begun beside that.
    """
    return any(h.between > _JAGGED for h in found)


def words_of(found: tuple[Harmonic, ...]) -> str | None:
    """One sentence about all unexplained harmonics, or None."""
    seen = [h for h in found if h.unexplained]
    if not seen:
        return None
    orders = " and ".join(sorted({{2: "second", 3: "third"}[h.order] for h in seen}))
    runs = len({h.run_number for h in seen})
    return (
        f"Responses hold {orders} harmonics that those of the force do not explain, in {runs} of "
        f"{len({h.run_number for h in found})} runs (up to {max(h.power for h in seen):.0f} times the noise): "
        "something, structure or sensors, is not linear"
    )


def _banded(spectra: ComplexArray, inside: NDArray[np.intp], samples: int) -> Array:
    """Records (C, samples) of some lines of spectra (C, K)."""
    kept = np.zeros_like(spectra)
    kept[:, inside] = spectra[:, inside]
    return np.asarray(np.fft.irfft(kept, samples, axis=1))


def _over_time(records: Array, length: int, rate_hz: float) -> tuple[Array, Array]:
    """Power (C, times, frequencies) of half-overlapping pieces of records (C, N), and the frequencies."""
    starts = np.arange(0, records.shape[1] - length + 1, length // 2)
    pieces = records[:, starts[:, None] + np.arange(length)] * np.hanning(length)
    power = np.abs(np.fft.rfft(pieces, axis=2)) ** 2
    return np.asarray(power, dtype=np.float64), np.asarray(np.fft.rfftfreq(length, 1 / rate_hz), dtype=np.float64)


def _along(
    relative: Array, when: NDArray[np.intp], at_hz: Array, order: float, band_hz: tuple[float, float]
) -> float | None:
    """Mean of (C, times, frequencies) where and when a multiple of the force's frequency sounds; None for too few."""
    # A line's width from the ends of the band, where the sweep itself starts and stops.
    edge = 2 * (at_hz[1] - at_hz[0])
    heard = np.flatnonzero((at_hz >= order * (band_hz[0] + edge)) & (at_hz <= band_hz[1] - edge))
    if heard.size < _FEWEST:
        return None
    source = [int(np.abs(at_hz - at_hz[k] / order).argmin()) for k in heard]
    return float(np.mean(relative[:, when[source], heard]))
