"""What the end of a record leaves out: the free decay of whatever still rings when it stops.

A record that ends ringing is brought to rest by a taper w(t). With z the answer of one pole λ to the force f,
z' = λ z + f, and both multiplied by w before they are transformed, partial integration gives

    (iω - λ) FT[w z] = FT[w f] + FT[w' z]:

the quotient of the spectra is not the pole's 1/(iω - λ) but that times 1 + FT[w' z]/FT[w f], which is exact for any
force. Where a record is not tapered, w falls at once, and FT[w' z] is what is left of z at the end. The surge of a
spring rings for minutes: at its peaks a campaign of short sweeps misses a tenth of A/F and more, and a fit that does
not know of it takes that for damping.

:mod:`vgvt.reconcile.question.data` keeps the end of every run; :mod:`vgvt.reconcile.prediction.surrogate` adds what is
here to the accelerances of :mod:`vgvt.reconcile.mechanics.response`, and :mod:`vgvt.reconcile.search.stand` takes it
off again to screen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.pole_slopes import RunSlopes, run_slopes
from vgvt.reconcile.mechanics.response import Matrices, Poles, Slopes, loaded_by, poles_of

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Samples of the force a period of the band's top: what is integrated over the whole record is smooth.
_PER_PERIOD = 12.0
# Taps of the filter that thins it, a sample that is kept, and its window: flat to a ten-thousandth within the band.
_TAPS, _FLAT = 20, ("kaiser", 8.0)
# Poles up to this many times the band's top; those above follow the force, and what is left of them is flat.
_ABOVE_BAND = 1.3
# A pole that rings at the end with less than this share of what a typical line holds is left out.
_FADED = 2e-4
# Of that, with which a pole may do so that has no sensors on it.
_HARDLY = 0.5
# Of a pole, to take the slope of its answer.
_STEP = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Ending:
    """The end of one run's record: its force ``past`` (N,) until the taper starts, latest first, every ``step_s``.

    ``last`` (samples,) is the force under the taper as it was, every ``sample_s``, after ``begun`` samples. At the
    lines ``frequency_hz`` (L,) ``turned`` (2, L) are its transforms with half a period of the taper added and taken
    off, and ``whole`` (L,) is FT[w f], N s, times counting from the taper's start.
    """

    past: Array
    step_s: float
    begun: int
    last: Array
    sample_s: float
    frequency_hz: Array
    turned: ComplexArray
    whole: ComplexArray

    @classmethod
    def of(cls, force: Array, rate_hz: float, tapered: int, frequency_hz: Array, spectrum: ComplexArray) -> Ending:
        """Of a force (N,) whose last ``tapered`` samples, or none, a half cosine brings to rest, and its DFT (L,)."""
        begun, step = force.size - tapered, 1 / rate_hz
        # Samples are in the middle of their time, and the taper starts at the end of one: an odd number keeps that so.
        thinned = max(1, (int(rate_hz / (_PER_PERIOD * frequency_hz[-1])) - 1) // 2 * 2 + 1)
        smooth = force
        if thinned > 1:
            filtering = scipy.signal.firwin(_TAPS * thinned + 1, 1 / thinned, window=_FLAT)
            smooth = scipy.signal.fftconvolve(force, filtering, mode="same")
        past, last = smooth[begun - (thinned + 1) // 2 :: -thinned], force[begun:]
        t = (np.arange(tapered) + 0.5) * step
        omega = 2 * np.pi * frequency_hz
        turns = _turns(tapered * step) if tapered else ()
        turned = np.array([np.exp(np.outer(1j * (w - omega), t)) @ (step * last) for w in turns])
        whole = spectrum * step * np.exp(1j * omega * (begun - 0.5) * step)
        return cls(past, thinned * step, begun, last, step, frequency_hz, turned, whole)

    @property
    def samples(self) -> int:
        """Length of the record."""
        return self.begun + int(self.last.size)

    def weight(self, time_s: Array) -> Array:
        """The taper w at times of any shape, s, from the first sample on: a half cosine, and nothing afterwards."""
        length = max(self.last.size * self.sample_s, 1e-9 * self.sample_s)
        gone = np.clip((time_s - (self.begun - 0.5) * self.sample_s) / length, 0.0, 1.0)
        return np.asarray(0.5 * (1 + np.cos(np.pi * gone)))

    def under(self, force: Array, spectrum: ComplexArray) -> Ending:
        """The same end for another force (N,) that acts meanwhile, as a share of the tapered first one's DFT (L,)."""
        return Ending.of(force, 1 / self.sample_s, self.last.size, self.frequency_hz, spectrum)

    def ringing(self, poles: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Answers z, N s, of decaying poles (P,), 1/s, to the force since it began: where the taper starts and ends."""
        start = _decayed(self.past, poles, self.step_s)
        if self.last.size == 0:
            return start, start
        return start, np.exp(self.last.size * self.sample_s * poles) * start + _decayed(
            self.last[::-1], poles, self.sample_s
        )

    def share(self, poles: ComplexArray, rung: tuple[ComplexArray, ComplexArray]) -> ComplexArray:
        """FT[w' z] / FT[w f] (P, L) of poles that ring so: a half sine is two turns, and each has a closed form."""
        length = self.last.size * self.sample_s
        omega = 2 * np.pi * self.frequency_hz
        start, end = (z[:, None] for z in rung)
        if length == 0:
            return np.asarray(-end / self.whole)
        out = np.zeros((poles.size, omega.size), dtype=complex)
        for sign, turn, forced in zip((1, -1), _turns(length), self.turned, strict=True):
            reached = end * np.exp(1j * (turn - omega) * length)
            out += sign * (reached - start - forced) / (poles[:, None] + 1j * (turn - omega))
        return np.asarray(out * (0.25j * np.pi / length) / self.whole)

    def heard(self, rung: tuple[ComplexArray, ComplexArray], share: float = 1.0) -> NDArray[np.bool_]:
        """Which of the poles (P,) ring loudly enough to count, or by some ``share`` of that."""
        return np.asarray(np.abs(rung).max(axis=0) > share * _FADED * np.median(np.abs(self.whole)))


def _turns(length_s: float) -> tuple[float, float]:
    """The two circular frequencies, rad/s, whose difference is half a period of a sine over the taper."""
    return np.pi / length_s, -np.pi / length_s


def _decayed(force: Array, poles: ComplexArray, step_s: float) -> ComplexArray:
    """Answers (P,) of poles, 1/s, to a force (N,), latest first, by midpoints of steps.

    Over blocks, then over the blocks: far fewer exponentials than one for every sample and pole.
    """
    size = int(np.sqrt(force.size)) + 1
    blocks = np.zeros((size, size))
    blocks.ravel()[: force.size] = force
    within = _turned(poles, 0.5 * step_s, step_s, size)
    summed = (blocks @ within.view(np.float64)).view(np.complex128)
    return np.asarray(step_s * (_turned(poles, 0.0, size * step_s, size) * summed).sum(axis=0))


def _turned(poles: ComplexArray, begin_s: float, step_s: float, count: int) -> ComplexArray:
    """exp(poles t) (count, P) at equal steps of time: each is the one before times the same, and no exponential."""
    factors = np.tile(np.exp(step_s * poles), (count, 1))
    factors[0] = np.exp(begin_s * poles)
    return np.cumprod(factors, axis=0)


@dataclass(frozen=True, slots=True, eq=False)
class _Rung:
    """The poles (P,) at places ``at`` among all of a loaded structure that ring at a run's end.

    ``share`` (P, L) is what the ``ending`` does to them, FT[w' z] / FT[w f] / (iω - λ).
    """

    ending: Ending
    all: Poles
    at: NDArray[np.intp]
    share: ComplexArray


def left_out(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...],
    endings: tuple[Ending, ...], known: Poles | None = None,
) -> ComplexArray:  # fmt: skip
    """What endings add to accelerances (C, L), :func:`vgvt.reconcile.mechanics.response.accelerances`, run by run.

    ``known`` are the poles of the matrices.
    """
    out = np.zeros((matrices.axis.shape[0], omega.size), dtype=complex)
    poles = poles_of(matrices, omega) if known is None else known
    for rows, rung in _ringing_runs(matrices, omega, runs, masses_kg, endings, poles):
        out[rows] = _added(rung, matrices.drive, matrices.axis[rows], matrices.tilt[rows])
    return out


def added_by(ending: Ending, poles: Poles, drive: Array, axis: Array, tilt: Array, omega: Array) -> ComplexArray:
    """What an ending adds to the accelerances (C, L) of rows ``axis``, ``tilt`` (C, m) by an input ``drive`` (m,).

    ``poles`` are those of the structure with all it carries, for lines ``omega`` (L,), rad/s.
    """
    rung = _rung(poles, omega, ending)
    if rung is None:
        return np.zeros((axis.shape[0], omega.size), dtype=complex)
    return _added(rung, drive, axis, tilt)


def _added(rung: _Rung, drive: Array, axis: Array, tilt: Array) -> ComplexArray:
    pole, vectors = rung.all.poles[rung.at], rung.all.vectors[:, rung.at]
    pushed = (rung.all.left @ drive)[rung.at]
    return np.asarray((((axis @ vectors) * pole**2 + tilt @ vectors) * pushed) @ rung.share)


def accelerance_slopes(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...], slopes: Slopes,
    endings: tuple[Ending, ...] = (), wanted: NDArray[np.bool_] | None = None,
) -> ComplexArray:  # fmt: skip
    """Derivatives (k, C, L) of accelerances, and of what endings add; none: all records end at rest.

    Zeros for rows that are not ``wanted`` (C,), by default all are.
    """
    out = np.zeros((slopes.mass.shape[0], matrices.axis.shape[0], omega.size), dtype=complex)
    for k, run in enumerate(run_slopes(matrices, omega, runs, masses_kg, slopes, wanted)):
        if run is not None:
            found = run.accelerances(omega)
            out[:, run.rows] = _with_ending(found, run, omega, endings[k]) if endings else found
    return out


