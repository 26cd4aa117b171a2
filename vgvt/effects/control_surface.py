"""A control surface moves on its hinge: the servo's linkage gives way."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import Side, with_airframe
from vgvt.effects.elements import Element, HingedFlap, Vector
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Beam, Item
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.mirror import expanded_beams, expanded_items
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ControlSurface:
    """An item of the airframe that was rigid turns about a hinge along the beam, ahead of its centre of gravity.

    Its frequency is sqrt(k/J)/2π with J = m arm² + the item's own inertia about the
    hinge; far below it the item is as rigid as before, far above it stands still.
    Trim holds it in line with the beam however the aircraft hangs, and its weight swings it back or, nose down, away.
    """

    name: ClassVar[str] = "control-surface"
    summary: ClassVar[str] = "A control surface rotates on its hinge"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a pole-zero pair near the hinge frequency, strongest at the sensors nearest to the flap"
    confused_with: ClassVar[tuple[str, ...]] = ("local-absorber",)
    separating_test: ClassVar[str] = "lock the surface with tape and repeat one run"
    reference: ClassVar[str] = "Bisplinghoff, Ashley and Halfman, Aeroelasticity, 1955 (control surface rotation)"

    compliance_rad_per_n_m: float = parameter(
        "rad/(N m)", 1.0, 100.0, "compliance of the hinge: linkage and servo", neutral=0.0, scale="log"
    )
    arm_m: float = parameter("m", 0.01, 0.06, "centre of gravity behind the hinge", default=0.03, scale="log")
    damping_ratio: float = parameter(
        "", 0.005, 0.2, "damping ratio on a fixed wing", default=0.03, scale="log", least=0.0
    )
    item: str = dataclasses.field(default="flap-outer", metadata={"doc": "the item that moves; it must be on a beam"})
    side: Side = dataclasses.field(default="right", metadata={"doc": "'right', 'left' or 'both'"})

    def __post_init__(self) -> None:
        """ValueError for a hinge without a place or stiffness."""
        if self.compliance_rad_per_n_m < 0 or self.arm_m <= 0:
            raise ValueError("compliance_rad_per_n_m cannot be negative and arm_m must be positive")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Take the item off the airframe and hang it on its hinge, in every run."""
        del run
        return NOTHING if self.compliance_rad_per_n_m == 0 else self.hung(scenario, self.name)

    def hung(self, scenario: Scenario, effect: str) -> Action:
        """The item off the airframe and on its hinge; InputError, naming the ``effect``, where there is none."""
        items = expanded_items(scenario.airframe)
        moving = [i for i in items if self._means(i)]
        if not moving or any(i.attached_to == "body" for i in moving):
            known = tuple(dict.fromkeys(i.name for i in scenario.airframe.item if i.attached_to != "body"))
            advice = choose_one_of(self.item, known) if known else "No beam has any item: leave the effect out."
            raise InputError(f"effect {effect}: item", f"no beam has an item {self.item!r} there", advice)
        beams = {b.name: b for b in expanded_beams(scenario.airframe)}
        fixed = tuple(i for i in items if i not in moving)
        flaps: tuple[Element, ...] = tuple(self._flap(beams[i.attached_to], i) for i in moving)
        hinged = (*scenario.airframe.hinged, *moving)
        return Action(scenario=with_airframe(scenario, item=fixed, hinged=hinged), elements=flaps)

    def _means(self, item: Item) -> bool:
        sides = ("right", "left") if self.side == "both" else (self.side,)
        y = item.position_m[1]
        return item.name in (self.item, *(f"{self.item}-{s}" for s in sides)) and (
            self.side == "both" or (y >= 0) == (self.side == "right")
        )

    def _flap(self, beam: Beam, item: Item) -> HingedFlap:
        axis, centre = beam_axis(beam), np.array(item.position_m)
        middle = (axis.position_m[1:] + axis.position_m[:-1]) / 2
        near = int(np.argmin(np.linalg.norm(middle - centre, axis=1)))
        tangent, hinge = axis.tangent[near], centre - self.arm_m * axis.aft[near]
        own = float((tangent**2) @ np.array(item.inertia_kg_m2))
        stiffness = 1 / self.compliance_rad_per_n_m
        damping = 2 * self.damping_ratio * math.sqrt(stiffness * (item.mass_kg * self.arm_m**2 + own))
        return HingedFlap(
            beam.name,
            _vector(hinge),
            _vector(tangent),
            item.position_m,
            item.mass_kg,
            item.inertia_kg_m2,
            stiffness,
            damping,
        )


def _vector(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Vector:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
