"""Steady vibration of a linear system with a few nonlinear springs, by harmonic balance: an oracle without time steps.

The linear part is condensed on the nonlinear coordinates; forces alternate between
frequency and time (Cameron and Griffin, J. Appl. Mech. 56, 1989). Knows nothing of
the simulator: it is given a state-space model and force laws.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Force = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Vibrator:
    """x' = A x + B u + E f(y, y'), y = S x, z = C x + D u + P f: u the command, f (J,) what the laws add.

    ``state`` (n, n), ``command`` (n,), ``entry`` (n, J), ``select`` (J, n), ``output`` (outputs, n),
    ``feedthrough`` (outputs,), ``passed`` (outputs, J).
    """

    state: Array
    command: Array
    entry: Array
    select: Array
    output: Array
    feedthrough: Array
    passed: Array


@dataclass(frozen=True, eq=False)
class Balance:
    """Fourier coefficients of y (J, harmonics + 1) and of the outputs z (outputs, harmonics + 1) per cos(k ω t)."""

    motion: Complex
    outputs: Complex


def balance(
    system: Vibrator, force: Force, omega: float, volts: float, harmonics: int, guess: Complex | None = None
) -> Balance:
    """The periodic answer to volts · cos(ω t), with harmonics 0 to ``harmonics``; RuntimeError where none is found."""
    size, joints = system.state.shape[0], system.select.shape[0]
    drive = np.zeros(harmonics + 1, dtype=complex)
    drive[1] = volts
    # A coil in series with a damper holds no static force: a frequency near 0 in its place is never singular.
    s = 1j * omega * np.maximum(np.arange(harmonics + 1), 1e-5)
    inverse = np.linalg.inv(s[:, None, None] * np.eye(size) - system.state)
    receptance = system.select @ inverse @ system.entry
    free = np.einsum("jn,hnm,m,h->jh", system.select, inverse, system.command, drive)
    scale = max(float(np.abs(free).max()), 1e-12)

    def laws(motion: Complex) -> Complex:
        return _alternated(force, motion, omega)

    def residual(unknown: Array) -> Array:
        motion = _complex(unknown, joints) * scale
        return _real((motion - free - np.einsum("hij,jh->ih", receptance, laws(motion))) / scale)

    start = free if guess is None else guess
    found = scipy.optimize.root(residual, _real(start / scale), method="lm", options={"xtol": 1e-12, "ftol": 1e-14})
    if np.abs(residual(found.x)).max() > 1e-6:
        raise RuntimeError(f"no balance at {omega / (2 * np.pi):.3f} Hz: {found.message}")
    motion = _complex(found.x, joints) * scale
    pushed = laws(motion)
    states = np.einsum("hnm,mh->nh", inverse, system.entry @ pushed + system.command[:, None] * drive)
    return Balance(motion, system.output @ states + system.feedthrough[:, None] * drive + system.passed @ pushed)


def _alternated(force: Force, motion: Complex, omega: float) -> Complex:
    """Fourier coefficients (J, H + 1) of the forces of a periodic motion (J, H + 1)."""
    count = motion.shape[1]
    samples = 256 * count
    spectrum = np.zeros((motion.shape[0], samples // 2 + 1), dtype=complex)
    spectrum[:, :count] = motion * samples / 2
    spectrum[:, 0] = motion[:, 0].real * samples
    rate = spectrum * 1j * omega * np.arange(samples // 2 + 1)
    value = force(np.fft.irfft(spectrum, samples, axis=1), np.fft.irfft(rate, samples, axis=1))
    back = np.fft.rfft(value, axis=1)[:, :count] * 2 / samples
    back[:, 0] /= 2
    return np.asarray(back)


def _real(motion: Complex) -> Array:
    return np.concatenate([motion[:, 0].real, motion[:, 1:].real.ravel(), motion[:, 1:].imag.ravel()])


def _complex(unknown: Array, joints: int) -> Complex:
    means, rest = unknown[:joints], unknown[joints:].reshape(2, joints, -1)
    return np.concatenate([means[:, None] + 0j, rest[0] + 1j * rest[1]], axis=1)


def resonance(
    system: Vibrator,
    force: Force,
    volts: float,
    band_hz: tuple[float, float],
    harmonics: int,
    ratio: tuple[int, int],
    points: int = 25,
) -> tuple[float, Balance]:
    """Frequency, Hz, in a band where output ratio[0] is in quadrature with ratio[1] and largest, and the balance there.

    Follows the solution up the band, so that of several branches it is the one from below.
    """
    guess, found = None, []
    lines = np.linspace(*band_hz, points)
    for hz in lines:
        solution = balance(system, force, 2 * np.pi * hz, volts, harmonics, guess)
        guess = solution.motion
        found.append((_quotient(solution, ratio), guess))
    values = np.array([value for value, _ in found])
    turns = np.flatnonzero(np.diff(np.sign(values.real)) != 0)
    k = max(turns, key=lambda i: abs(values[i]) + abs(values[i + 1]))
    start = found[k][1]
    hz = scipy.optimize.brentq(
        lambda x: _quotient(balance(system, force, 2 * np.pi * x, volts, harmonics, start), ratio).real,
        lines[k],
        lines[k + 1],
        xtol=1e-6,
    )
    return float(hz), balance(system, force, 2 * np.pi * hz, volts, harmonics, start)


def _quotient(solution: Balance, ratio: tuple[int, int]) -> complex:
    return complex(solution.outputs[ratio[0], 1] / solution.outputs[ratio[1], 1])
