"""Poles of one run by subspace identification over orders, with standard deviations from added noise."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ChannelRole, Dof, Record
from vgvt.signals.usable import fault_of
from vgvt_identifiers.fraction_poles import ModePoles
from vgvt_identifiers.input_output_subspace import DecimatedRun, decimated, observability
from vgvt_identifiers.spectra import DIFFERENTIATIONS, RunSpectra
from vgvt_identifiers.stabilisation import Criteria, PolesAtOrder, Stabilisation, stabilise

_MARGIN = 0.02  # of the band, as poles at its edges wander across
_MOST_ROWS = 150  # of the future inputs and outputs together: the cost grows with their cube


@dataclass(frozen=True, slots=True)
class SubspaceOptions:
    """What the models of a run may be; the settings of the method explain each."""

    weighting: str
    block_rows: int
    largest_order: int
    replicates: int
    seed: int
    criteria: Criteria


def stable_poles(run: DecimatedRun, band_hz: tuple[float, float], options: SubspaceOptions) -> Stabilisation:
    """Clusters of the poles of all even orders, in states, in and next to ``band_hz``."""
    rows = _block_rows(run, options)
    largest = min(options.largest_order, run.responses * (rows - 1))
    orders = tuple(range(2, largest + 1, 2))
    table = observability(run, rows, largest, options.weighting).poles(orders)
    margin = _MARGIN * (band_hz[1] - band_hz[0])
    inside = tuple(_inside(t, band_hz[0] - margin, band_hz[1] + margin) for t in table)
    resolution = 0.25 * 2 * np.pi / (run.samples.shape[1] * run.step_s)
    result = stabilise(inside, replace(options.criteria, resolution_rad_s=resolution))
    for cluster in result.modes:
        if not band_hz[0] <= cluster.frequency_hz <= band_hz[1]:
            result = result.without(cluster, f"{cluster.frequency_hz:.4g} Hz: outside the band")
    return result


def deviations(
    run: DecimatedRun,
    noise_power: NDArray[np.float64],
    stable: Stabilisation,
    options: SubspaceOptions,
    spectra: RunSpectra,
) -> ModePoles:
    """Poles of the modes with their standard deviations; ``noise_power`` (R, L) is E|N|^2 of the responses' spectra.

    Noise as large as that of the record is added once more, with draws from ``seed`` for every run and DOF of
    ``spectra``, so that the order of the channels says nothing: how far a pole then moves is how far the
    first noise moved it, as long as that is little. The spread over orders counts too.
    """
    modes = stable.modes
    poles = np.array([c.pole_rad_s for c in modes], dtype=complex)
    spread = np.array([(abs(c.pole_rad_s) * c.damping_spread, 2 * np.pi * c.frequency_spread_hz) for c in modes])
    moved = np.zeros((options.replicates, poles.size, 2))
    orders = [int(stable.orders[c.representative]) for c in modes]
    rows = _block_rows(run, options)
    streams = _Streams.of(options.seed, spectra)
    for replicate in range(options.replicates if poles.size else 0):
        noisy = replace(run, samples=run.samples + _noise(run, noise_power, streams))
        table = observability(noisy, rows, max(orders), options.weighting).poles(tuple(orders))
        for mode, found in enumerate(table):
            moved[replicate, mode] = _move(poles[mode], found.poles_rad_s)
    scatter = np.sqrt((moved**2).mean(axis=0)) if options.replicates else np.zeros((poles.size, 2))
    return ModePoles(poles, np.hypot(scatter, spread.reshape(-1, 2)))


def prepared(record: Record, highest_hz: float) -> DecimatedRun:
    """The sound force and responses of a run, decimated; the same channels as those of its spectra."""
    index = [i for i, c in enumerate(record.channels) if c.role is ChannelRole.REFERENCE and _sound(record, i)]
    index += [
        i
        for i, c in enumerate(record.channels)
        if c.role is ChannelRole.RESPONSE and c.quantity in DIFFERENTIATIONS and _sound(record, i)
    ]
    return decimated(record.samples[index], record.sample_rate_hz, highest_hz)


def noise_power(
    record: Record, run: DecimatedRun, spectra: RunSpectra, frequency_hz: NDArray[np.float64]
) -> NDArray[np.float64]:
    """E|N|^2 (R, L) of the noise in the spectra of the decimated responses, from that of the lines (K,) of the band."""
    lines = np.fft.rfftfreq(run.samples.shape[1], run.step_s)
    channels = [c for i, c in enumerate(record.channels) if c.role is ChannelRole.RESPONSE and _sound(record, i)]
    times = np.array([DIFFERENTIATIONS[c.quantity] for c in channels if c.quantity in DIFFERENTIATIONS])
    power = spectra.variance * np.abs(spectra.force) ** 2 / (2 * np.pi * frequency_hz) ** (2 * times[:, None])
    # A spectrum is a sum over samples: at a lower rate there are fewer.
    fewer = run.step_s * record.sample_rate_hz
    return np.array([np.interp(lines, frequency_hz, row) for row in power]) / fewer**2


def _sound(record: Record, channel: int) -> bool:
    return fault_of(record.samples[channel], record.sample_rate_hz) is None


@dataclass(frozen=True, slots=True)
class _Streams:
    """Random numbers of every response of a run, and the signs of their DOFs, with which noise turns round as well."""

    generators: tuple[np.random.Generator, ...]
    signs: tuple[int, ...]

    @classmethod
    def of(cls, seed: int, spectra: RunSpectra) -> _Streams:
        """Fresh streams, known by run and DOF alone; a second sensor at one DOF has its own."""
        seen: Counter[Dof] = Counter()
        generators = []
        for dof in spectra.responses:
            key = [seed, spectra.run, dof.node, int(dof.unsigned.direction), seen[dof.unsigned]]
            generators.append(np.random.default_rng(key))
            seen[dof.unsigned] += 1
        return cls(tuple(generators), tuple(d.direction.sign for d in spectra.responses))

    def draw(self, count: int) -> NDArray[np.complex128]:
        """The next complex numbers (R, count), real and imaginary parts standard normal."""
        parts = [sign * g.standard_normal((2, count)) for g, sign in zip(self.generators, self.signs, strict=True)]
        return np.asarray([real + 1j * imaginary for real, imaginary in parts])


def _noise(run: DecimatedRun, power: NDArray[np.float64], streams: _Streams) -> NDArray[np.float64]:
    """One draw of the noise of the responses (1 + R, N), none on the force."""
    spectrum = np.sqrt(power / 2) * streams.draw(power.shape[1])
    noise = np.fft.irfft(spectrum, run.samples.shape[1], axis=1)
    return np.vstack([np.zeros(noise.shape[1]), noise / run.scale[1:, None]])


def _block_rows(run: DecimatedRun, options: SubspaceOptions) -> int:
    if options.block_rows:
        return options.block_rows
    rows = _MOST_ROWS // (1 + run.responses)
    return int(np.clip(rows, 12, max(12, run.samples.shape[1] // (4 * (1 + run.responses)))))


def _inside(poles: PolesAtOrder, low_hz: float, high_hz: float) -> PolesAtOrder:
    frequency = np.abs(poles.poles_rad_s) / (2 * np.pi)
    keep = (frequency > low_hz) & (frequency < high_hz)
    return replace(poles, poles_rad_s=poles.poles_rad_s[keep], vectors=poles.vectors[keep])


def _move(pole: complex, found: NDArray[np.complex128]) -> tuple[float, float]:
    """From a pole to the nearest of those found, no further than its own width twice."""
    most = 2 * abs(pole.real)
    if not found.size:
        return most, most
    change = found[np.argmin(np.abs(found - pole))] - pole
    return min(abs(change.real), most), min(abs(change.imag), most)
