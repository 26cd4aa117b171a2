"""A control surface with play: worn clevises and a servo's gears leave its linkage loose."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import Side
from vgvt.effects.control_surface import ControlSurface
from vgvt.effects.elements import HingedFlap
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ControlSurfaceFreeplay:
    """The hinge's spring acts outside a gap only; the surface's own weight leans it against one end as it hangs.

    Where the wing falls away by more than the weight holds, the surface crosses the gap. The hinge's damper
    acts in the gap too. The truth is linear about rest, with the linkage taut.
    """

    name: ClassVar[str] = "control-surface-freeplay"
    summary: ClassVar[str] = "A control surface turns freely within the play of its linkage"
    family: ClassVar[Family] = Family.NONLINEAR
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "at low level the hinge's own pole-zero pair, higher up it slides down in frequency, broadens and makes "
        "even and odd harmonics, strongest at the sensors nearest to the flap"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("control-surface", "root-freeplay", "rattling-mass")
    separating_test: ClassVar[str] = "load the surface to one side with a soft cord, or lock it with tape"
    reference: ClassVar[str] = (
        "Tang, Dowell and Virgin, Limit cycle behavior of an airfoil with a control surface, J. Fluids Struct. 12, 1998"
    )

    gap_rad: float = parameter(
        "rad",
        0.00175,
        0.035,
        "whole angle that it turns freely",
        neutral=0.0,
        scale="log",
        source="0.1 to 2 degrees: guess for worn model linkages",
    )
    compliance_rad_per_n_m: float = parameter(
        "rad/(N m)", 1.0, 100.0, "compliance of the hinge outside the gap", default=5.0, scale="log", least=0.01
    )
    arm_m: float = parameter("m", 0.01, 0.06, "centre of gravity behind the hinge", default=0.03, scale="log")
    damping_ratio: float = parameter(
        "", 0.005, 0.2, "damping ratio on a fixed wing without play", default=0.03, scale="log", least=0.0
    )
    item: str = dataclasses.field(default="flap-outer", metadata={"doc": "the item that moves; it must be on a beam"})
    side: Side = dataclasses.field(default="right", metadata={"doc": "'right', 'left' or 'both'"})

    def __post_init__(self) -> None:
        """ValueError for a gap or a hinge that is none."""
        if self.gap_rad < 0 or self.compliance_rad_per_n_m <= 0 or self.arm_m <= 0:
            raise ValueError("gap_rad cannot be negative, and compliance_rad_per_n_m and arm_m must be positive")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Take the item off the airframe and hang it on its loose hinge, in every run."""
        del run
        if self.gap_rad == 0:
            return NOTHING
        hinge = ControlSurface(self.compliance_rad_per_n_m, self.arm_m, self.damping_ratio, self.item, self.side)
        hung = hinge.hung(scenario, self.name)
        loose = (dataclasses.replace(e, gap_rad=self.gap_rad) for e in hung.elements if isinstance(e, HingedFlap))
        return dataclasses.replace(hung, elements=tuple(loose))
