"""One run's record marched: what its nonlinear joints show at the lines, and what they leave ringing at its end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.ending import Ending, added_by
from vgvt.reconcile.mechanics.joints import Joints
from vgvt.reconcile.mechanics.law import Law
from vgvt.reconcile.mechanics.march import Memory, marched
from vgvt.reconcile.mechanics.response import Matrices, Poles, poles_of

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Steps a period of the band's top, of a law without corners and of one with them: a joint that sticks is stopped at the
# ends of steps, and one with play meets its stops there, and no sooner. And how many times as many of one with both:
# beside friction what play takes away is constant within a step.
_STEPS_PER_PERIOD, _STEPS_OF_CORNERS, _WITH_BOTH = 16.0, 64.0, 4.0
# How far above the band the measured force is heard.
_HEARD_BANDS = 3.0
# What no joint's reaction is times that of a linear one, and a motion, rad or m, below which nobody asks.
_RUN_AWAY, _STILL_RAD = 1e6, 1e-9
# Damping ratio that every pole above the band has at least.
_LEAST_RATIO = 0.01
# Share of a pole's ringing after twice the record that nobody sees at its beginning; what grows by as much as that
# shrinks within one has no answer.
_GONE = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Push:
    """Measured force ``samples`` (N,) of a run as it was, N, and the ``lines`` (L,) of the record that are looked at.

    A record shorter than the campaign's longest has zeros behind it, up to that length. ``ending`` is how the record
    itself ends, before them; None where it is taken for one that ends at rest.
    """

    samples: Array
    rate_hz: float
    lines: NDArray[np.intp]
    top_hz: float
    ending: Ending | None = None

    @property
    def omega(self) -> Array:
        """The lines (L,), rad/s."""
        return np.asarray(2 * np.pi * self.lines * (self.rate_hz / self.samples.size))

    def weight(self, time_s: Array) -> Array:
        """What the record is multiplied by at times of any shape, from its first sample on, before it is looked at."""
        return np.ones_like(time_s) if self.ending is None else self.ending.weight(time_s)


def marched_run(
    loaded: Matrices, joints: Joints, laws: tuple[Law, ...], push: Push
) -> tuple[ComplexArray, ComplexArray]:
    """Complex stiffness κ (J, L) that joints with ``laws`` show beyond their tangent, and what they leave out (C, L).

    ``loaded`` is the linear structure with the run's sensors. The second is what the record's end adds to the
    accelerances of its rows (C,) because of what the joints have set ringing. Neither a run that nothing drives nor
    one that runs away has an A/F: its joints show no number.
    """
    if not push.samples.any():
        nothing = np.zeros((loaded.axis.shape[0], push.lines.size), dtype=complex)
        return np.full((len(laws), push.lines.size), complex(np.nan, np.nan)), nothing
    count, rate = push.samples.size, push.rate_hz
    duration = count / rate
    rubs, plays = any(law.friction > 0 for law in laws), any(law.play > 0 for law in laws)
    per_period = _STEPS_OF_CORNERS if rubs or plays else _STEPS_PER_PERIOD
    per_period *= _WITH_BOTH if rubs and plays else 1.0
    steps = scipy.fft.next_fast_len(int(np.ceil(duration * per_period * push.top_hz)), real=True)
    # Twice the record: what rings on comes round to its beginning as free decay, which is known.
    top = int(_HEARD_BANDS * push.top_hz * 2 * duration)
    spectrum = scipy.fft.rfft(push.samples, 2 * count)[: min(top, count)]
    poles = poles_of(_calmed(loaded, push.top_hz), 2 * np.pi * np.arange(spectrum.size) / (2 * duration))
    answered = poles.modal(loaded.drive[None])[0] @ (joints.rows @ poles.vectors).T + joints.to_drive
    moved = scipy.fft.irfft(spectrum * answered.T, 2 * steps, axis=1)[:, :steps] * (steps / count)
    time = np.arange(steps) * (duration / steps)
    moved -= _come_round(poles, spectrum / (2 * count), joints.rows, loaded.drive, time)
    reaction = marched(moved[None], _memory(poles, joints, np.pi * steps / duration), [laws], duration / steps)[0]
    size = max(law.stiffness for law in laws) * max(np.abs(moved).max(), _STILL_RAD)
    driven = duration * poles.poles.real.max() > -np.log(_GONE)
    if driven or not np.abs(reaction).max() < _RUN_AWAY * size:
        reaction = np.full_like(reaction, np.nan)
    force = scipy.fft.rfft(reaction * push.weight(time), axis=1)[:, push.lines] * (count / steps)
    if rubs:
        # Forces that are constant in every step, of which a march gives the means at their ends: sin(x)/x for cos(x).
        turned = push.omega * (duration / steps) / 2
        force *= np.tan(turned) / turned
    pushed = scipy.fft.rfft(push.samples * push.weight(np.arange(count) / rate))[push.lines]
    here = replace(poles, reciprocal=1.0 / (1j * push.omega[:, None] - poles.poles))
    linear = here.modal(loaded.drive[None])[0] @ (joints.rows @ here.vectors).T + joints.to_drive
    flexible = flexibility(here, joints.rows, joints.rows, joints.between)
    motion = pushed * linear.T - np.einsum("lij,jl->il", flexible, force)
    # Not finite where a march ran away.
    with np.errstate(invalid="ignore", over="ignore"):
        shown = np.asarray(force / np.where(motion == 0, 1.0, motion))
    if push.ending is None or not np.isfinite(reaction).all():
        return shown, np.zeros((loaded.axis.shape[0], push.lines.size), dtype=complex)
    return shown, _rung_by_joints(loaded, here, joints, _sampled(reaction, count), pushed, push)


def _sampled(reaction: Array, count: int) -> Array:
    """Reactions (J, steps) at the samples (J, count) of the record, without what these cannot tell from slower ones.

    Dry friction jumps: as it is at an instant, it would seem to ring with what is far above the band.
    """
    mirrored = np.concatenate([reaction, reaction[:, ::-1]], axis=1)
    return np.asarray(
        scipy.fft.irfft(scipy.fft.rfft(mirrored, axis=1)[:, : count + 1], 2 * count, axis=1)[:, :count]
        * (count / reaction.shape[1])
    )


def _calmed(loaded: Matrices, top_hz: float) -> Matrices:
    """The structure with some damping at least in whatever its modes above the band do, each by itself or together.

    In time one that is driven swamps everything. What makes up for a chain's cells takes damping off these modes, as a
    finer chain has less there; where a root is soft, more than they have, and a joint that sticks mixes them. Within
    the band that is nothing.
    """
    heavy = (loaded.mass + loaded.mass.T) / 2
    squares, shapes = scipy.linalg.eigh((loaded.stiffness + loaded.stiffness.T) / 2, heavy)
    high = squares > (2 * np.pi * top_hz) ** 2
    # Of modes that are scaled so, the damping is their ratios.
    shapes = shapes[:, high] / np.sqrt(2 * np.sqrt(squares[high]))
    ratios = shapes.T @ loaded.damping @ shapes
    found, turned = np.linalg.eigh((ratios + ratios.T) / 2)
    if not (found < _LEAST_RATIO).any():
        return loaded
    weight = heavy @ (shapes * (2 * np.sqrt(squares[high]))) @ turned
    return replace(loaded, damping=loaded.damping + (weight * np.maximum(_LEAST_RATIO - found, 0.0)) @ weight.T)


def _come_round(poles: Poles, spectrum: ComplexArray, rows: Array, drive: Array, time: Array) -> Array:
    """Motion of rows (J, m) at times (N,), s, by which an answer that repeats is ahead of one that begins at rest.

    ``spectrum`` (L,) are the Fourier coefficients of the force at the lines of the ``poles``, its mean first. Every
    pole begins with what the last period has left of it.
    """
    lasting = np.flatnonzero((poles.poles.imag >= 0) & (2 * time[-1] * poles.poles.real > np.log(_GONE)))
    omega, pole = (1.0 / poles.reciprocal + poles.poles).imag[:, 0], poles.poles[lasting]
    against = np.conj(spectrum[1:, None]) / (-1j * omega[1:, None] - pole)
    begun = spectrum @ poles.reciprocal[:, lasting] + against.sum(axis=0)
    pair = np.where(pole.imag > 0, 2.0, 1.0)
    given = begun * pair * (poles.left @ drive)[lasting]
    # Beyond all numbers where a pole is driven.
    with np.errstate(invalid="ignore", over="ignore"):
        return _decaying((rows @ poles.vectors[:, lasting]) * given, pole, time)


def _decaying(shares: ComplexArray, pole: ComplexArray, time: Array) -> Array:
    """Real parts (J, N) of shares (J, P) of exp(poles t) at equal steps of time (N,), s, the first of them at 0.

    Times are some blocks' beginnings and what has gone of a block: far fewer exponentials than one a pole and step, and
    real numbers times pairs of them are half of a complex product.
    """
    size = int(np.sqrt(time.size)) + 1
    begun, within = np.exp(np.outer(time[::size], pole)), np.exp(np.outer(pole, time[:size]))
    turned = shares[:, None, :] * begun
    both = np.concatenate([turned.real, -turned.imag], axis=2) @ np.concatenate([within.real, within.imag])
    return np.asarray(both.reshape(shares.shape[0], -1)[:, : time.size])


def flexibility(poles: Poles, seen: Array, acting: Array, spare: Array | float) -> ComplexArray:
    """Motion at rows (a, m) for unit forces at rows (b, m), (L, a, b), with static flexibility missed by the modes."""
    answered = poles.modal(acting) @ (seen @ poles.vectors).T
    return np.asarray(answered.transpose(1, 2, 0) + spare)


def _rung_by_joints(
    loaded: Matrices, here: Poles, joints: Joints, reaction: Array, pushed: ComplexArray, push: Push
) -> ComplexArray:
    """What the end leaves out (C, L) of answers to reactions (J, samples of the record) that act against the joints."""
    assert push.ending is not None
    # The record may be padded to the length of a longer one: it ends where it did.
    reaction = reaction[:, : push.ending.samples]
    out = np.zeros((loaded.axis.shape[0], push.lines.size), dtype=complex)
    for row, acting in zip(joints.rows, reaction, strict=True):
        ending = push.ending.under(acting, pushed)
        out -= added_by(ending, here, row, loaded.axis, loaded.tilt, push.omega)
    return out


def _memory(poles: Poles, joints: Joints, limit: float) -> Memory:
    """The joints' answer to their own reactions, modes beyond a limit in rad/s as flexibility that is a little late.

    A joint that sticks is held by those as well: what they damp within the band is not to be left out.
    """
    out, into = joints.rows @ poles.vectors, poles.left @ joints.rows.T
    slow = (np.abs(poles.poles) < limit) & (poles.poles.imag >= 0)
    fast = np.abs(poles.poles) >= limit
    pair = np.where(poles.poles[slow].imag > 0, 2.0, 1.0)
    # At low frequency a / (iω - p) is -a/p - iω a/p².
    still = out[:, fast] / poles.poles[fast]
    at_once, late_s = joints.between - (still @ into[fast]).real, ((still / poles.poles[fast]) @ into[fast]).real
    return Memory(poles.poles[slow], out[:, slow] * pair, into[slow], at_once, late_s)