def left_out_slopes(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...],
    endings: tuple[Ending, ...], slopes: Slopes,
) -> ComplexArray:  # fmt: skip
    """Derivatives (k, C, L) of :func:`left_out`, exact but for poles that fade in or out of it."""
    out = np.zeros((slopes.mass.shape[0], matrices.axis.shape[0], omega.size), dtype=complex)
    for run, ending in zip(run_slopes(matrices, omega, runs, masses_kg, slopes), endings, strict=True):
        if run is not None:
            out[:, run.rows] = _with_ending(out[:, run.rows], run, omega, ending)
    return out


def _with_ending(found: ComplexArray, run: RunSlopes, omega: Array, ending: Ending) -> ComplexArray:
    """Derivatives (k, R, L) of one run's readings with those of what its ending adds.

    What the end does to a pole takes the place of 1/(iω - λ): its residue changes as it does there, and it changes with
    the pole itself.
    """
    rung = _rung(run.poles, omega, ending)
    if rung is None:
        return found
    poles, slope = rung.all.poles[rung.at], _slope(rung)
    pole = poles[:, None]
    shares, functions = [], []
    for part, power in ((run.axis, 2), (run.tilt, 0)):
        steeper = pole**power * slope
        if power:
            steeper = steeper + power * pole ** (power - 1) * rung.share
        shares += [*part.residues(rung.all.poles, rung.at)]
        functions += [pole**power * rung.share, steeper]
    # All of them in one product: it is as long as the lines are many.
    return np.asarray(found + np.concatenate(shares, axis=2) @ np.concatenate(functions))


