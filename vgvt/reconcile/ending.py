"""What the end of a record leaves out: the free decay of whatever still rings when it stops.

A record that ends ringing is brought to rest by a taper w(t). With z the answer of one pole λ to the force f,
z' = λ z + f, and both multiplied by w before they are transformed, partial integration gives

    (iω - λ) FT[w z] = FT[w f] + FT[w' z]:

the quotient of the spectra is not the pole's 1/(iω - λ) but that times 1 + FT[w' z]/FT[w f], which is exact for any
force. The surge of a spring rings for minutes: at its peaks a campaign of short sweeps misses a tenth of A/F and more,
and a fit that does not know of it takes that for damping.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from vgvt.reconcile.response import Matrices, Poles, Slopes, poles_of

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Samples of the force a period of the band's top: what is integrated below is smooth.
_PER_PERIOD = 6.0
# Poles up to this many times the band's top; those above follow the force, and what is left of them is flat.
_ABOVE_BAND = 1.3
# A pole that rings at the end with less than this share of what a typical line holds is left out.
_FADED = 1e-4
# Of a pole, to take the slope of its answer.
_STEP = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Ending:
    """The end of one run's record: its ``force`` (N,), N, at ``rate_hz``, not tapered, and where the taper starts.

    ``taper`` (L, samples from ``start``) turns an answer over the tapered end into FT[w' z]/FT[w f] at every line;
    ``typical_n_s`` is the median size of FT[w f] there.
    """

    force: Array
    rate_hz: float
    start: int
    taper: ComplexArray
    typical_n_s: float

    @classmethod
    def of(cls, force: Array, rate_hz: float, tapered: int, frequency_hz: Array, spectrum: ComplexArray) -> Ending:
        """Of a force (N,) whose last ``tapered`` samples a half cosine brings to rest; ``spectrum`` (L,) is its DFT."""
        thinned = max(1, int(rate_hz / (_PER_PERIOD * frequency_hz[-1])))
        few = force if thinned == 1 else scipy.signal.resample_poly(force, 1, thinned)
        rate = rate_hz / thinned
        begun = force.size - tapered
        start = -(-begun // thinned)
        t = np.arange(start, few.size) / rate
        falling = -0.5 * np.pi * rate_hz / tapered * np.sin(np.pi * (t * rate_hz - begun + 0.5) / tapered)
        turning = np.exp(-2j * np.pi * frequency_hz[:, None] * t)
        whole = spectrum / rate_hz
        taper = turning * (falling / rate) / whole[:, None]
        return cls(np.asarray(few, dtype=np.float64), rate, start, taper, float(np.median(np.abs(whole))))

    def ringing(self, poles: ComplexArray) -> ComplexArray:
        """Answers z (poles, samples from ``start``), N s, of decaying poles (P,), 1/s, to the force since it began."""
        step = 1 / self.rate_hz
        past = self.force[self.start :: -1]
        # Sums over blocks, then over the blocks: far fewer exponentials than one for every sample and pole.
        size = int(np.sqrt(past.size)) + 1
        blocks = np.zeros((size, size))
        blocks.ravel()[: past.size] = past
        within = blocks @ np.exp(np.outer(np.arange(size), poles * step))
        begun = step * (np.exp(np.outer(np.arange(size) * size, poles * step)) * within).sum(axis=0)
        last = self.force[self.start :]
        factors = np.exp(poles * step)
        rows = [
            np.concatenate([[z], scipy.signal.lfilter([step], [1.0, -a], last[1:] + 0j, zi=[a * z])[0]])
            for z, a in zip(begun, factors, strict=True)
        ]
        # The trapezium's rule: of the newest sample only half has acted.
        return np.asarray(np.array(rows).reshape(poles.size, last.size) - 0.5 * step * last)


@dataclass(frozen=True, slots=True, eq=False)
class _Rung:
    """The poles (P,) at places ``at`` among all of a loaded structure that ring at a run's end.

    ``share`` (P, L) is what the end does to them, FT[w' z] / FT[w f] / (iω - λ), and ``slope`` its change with λ.
    """

    all: Poles
    at: NDArray[np.intp]
    share: ComplexArray
    slope: ComplexArray


def left_out(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...],
    endings: tuple[Ending | None, ...],
) -> ComplexArray:  # fmt: skip
    """What endings add to the accelerances (C, L) of :func:`vgvt.reconcile.response.accelerances`, run by run."""
    out = np.zeros((matrices.axis.shape[0], omega.size), dtype=complex)
    for rows, mass, ending in zip(runs, masses_kg, endings, strict=True):
        rung = None if ending is None else _rung(_loaded(matrices, rows, mass), omega, ending)
        if rung is None:
            continue
        here, pole = rung.all, rung.all.poles[rung.at]
        pushed = (here.left @ matrices.drive)[rung.at]
        axis, tilt = matrices.axis[rows] @ here.vectors[:, rung.at], matrices.tilt[rows] @ here.vectors[:, rung.at]
        out[rows] = ((axis * pole**2 + tilt) * pushed) @ rung.share
    return out


def left_out_slopes(
    matrices: Matrices, omega: Array, runs: tuple[NDArray[np.intp], ...], masses_kg: tuple[Array, ...],
    endings: tuple[Ending | None, ...], slopes: Slopes,
) -> ComplexArray:  # fmt: skip
    """Derivatives (k, C, L) of :func:`left_out`, exact but for poles that fade in or out of it.

    A function of the system's matrix changes by the changes of its poles, and by those of their vectors: the latter
    mix with every other pole's, the more the nearer it is.
    """
    out = np.zeros((slopes.mass.shape[0], matrices.axis.shape[0], omega.size), dtype=complex)
    for rows, mass, ending in zip(runs, masses_kg, endings, strict=True):
        rung = None if ending is None else _rung(_loaded(matrices, rows, mass), omega, ending)
        if rung is None:
            continue
        here, at = rung.all, rung.at
        poles, vectors, left = here.poles, here.vectors, here.left
        axis = matrices.axis[rows]
        heavier = np.einsum("kr,ra,rb->kab", slopes.masses_kg[:, rows], axis, axis)
        turned = slopes.axis[:, rows]
        heavier += np.einsum("r,kra,rb->kab", mass, turned, axis) + np.einsum("r,ra,krb->kab", mass, axis, turned)
        changes = (slopes.stiffness, slopes.damping, slopes.mass + heavier)
        onto = _elements(changes, left[at], vectors, poles)
        off = _elements(changes, left, vectors[:, at], poles[at])
        apart = poles[at][:, None] - poles[None]
        apart[np.arange(at.size), at] = np.inf
        pushed = left @ matrices.drive
        # The velocity that a push of 1 N s leaves, which is the less, the heavier what it pushes.
        given = vectors @ (poles * pushed)
        pushes = (slopes.drive - changes[2] @ given) @ left[at].T + np.einsum("kpj,j->kp", onto / apart, pushed)
        moved = np.einsum("kpp->kp", onto[:, :, at])
        for read, changed, power in ((matrices.axis, slopes.axis, 2), (matrices.tilt, slopes.tilt, 0)):
            seen, pole = read[rows] @ vectors, poles[at][:, None]
            function, steeper = pole**power * rung.share, pole**power * rung.slope
            if power:
                steeper = steeper + power * pole ** (power - 1) * rung.share
            sights = changed[:, rows] @ vectors[:, at] + np.einsum("cj,kjp->kcp", seen, off / apart.T)
            residues = sights * pushed[at] + seen[:, at] * pushes[:, None, :]
            out[:, rows] += residues @ function + (seen[:, at] * pushed[at] * moved[:, None, :]) @ steeper
    return out


def _elements(changes: tuple[Array, ...], left: ComplexArray, vectors: ComplexArray, poles: ComplexArray) -> ComplexArray:
    """Elements (k, a, b) of the system's changes between vectors left (a, m) and right (m, b), the latter of ``poles``.

    ``changes`` are those of stiffness, damping and mass, (k, m, m) each.
    """
    return np.asarray(-sum((left @ change @ vectors) * poles**n for n, change in enumerate(changes)))


def _loaded(matrices: Matrices, rows: NDArray[np.intp], mass: Array) -> Matrices:
    """The structure with the point masses (rows,) of a run."""
    axis = matrices.axis[rows]
    return replace(matrices, mass=matrices.mass + (axis.T * mass) @ axis) if mass.any() else matrices


def _rung(loaded: Matrices, omega: Array, ending: Ending) -> _Rung | None:
    """What rings at a run's end; None where nothing does."""
    here = poles_of(loaded, omega)
    poles = here.poles
    at = np.flatnonzero((poles.imag > 0) & (poles.imag < _ABOVE_BAND * omega[-1]) & (poles.real < 0))
    answer = ending.ringing(poles[at])
    loud = np.abs(answer).max(axis=1, initial=0.0) > _FADED * ending.typical_n_s
    at, answer = at[loud], answer[loud]
    if at.size == 0:
        return None
    pole = poles[at][:, None]
    change = _STEP * np.abs(pole)
    faster = (ending.ringing((pole + change)[:, 0]) - answer) / change
    both = np.concatenate([answer, faster, answer.conj(), faster.conj()]) @ ending.taper.T
    share, slope, mirrored, against = np.split(both, 4)
    # A pole and its mirror image: at positive frequencies the latter is far away, and no more forgotten than others.
    reciprocal, image = 1 / (1j * omega - pole), 1 / (1j * omega - pole.conj())
    return _Rung(
        here,
        np.concatenate([at, _images(poles, at)]),
        np.concatenate([share * reciprocal, mirrored * image]),
        np.concatenate([(slope + share * reciprocal) * reciprocal, (against + mirrored * image) * image]),
    )


def _images(poles: ComplexArray, at: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where the complex conjugates of some poles are."""
    return np.asarray([int(np.argmin(np.abs(poles - poles[k].conj()))) for k in at], dtype=np.intp)
