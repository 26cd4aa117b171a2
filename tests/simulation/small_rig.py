"""Tools of the simulation tests: change a scenario, take a record's spectra."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Record
from vgvt.scenario import Scenario


def band_spectra(record: Record, low_hz: float = 3.0, high_hz: float = 35.0) -> NDArray[np.complex128]:
    """Whole-record spectra of all channels (channels, lines) in a band."""
    frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
    return np.fft.rfft(record.samples, axis=1)[:, (frequency >= low_hz) & (frequency <= high_hz)]


def revised(scenario: Scenario, **tables: dict[str, object]) -> Scenario:
    """The scenario with some fields of some tables changed."""
    changes = {name: getattr(scenario, name).model_copy(update=update) for name, update in tables.items()}
    return scenario.model_copy(update=changes)
