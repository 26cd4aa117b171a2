"""The second laboratory with nonlinear root joints: the same finite elements, stepped in time.

Shares no code with the simulator or with the loop. The linear part, with each joint's own stiffness, is taken apart
into poles that are stepped without error for forces that are straight within a step (Nigam and Jennings, Bull.
Seismol. Soc. Am. 59, 1969); what a joint does beyond that stiffness is found at the end of every step,
for dry friction as what stops the joint there, as far as it can (time stepping after Moreau: Acary and Brogliato,
Numerical Methods for Nonsmooth Dynamical Systems, 2008, chapter 10).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from finite_element import Array
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.signal import fftconvolve, firwin
from second_laboratory import (
    GRAVITY,
    ComplexArray,
    Rig,
    both_sides,
    channels,
    geometry,
    hung,
    passed,
    rig_of,
)

from vgvt.data import Campaign, Record
from vgvt.scenario.model import Scenario

# What lies above the records' own Nyquist frequency is taken off by a filter without phase this long at either end.
FILTER_S, CUT_HZ = 0.25, 100.0
SWEEPS = 40
# Radians a step that a pole may turn.
FOLLOWED = 1.0


@dataclass(frozen=True)
class Cubic:
    """Beyond the stiffness: k3 θ³."""

    held: ClassVar[bool] = False
    rate_hz: ClassVar[float] = 8000.0
    cubic_n_m_per_rad3: float

    def rest(self, load_n_m: float, stiffness: float) -> float:
        """Angle at which the joint carries a load."""
        if load_n_m == 0:
            return 0.0
        bound = load_n_m / stiffness
        return float(brentq(lambda a: stiffness * a + self.cubic_n_m_per_rad3 * a**3 - load_n_m, 0.0, bound))

    def torque(self, free: float, rest: float, flexibility: float) -> float:
        """Torque beyond the stiffness and beyond rest's at the end of a step that ends at ``free`` without it."""
        k3, angle = self.cubic_n_m_per_rad3, free
        for _ in range(30):
            torque = k3 * ((rest + angle) ** 3 - rest**3)
            slope = 1 + flexibility * 3 * k3 * (rest + angle) ** 2
            step = (angle + flexibility * torque - free) / slope
            angle -= step
            if abs(step) < 1e-15:
                break
        return k3 * ((rest + angle) ** 3 - rest**3)


@dataclass(frozen=True)
class Play:
    """No torque within a gap from stop to stop, the stiffness beyond it."""

    held: ClassVar[bool] = False
    rate_hz: ClassVar[float] = 8000.0
    gap_rad: float
    stiffness: float

    def rest(self, load_n_m: float, stiffness: float) -> float:
        """Angle at which the joint carries a load: against a stop."""
        return load_n_m / stiffness + float(np.sign(load_n_m)) * self.gap_rad / 2

    def torque(self, free: float, rest: float, flexibility: float) -> float:
        """Torque beyond the stiffness and beyond rest's: what the play takes away; one line, three pieces."""
        half, k = self.gap_rad / 2, self.stiffness
        still = min(max(rest, -half), half)
        # Against the upper stop, the lower one, or between them, where the torque takes all of the stiffness away.
        for stop in (half, -half):
            torque = -k * (stop - still)
            if stop * (rest + free - flexibility * torque) >= half * half:
                return torque
        angle = (free - flexibility * k * (still - rest)) / (1 - flexibility * k)
        return -k * (rest + angle - still)


@dataclass(frozen=True)
class Friction:
    """Dry friction beside the stiffness: up to M against the motion; the joint sticks where less will do."""

    held: ClassVar[bool] = True
    rate_hz: ClassVar[float] = 32000.0
    friction_n_m: float

    def rest(self, load_n_m: float, stiffness: float) -> float:
        """Angle at which the joint carries a load; nothing is left in the friction."""
        return load_n_m / stiffness

    def torque(self, free: float, rest: float, flexibility: float) -> float:
        """Friction through a step at whose end the joint would turn at the rate ``free`` without it."""
        del rest
        return min(max(free / flexibility, -self.friction_n_m), self.friction_n_m)


Law = Cubic | Play | Friction


