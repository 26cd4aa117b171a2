"""Synthetic campaigns with a known answer: a flat plate under a roving test, by modal superposition.

They are independent of the simulator on purpose: the conformance checks must
not lean on the code that identifiers are kept away from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, ModalModel, Quantity, Record

DRIVE_NODE = 99
_DRIVE_AT_M = (0.35, 0.55)
_FINER = 16  # steps from sample to sample in which responses are computed


@dataclass(frozen=True, slots=True)
class Example:
    """A plate of span 3 m and chord 0.5 m, its modes, a chirp and white sensor noise.

    ``frequency_hz`` and ``damping_ratio`` name the modes in order; the shapes
    are free-beam-like along the span and rigid along the chord (``plate_shapes``).
    Noise is given as the standard deviation of a sample, in SI; the force
    channel gets ``force_noise_n``.
    """

    frequency_hz: tuple[float, ...] = (6.3, 13.7, 26.9)
    damping_ratio: tuple[float, ...] = (0.012, 0.009, 0.007)
    modal_mass_kg: float = 1.0
    stations: int = 4
    sample_rate_hz: float = 256.0
    duration_s: float = 24.0
    sweep_s: float = 20.0
    band_hz: tuple[float, float] = (3.0, 40.0)
    force_n: float = 2.0
    noise_m_s2: float = 0.0
    force_noise_n: float = 0.0
    seed: int = 0

    @property
    def nodes(self) -> tuple[int, ...]:
        """Two rows of ``stations`` nodes, numbered in pairs: forward and aft at each station."""
        return tuple(range(1, 2 * self.stations + 1))

    @property
    def dofs(self) -> tuple[Dof, ...]:
        """The response DOFs, all +Z."""
        return tuple(Dof(n, Direction.PLUS_Z) for n in self.nodes)

    def positions_m(self) -> NDArray[np.float64]:
        """Positions (nodes + drive, 3); the drive point is last."""
        span = np.linspace(-1.4, 1.45, self.stations)  # not symmetric, so that no sensor sits on a node line
        rows = [(x, y, 0.0) for y in span for x in (0.05, 0.45)]
        return np.array([*rows, (*_DRIVE_AT_M, 0.0)])

    def modes(self) -> ModalModel:
        """The exact answer at the response DOFs."""
        shapes = self._shapes()[:, :-1]
        return ModalModel(
            natural_frequency_hz=np.array(self.frequency_hz),
            damping_ratio=np.array(self.damping_ratio),
            shapes=shapes.astype(complex),
            dofs=self.dofs,
            modal_mass_kg=np.full(len(self.frequency_hz), self.modal_mass_kg),
            method="example",
        )

    def campaign(self) -> Campaign:
        """The campaign: one run per station, the two sensors of that station and the force."""
        positions = self.positions_m()
        force = self._force()
        response = self._accelerations(force)
        runs = tuple(self._run(station, force, response) for station in range(self.stations))
        geometry = Geometry((*self.nodes, DRIVE_NODE), positions)
        return Campaign("example plate", geometry, runs, self.band_hz)

    def ambient_campaign(self, duration_s: float = 160.0) -> Campaign:
        """An output-only campaign: one run of all sensors at once, under steady white forces that nobody measured.

        Two independent forces act: at the drive node and, half as large, at the first sensor.
        """
        samples = round(duration_s * self.sample_rate_hz)
        generator = np.random.default_rng([self.seed, 1001])
        response = sum(
            level * self._accelerations(self.force_n * generator.standard_normal(samples), gains)
            for level, gains in ((1.0, self._gains()), (0.5, self._gains(0)))
        )
        noise = self.noise_m_s2 * generator.standard_normal((len(self.dofs), samples))
        channels = tuple(Channel(f"a{d.node}", Quantity.ACCELERATION, ChannelRole.RESPONSE, d) for d in self.dofs)
        geometry = Geometry((*self.nodes, DRIVE_NODE), self.positions_m())
        record = Record(1, self.sample_rate_hz, channels, np.asarray(response + noise))
        return Campaign("example plate, ambient", geometry, (record,), self.band_hz)

    def accelerance(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Exact accelerance (responses, frequency), (m/s^2)/N."""
        s = 2j * np.pi * frequency_hz
        poles, gain = self.modes().poles, self._gains()
        receptance = gain.T @ (1 / (s - poles[:, None])) + gain.conj().T @ (1 / (s - poles.conj()[:, None]))
        return np.asarray(s**2 * receptance)

    def _shapes(self) -> NDArray[np.float64]:
        return plate_shapes(self.positions_m(), len(self.frequency_hz))

    def _gains(self, driven: int = -1) -> NDArray[np.complex128]:
        """Receptance residues (modes, responses) of real normal modes for a force at point ``driven``, the last one."""
        shapes = self._shapes()
        damped = self.modes().poles.imag
        return np.asarray(shapes[:, :-1] * shapes[:, driven, None] / (2j * damped[:, None] * self.modal_mass_kg))

    def _force(self) -> NDArray[np.float64]:
        time = np.arange(round(self.duration_s * self.sample_rate_hz)) / self.sample_rate_hz
        low, high = self.band_hz
        start = max(low - 1.0, 0.2)
        rate = (high + 1.0 - start) / self.sweep_s
        phase = 2 * np.pi * (start * time + rate * time**2 / 2)
        return np.asarray(self.force_n * np.sin(phase) * (time <= self.sweep_s))

    def _accelerations(
        self, force: NDArray[np.float64], gains: NDArray[np.complex128] | None = None
    ) -> NDArray[np.float64]:
        """Response (responses, samples) from rest to a force that its samples state whole: none beyond half their rate.

        Straight lines from sample to sample would have sinc^2 of its spectrum.
        """
        from scipy.signal import lfilter

        step = 1 / (_FINER * self.sample_rate_hz)
        between = _between(force)
        out = np.zeros((len(self.dofs), force.size))
        for pole, gain in zip(self.modes().poles, self._gains() if gains is None else gains, strict=True):
            z = pole * step
            first = np.expm1(z) / z
            second = (np.expm1(z) - z) / z**2
            state = lfilter([step * second, step * (first - second)], [1, -np.exp(z)], between)
            state = state - step * second * between[0] * np.exp(z * np.arange(between.size))  # starts from rest
            state = state[::_FINER]
            out += 2 * (np.outer(gain * pole**2, state) + np.outer(gain * pole, force)).real
        return out

    def _run(self, station: int, force: NDArray[np.float64], response: NDArray[np.float64]) -> Record:
        rows = [2 * station, 2 * station + 1]
        generator = np.random.default_rng([self.seed, station])
        clean = np.vstack([force, response[rows]])
        scale = np.array([self.force_noise_n, self.noise_m_s2, self.noise_m_s2])
        samples = clean + scale[:, None] * generator.standard_normal(clean.shape)
        channels = (
            Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof(DRIVE_NODE, Direction.PLUS_Z)),
            *(Channel(f"a{d.node}", Quantity.ACCELERATION, ChannelRole.RESPONSE, d) for d in self._pair(rows)),
        )
        return Record(station + 1, self.sample_rate_hz, channels, samples)

    def _pair(self, rows: list[int]) -> tuple[Dof, ...]:
        return tuple(self.dofs[r] for r in rows)


