"""The mount alone gives way from run to run: clay that creeps, glue that warms."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.mount_compliance import MountCompliance
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import Shape, check_schedule, progress
from vgvt.effects.shakers import shaker_choice
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class MountCreep:
    """The mount gains a compliance c · s(run), with s from 0 in the first run to 1 in the last."""

    name: ClassVar[str] = "mount-creep"
    summary: ClassVar[str] = "The force gauge's mount softens from run to run"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "almost none in A/F and none in the poles; force per command and the drive point's own motion change in the "
        "order of time"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("gain-drift", "drive-remount", "mount-compliance")
    separating_test: ClassVar[str] = "repeat the first run at the end; accelerometers on both sides of the mount"
    reference: ClassVar[str] = (
        "Findley, Lai and Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials, 1976; "
        "Ewins, Modal Testing, 2nd ed., chapter 3"
    )

    compliance_m_per_n: float = parameter(
        "m/N",
        2e-7,
        2.5e-4,
        "axial compliance that the mount has gained at the end",
        neutral=0.0,
        scale="log",
        source="up to that of clay, as mount-compliance",
    )
    loss_factor: float = parameter(
        "", 0.05, 1.0, "loss factor: glue 0.05-0.2, clay 0.3-1", default=0.3, scale="log", least=0.0
    )
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    shape: Shape = dataclasses.field(default="exponential", metadata={"doc": "'linear', 'exponential' or 'step'"})
    time_constant_runs: float = dataclasses.field(default=3.0, metadata={"doc": "of the exponential, in runs"})
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the step, counted from 1"})
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        require_above_zero(self, "frequency_hz")
        check_schedule(self.time_constant_runs, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the mount under the gauge as soft as it has become in this run."""
        runs = len(scenario.acquisition.run_nodes)
        gained = self.compliance_m_per_n * progress(self.shape, run, runs, self.time_constant_runs, self.from_run)
        if gained == 0:
            return NOTHING
        return MountCompliance(gained, self.loss_factor, self.frequency_hz, self.shaker).act(scenario, run)
