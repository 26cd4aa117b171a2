"""The converter of an ideal acquisition: it reads many instants a sample, filters without delay, and keeps one.

Delta-sigma converters work so. Read at the sample rate alone, a structure's modes above half of it are taken for motion
below: the start and the end of a sweep make them ring, and so does the command, whose images between its samples a
digital-to-analogue converter filters out likewise. All channels pass the same filter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from vgvt.scenario.model import Scenario
from vgvt.simulation.command import sample_times_s

Array = NDArray[np.float64]
# Instants in a period of the excitation's highest frequency: an image of a cubic spline is 3e-6 of it then.
_INSTANTS_PER_PERIOD = 25.0
# Of the sample rate, what passes whole: 1/2.56 is usual for analysers. More where the excitation goes further up.
_PASSED, _BESIDE_THE_EXCITATION = 1 / 2.56, 1.02
_STOPPED_DB = 100.0
# A filter between these would be as long as the record.
_HIGHEST_PASSED = 0.48


@dataclass(frozen=True, slots=True, eq=False)
class Converter:
    """``samples`` at ``rate_hz`` from ``instants`` a sample; ``taps`` (2 n instants + 1,) of the filter, symmetric.

    One instant where the sample rate is far above the excitation: nothing is filtered then.
    """

    rate_hz: float
    samples: int
    instants: int
    taps: Array

    @classmethod
    def of(cls, scenario: Scenario) -> Converter:
        """The converter of a scenario's acquisition."""
        rate, top = scenario.acquisition.sample_rate_hz, scenario.excitation.band_hz[1]
        samples = sample_times_s(scenario).size
        instants = max(1, math.ceil(_INSTANTS_PER_PERIOD * top / rate - 1e-9))
        if instants == 1:
            return cls(rate, samples, 1, np.ones(1))
        passed = min(max(_PASSED, _BESIDE_THE_EXCITATION * top / rate), _HIGHEST_PASSED)
        # What is stopped only above 1 - passed folds into what nobody looks at.
        count, beta = scipy.signal.kaiserord(_STOPPED_DB, 2 * (1 - 2 * passed) / instants)
        half = instants * math.ceil(count / 2 / instants)
        return cls(rate, samples, instants, scipy.signal.firwin(2 * half + 1, 1 / instants, window=("kaiser", beta)))

    @property
    def instant_rate_hz(self) -> float:
        """Instants a second."""
        return self.rate_hz * self.instants

    def times_s(self, steps: int = 1) -> Array:
        """The instants that are read, or ``steps`` of time each: from 0 to as far past the last sample as the filter
        looks ahead.
        """
        count = (self.samples - 1) * self.instants + self.taps.size // 2
        return np.arange(count * steps + 1) / (self.instant_rate_hz * steps)

    def delivered(self, readings: Array) -> Array:
        """Samples (rows, samples) of what is read at those instants (rows, instants), from rest."""
        if self.instants == 1:
            return readings
        ahead = self.taps.size // 2 // self.instants
        return np.asarray(scipy.signal.upfirdn(self.taps, readings, 1, self.instants))[:, ahead : ahead + self.samples]
