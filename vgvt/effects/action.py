"""What an effect does to one run of a test, as data and pure functions of arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Element
from vgvt.effects.point_error import PointError
from vgvt.scenario.model import Scenario

Array = NDArray[np.float64]
Stage = Literal["sensor", "conditioner", "converter", "record"]
"""Where on its way a channel is changed, in the order of the way.

'sensor': what is sensed, in SI units, before the sensor's own noise. 'conditioner': the sensor's volts, with its noise.
'converter': the volts at the converter's inputs, behind all that conditioners do. 'record': the volts as they were
converted, with all noise, clipped and rounded: nothing is added to them any more.
"""


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFilter:
    """A linear change of some channels: ``response(frequency_hz (F,)) -> (F,)`` complex multiplies their spectra.

    ``channels`` is 'force', 'drive', 'response' (all accelerometers), 'all', or a DOF label like '12+Z'.
    ``stage`` says where it acts: behind the sensor, whose own noise passes it, too, or before that noise comes in.
    """

    channels: str
    response: Callable[[Array], NDArray[np.complex128]]
    stage: Stage = "sensor"


@dataclass(frozen=True, slots=True, eq=False)
class ChannelTransform:
    """Any other change of some channels, in the time domain.

    ``change(samples (N,), sample_rate_hz, generator) -> (N,)`` in SI units at stage 'sensor', in volts at the others;
    ``generator`` is a random stream of this channel, run and effect alone, or with ``together`` of this run and effect
    alone: it draws the same on all channels that the effect changes. The samples begin at rest, and the record at the
    one of number ``scenario.unrecorded_samples``; at stage 'record' they are the record's alone. What comes in at the
    converter is told the rate at which that really samples: by the ``pace`` of every change of the channel its samples
    are as many times as far apart as stated.
    """

    channels: str
    change: Callable[[Array, float, np.random.Generator], Array]
    stage: Stage = "sensor"
    together: bool = False
    pace: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Action:
    """What an effect does to one run: another scenario, more elements, another command, channels or points.

    ``scenario`` None leaves it as it was. ``command(command_v (N,), time_s (N,)) -> (N,)``
    changes the command on its way to the amplifier; the recorded drive channel stays as sent.
    ``warming_k`` is what a thermometer beside the aircraft shows above its reading before the campaign, in K; what
    the warmth does to the aircraft is in the other fields.
    """

    scenario: Scenario | None = None
    elements: tuple[Element, ...] = ()
    command: Callable[[Array, Array], Array] | None = None
    channels: tuple[ChannelFilter | ChannelTransform, ...] = ()
    points: tuple[PointError, ...] = ()
    warming_k: float = 0.0

    def same_rig(self, other: Action) -> bool:
        """Whether another action makes the same of aircraft, rig and sensors' places; channels aside."""
        return (self.scenario, self.elements, self.points) == (other.scenario, other.elements, other.points)


NOTHING = Action()
