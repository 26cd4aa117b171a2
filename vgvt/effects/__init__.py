"""The catalogue of departures from the ideal rig: one file an effect, a plugin family (group ``vgvt.effects``)."""

from vgvt.effects.action import Action, ChannelFilter, ChannelTransform
from vgvt.effects.parameter import Parameter, parameter, parameters_of
from vgvt.effects.protocol import Effect, Family
from vgvt.effects.registry import available_effects, effects_of, make_effect

__all__ = [
    "Action",
    "ChannelFilter",
    "ChannelTransform",
    "Effect",
    "Family",
    "Parameter",
    "available_effects",
    "effects_of",
    "make_effect",
    "parameter",
    "parameters_of",
]
