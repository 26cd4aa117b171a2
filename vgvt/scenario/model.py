"""The scenario: everything a virtual ground vibration test needs, as one frozen model."""

from __future__ import annotations

import difflib
from typing import Literal, Self

from pydantic import Field, model_validator

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import Positive, Table
from vgvt.scenario.instruments import Accelerometers, Acquisition, Transducer
from vgvt.scenario.rig import Excitation, Shaker, Stinger, Suspension


class Simulation(Table):
    """How the test is computed."""

    engine: Literal["mujoco", "linear"] = "mujoco"
    """'mujoco' steps the nonlinear model; 'linear' solves the linearised one exactly."""
    step_s: Positive = 1.0e-4
    """Longest time step of the mujoco engine; shortened to divide the sampling interval, and for stability."""


class Scenario(Table):
    """A complete virtual test; see ``vgvt list scenarios`` for the bundled ones."""

    schema_version: Literal[1] = 1
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    """Lower-case letters, digits and hyphens."""
    summary: str
    """One sentence."""
    lesson: str = ""
    """What a reader can learn from it."""
    seed: int = Field(default=0, ge=0)
    airframe: Airframe
    suspension: Suspension
    shaker: Shaker
    stinger: Stinger
    transducer: Transducer
    accelerometers: Accelerometers
    acquisition: Acquisition
    excitation: Excitation
    simulation: Simulation = Simulation()

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        nodes = self.accelerometers.grid.node
        for k, run in enumerate(self.acquisition.runs):
            for node in run:
                if node not in nodes:
                    near = difflib.get_close_matches(str(node), [str(n) for n in nodes], n=1)
                    hint = f"; did you mean {near[0]}?" if near else ""
                    raise ValueError(f"acquisition.runs[{k}]: node {node} is not in accelerometers.grid.node{hint}")
            if len(set(run)) != len(run) or not run:
                raise ValueError(f"acquisition.runs[{k}]: give every run at least one node, each once; got {list(run)}")
        if self.shaker.node in nodes:
            raise ValueError(
                f"shaker.node {self.shaker.node} is also an accelerometer's; give the drive point a number of its own"
            )
        if self.excitation.band_hz[1] >= self.acquisition.sample_rate_hz / 2:
            raise ValueError(
                f"excitation goes up to {self.excitation.band_hz[1]} Hz, which needs acquisition.sample_rate_hz above "
                f"{2 * self.excitation.band_hz[1]} Hz; it is {self.acquisition.sample_rate_hz}"
            )
        return self
