"""Every effect of the catalogue passes the suite that is shipped to authors of effects."""

from __future__ import annotations

import pytest

from vgvt.effects import Effect, available_effects
from vgvt.effects.conformance import Check
from vgvt.simulation.effect_conformance import checks

EFFECTS = available_effects()
# One of each way to act: filter of channels, mechanical element, another force law, change between runs.
REPRESENTATIVE = ("channel-delay", "local-absorber", "root-friction", "payload-change")
LONG = ("looks_the_same_to_both_engines", "simulates_over_its_plausible_range")


def cases() -> list[object]:
    """Every check of every effect; the long ones are slow but for a few effects."""
    return [
        pytest.param(check, effect, id=f"{name}-{check}", marks=pytest.mark.slow if _slow(check, effect) else ())
        for name, effect in EFFECTS.items()
        for check in checks()
    ]


def _slow(check: Check, effect: type[Effect]) -> bool:
    stepped = check.name == "changes_the_records" and not effect.linear
    return (check.name in LONG or stepped) and effect.name not in REPRESENTATIVE


@pytest.mark.parametrize(("check", "effect"), cases())
def test_effect_conforms(check: Check, effect: type) -> None:
    check(effect)