@dataclass(frozen=True, eq=False)
class Poles:
    """A linear rig as poles p (P,) with Im p ≥ 0: z' = p z + B u; coordinates and rates are Re(C z)."""

    pole: ComplexArray
    into: ComplexArray
    """What each input does to each pole, (P, inputs)."""
    out: ComplexArray
    """Coordinates and their rates, (2 N, P), conjugates counted."""

    def some(self, keep: NDArray[np.bool_]) -> Poles:
        """Those of the poles that are to be kept."""
        return Poles(self.pole[keep], self.into[keep], self.out[:, keep])

    @property
    def still(self) -> Array:
        """Coordinates (N, inputs) under inputs that rest."""
        half = self.out.shape[0] // 2
        return np.asarray(-((self.out[:half] / self.pole) @ self.into).real)


def poles_of(mass: Array, damping: Array, stiffness: Array, inputs: Array) -> Poles:
    """The poles of M q'' + C q' + K q = inputs (N, inputs) u."""
    n = mass.shape[0]
    flow = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    system = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), flow])
    pole, right = np.linalg.eig(system)
    entry = np.linalg.solve(right, np.vstack([np.zeros_like(inputs), np.linalg.solve(mass, inputs)]))
    upper = pole.imag >= 0
    twice = np.where(pole[upper].imag > 0, 2.0, 1.0)
    return Poles(pole[upper], entry[upper], right[:, upper] * twice)


def stepped(poles: Poles, force: Array, select: Array, law: Law, rest: Array) -> tuple[Poles, ComplexArray, Array]:
    """The poles that move, their states (P, samples) and torques (J, samples) under a force (samples,), from rest.

    Steps are as fine as the law asks; inputs are the force and then the joints' torques with the opposite sign;
    ``select`` (J, N) picks the joints. Poles that are faster than steps can follow give way as they would at rest: what
    sticks is else held at the ends of steps alone, and rings between.
    """
    step = 1 / law.rate_hz
    fast = np.abs(poles.pole) * step > FOLLOWED
    soft = select @ poles.some(fast).still
    slow = poles.some(~fast)
    x = slow.pole * step
    whole = np.exp(x)
    # Integrals over a step of a force that is 1 at its beginning, or at its end, and straight between.
    later = (whole - 1 - x) / (x * x) * step
    earlier = (whole - 1) / x * step - later
    begun, ended = slow.into * earlier[:, None], slow.into * later[:, None]
    count, size = select.shape
    joints, again, driven = select @ slow.out[:size], 0 * soft[:, 1:], soft[:, 0]
    if law.held:
        # Rates, and those at which what follows at once gives way: from one torque to the next.
        joints, again, driven = select @ slow.out[size:], soft[:, 1:] / step, driven / step
    flexible = (joints @ ended[:, 1:]).real + (again if law.held else soft[:, 1:])
    state = np.zeros((slow.pole.size, force.size), dtype=complex)
    torque = np.zeros((count, force.size))
    u = np.zeros(1 + count)
    z = np.zeros(slow.pole.size, dtype=complex)
    for k in range(1, force.size):
        z = whole * z + begun @ u + ended[:, 0] * force[k]
        t = torque[:, k - 1].copy()
        free = (joints @ z).real + again @ t + driven * (force[k] - (force[k - 1] if law.held else 0.0))
        for _ in range(SWEEPS):
            old = t.copy()
            for j in range(count):
                others = free[j] - flexible[j] @ t + flexible[j, j] * t[j]
                t[j] = law.torque(others, rest[j], flexible[j, j])
            if np.abs(t - old).max() <= 1e-10 * (1e-6 + np.abs(t).max()):
                break
        z = z - ended[:, 1:] @ t
        u = np.concatenate([[force[k]], -t])
        state[:, k], torque[:, k] = z, t
    return slow, state, torque


def jointed(scenario: Scenario, stiffness: float) -> Scenario:
    """The scenario with a root that bends on either side of the body's first beam."""
    airframe = both_sides(scenario.airframe)
    key = {"root_bending_stiffness_n_m_per_rad": stiffness}
    beams = tuple(b.model_copy(update=key) if b.parent == "body" else b for b in airframe.beam)
    return scenario.model_copy(update={"airframe": airframe.model_copy(update={"beam": beams})})


