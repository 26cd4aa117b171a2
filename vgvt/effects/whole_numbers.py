"""Which parameters of the effects take whole numbers only: a sweep cannot read it in a scenario's tables."""

from __future__ import annotations

import dataclasses
import typing

from vgvt.effects.registry import available_effects


def whole_parameters() -> dict[str, frozenset[str]]:
    """The parameters of every installed effect that take whole numbers only, by the name of the effect.

    An effect without any has an empty set.
    """
    return {name: _whole(effect) for name, effect in available_effects().items()}


def _whole(effect: type) -> frozenset[str]:
    hints = typing.get_type_hints(effect)
    fields = dataclasses.fields(effect)
    return frozenset(field.name for field in fields if field.init and hints[field.name] is int)