def _between(force: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ends of straight lines, finer than the samples of a force (N,), that have its spectrum to a few millionths.

    Lines between points of a curve are off it by a twelfth of the second difference on average, and moved by that.
    """
    from scipy.fft import next_fast_len
    from scipy.signal import resample

    length = next_fast_len(2 * force.size, real=True)
    finer = resample(np.pad(force, (0, length - force.size)), _FINER * length)
    ends = np.concatenate([finer[-1:], finer[: _FINER * force.size + 1]])
    return np.asarray(ends[1:-1] - np.diff(ends, 2) / 12)


def plate_shapes(positions_m: NDArray[np.float64], modes: int) -> NDArray[np.float64]:
    """Plate-like shapes (modes, points): spanwise bending of growing order, every third one torsion-like.

    Smooth functions of position that are linearly independent; they need not
    solve a plate equation, only be real and differ from one another.
    """
    x, y = positions_m[:, 0] / 0.5, positions_m[:, 1] / 1.5
    shapes = []
    for mode in range(modes):
        order, kind = divmod(mode, 3)
        spanwise = np.cos((order + 1) * np.pi * y - (np.pi / 2 if kind == 1 else 0.0)) - 0.25 * (kind == 0)
        twist = (x - 0.4) * np.sin((order + 0.5) * np.pi * y) * 2.0
        shapes.append(twist + 0.15 if kind == 2 else spanwise + 0.1 * (x - 0.5))
    return np.array(shapes)