def jointed_campaign(scenario: Scenario, law: Law, stiffness: float, amplitudes_n: tuple[float, ...]) -> Campaign:
    """The noiseless records of every run, in SI, the roots with a law; the force's amplitude run by run."""
    there, rate = jointed(scenario, stiffness), scenario.acquisition.sample_rate_hz
    records = []
    for run, amplitude in enumerate(amplitudes_n):
        rig = rig_of(there, run)
        force, motion = recorded(rig, law, amplitude)
        records.append(Record(run + 1, rate, channels(scenario, rig.labels), np.vstack([force, motion])))
    return Campaign("jointed", geometry(scenario), tuple(records), scenario.excitation.band_hz)


def recorded(rig: Rig, law: Law, amplitude_n: float) -> tuple[Array, Array]:
    """What the gauge (samples,) and the sensors (S, samples) record of one sweep."""
    mass, damping, stiffness = hung(rig)
    loads, joints = -GRAVITY * mass[2], joint_coordinates(rig)
    select = np.eye(mass.shape[0])[joints]
    rest = np.array([law.rest(float(loads[j]), k) for j, k in zip(joints, stiffness[joints, joints], strict=True)])
    poles = poles_of(mass, damping, stiffness, np.column_stack([rig.push, select.T]))
    force = sweep(rig.scenario, amplitude_n, law.rate_hz)
    slow, state, torque = stepped(poles, force, select, law, rest)
    seen = np.array([rig.seat(node) for node in rig.seats])
    inputs = np.vstack([force, -torque])
    rates = seen @ slow.out[mass.shape[0] :]
    acceleration = ((rates * slow.pole) @ state).real + (rates @ slow.into).real @ inputs
    corners = rig.scenario.transducer.high_pass_hz, rig.scenario.accelerometers.high_pass_hz
    gauge = at_rate(rig.scenario, force[None], law.rate_hz, corners[0])[0]
    return gauge, at_rate(rig.scenario, acceleration, law.rate_hz, corners[1])


def joint_coordinates(rig: Rig) -> NDArray[np.intp]:
    """Which coordinates are the angles of roots that bend."""
    names = [b.name for b in rig.scenario.airframe.beam if b.root_bending_stiffness_n_m_per_rad is not None]
    nears = [rig.model.chains[name][0].near for name in names]
    return np.array([int(np.flatnonzero(near[3:, 6:].any(axis=0))[-1]) + 6 for near in nears])


def sweep(scenario: Scenario, amplitude_n: float, rate_hz: float) -> Array:
    """The laboratory's force at the rate of the steps, and on beyond the record as far as the filter reaches."""
    e = scenario.excitation
    time = np.arange(round((e.record_s + FILTER_S) * rate_hz) + 1) / rate_hz - e.lead_in_s
    rise = (e.stop_hz - e.start_hz) / e.duration_s
    ends = np.clip(np.minimum(time, e.duration_s - time) / 0.5, 0, 1)
    phase = 2 * np.pi * (e.start_hz + rise / 2 * time) * time
    return np.asarray(amplitude_n * np.sin(np.pi / 2 * ends) ** 2 * np.sin(phase))


def at_rate(scenario: Scenario, signals: Array, rate_hz: float, corner_hz: float) -> Array:
    """Signals (S, steps) behind AC coupling and an anti-alias filter at the record's samples, (S, samples)."""
    rate = scenario.acquisition.sample_rate_hz
    size = 2 * signals.shape[1]
    omega = 2 * np.pi * np.fft.rfftfreq(size, 1 / rate_hz)
    coupled = np.fft.irfft(np.fft.rfft(signals, size, axis=1) * passed(corner_hz, omega), size, axis=1)
    taps = firwin(2 * round(FILTER_S * rate_hz) + 1, CUT_HZ, fs=rate_hz)
    smooth = fftconvolve(coupled[:, : signals.shape[1]], taps[None], mode="same", axes=1)
    count = round(scenario.excitation.record_s * rate) + 1
    return np.asarray(smooth[:, :: round(rate_hz / rate)][:, :count])
