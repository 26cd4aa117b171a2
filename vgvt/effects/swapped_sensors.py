"""Two accelerometers exchanged: plugs in the wrong sockets, or labels on the wrong points."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.point_error import PointError
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import chosen_node
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SwappedSensors:
    """The sensor labelled with one node sits at the other, and the other way round, in every run that uses them.

    Two exchanges that share a node follow each other in the order of their tables, labels from where they then sit.
    """

    name: ClassVar[str] = "swapped-sensors"
    summary: ClassVar[str] = "Two accelerometers are exchanged"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "two entries of every mode shape are exchanged, in otherwise perfect data"
    confused_with: ClassVar[tuple[str, ...]] = ("sign-flip", "sensor-position-error", "stiffness-asymmetry")
    separating_test: ClassVar[str] = "tap each sensor and see which channel answers"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (checks before the test)"

    node: int = dataclasses.field(default=0, metadata={"doc": "one node; 0 for none"})
    other_node: int = dataclasses.field(default=0, metadata={"doc": "the node it is exchanged with; 0 for none"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Exchange the two places."""
        del run
        if self.node == self.other_node or 0 in (self.node, self.other_node):
            return NOTHING
        one, other = (chosen_node(scenario, n, self.name).dof.node for n in (self.node, self.other_node))
        return Action(points=(PointError(one, at_node=other), PointError(other, at_node=one)))