def _ringing_runs(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...],
    endings: tuple[Ending, ...], bare: Poles,
) -> Iterator[tuple[NDArray[np.intp], _Rung]]:  # fmt: skip
    """Rows of the runs at whose end something rings, and what; ``bare`` are the poles without their masses."""
    poles = _in_reach(bare.poles, omega)
    for rows, mass, ending in zip(runs, masses_kg, endings, strict=True):
        # Sensors hardly change how long something rings: most often nothing does, and that is seen without them.
        if not ending.heard(ending.ringing(poles), _HARDLY).any():
            continue
        rung = _rung(poles_of(loaded_by(matrices, rows, mass), omega) if mass.any() else bare, omega, ending)
        if rung is not None:
            yield rows, rung


def _in_reach(poles: ComplexArray, omega: Array, images: bool = False) -> ComplexArray:
    """Those of some poles that decay, turn as the lines do, and not much faster than the last; or ``images``, too."""
    turning = poles.imag != 0 if images else poles.imag > 0
    return np.asarray(poles[turning & (np.abs(poles.imag) < _ABOVE_BAND * omega[-1]) & (poles.real < 0)])


def _rung(here: Poles, omega: Array, ending: Ending) -> _Rung | None:
    """What rings at a run's end; None where nothing does."""
    poles = here.poles
    # Of a pole's mirror image a smooth taper leaves nothing at the lines, and a fall at once does.
    at = np.flatnonzero(np.isin(poles, _in_reach(poles, omega, images=ending.last.size == 0)))
    rung = ending.ringing(poles[at])
    loud = ending.heard(rung)
    if not loud.any():
        return None
    at = at[loud]
    start, end = rung
    share = ending.share(poles[at], (start[loud], end[loud])) * here.reciprocal[:, at].T
    return _Rung(ending, here, at, share)


def _slope(rung: _Rung) -> ComplexArray:
    """Change (P, L) of each pole's share with the pole."""
    pole, reciprocal = rung.all.poles[rung.at], rung.all.reciprocal[:, rung.at].T
    change = _STEP * np.abs(pole)
    there = rung.ending.share(pole + change, rung.ending.ringing(pole + change))
    return np.asarray((there * reciprocal / (1 - change[:, None] * reciprocal) - rung.share) / change[:, None])
