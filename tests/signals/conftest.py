"""A mass on a spring, simulated exactly, and campaigns made of plain arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Geometry, Quantity, Record

MakeCampaign = Callable[..., Campaign]


@dataclass(frozen=True)
class SingleMass:
    """m a + c v + k x = f, watched by an accelerometer."""

    mass_kg: float = 2.0
    natural_frequency_hz: float = 10.0
    damping_ratio: float = 0.02

    @property
    def _coefficients(self) -> tuple[list[float], list[float]]:
        omega = 2 * np.pi * self.natural_frequency_hz
        return [1 / self.mass_kg, 0.0, 0.0], [1.0, 2 * self.damping_ratio * omega, omega**2]

    def accelerance(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """The analytic A/F."""
        s = 2j * np.pi * frequency_hz
        numerator, denominator = self._coefficients
        return np.polyval(numerator, s) / np.polyval(denominator, s)

    def acceleration(self, force: NDArray[np.float64], sample_rate_hz: float) -> NDArray[np.float64]:
        """Exact response from rest to a force that is straight between the samples."""
        b, a, _ = cont2discrete(self._coefficients, 1 / sample_rate_hz, method="foh")
        return np.asarray(lfilter(np.ravel(b), a, force))

    def held_accelerance(self, frequency_hz: NDArray[np.float64], sample_rate_hz: float) -> NDArray[np.complex128]:
        """What a perfect estimate of the sampled system shows: the pulse transfer function."""
        b, a, _ = cont2discrete(self._coefficients, 1 / sample_rate_hz, method="foh")
        z = np.exp(2j * np.pi * frequency_hz / sample_rate_hz)
        return np.polyval(np.ravel(b), z) / np.polyval(a, z)


@pytest.fixture
def single_mass() -> SingleMass:
    """The default mass on its spring."""
    return SingleMass()


@pytest.fixture
def make_campaign() -> MakeCampaign:
    """A campaign from runs of {label: samples}; labels that start with F are forces."""

    def make(
        runs: Sequence[dict[str, NDArray[np.floating]]],
        sample_rate_hz: float | Sequence[float] = 200.0,
        band_hz: tuple[float, float] = (1.0, 50.0),
        quantity: Quantity = Quantity.ACCELERATION,
    ) -> Campaign:
        rates = [sample_rate_hz] * len(runs) if isinstance(sample_rate_hz, float) else sample_rate_hz
        records = []
        for number, (columns, rate) in enumerate(zip(runs, rates, strict=True), start=1):
            channels = tuple(
                Channel(
                    label,
                    Quantity.EXCITATION_FORCE if label.startswith("F") else quantity,
                    ChannelRole.REFERENCE if label.startswith("F") else ChannelRole.RESPONSE,
                    Dof.from_label(label.lstrip("F")),
                )
                for label in columns
            )
            records.append(Record(number, rate, channels, np.array(list(columns.values()))))
        nodes = sorted({c.dof.node for r in records for c in r.channels if c.dof})
        geometry = Geometry(tuple(nodes), np.zeros((len(nodes), 3)))
        return Campaign("made up", geometry, tuple(records), band_hz)

    return make
