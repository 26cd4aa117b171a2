"""The scenario: everything a virtual ground vibration test needs, as one frozen model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import MisfitError, Positive, Table, Whole
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.exciters import check_hammer, check_shakers
from vgvt.scenario.generator import Generator, check_generator
from vgvt.scenario.hammer import Hammer
from vgvt.scenario.instruments import Accelerometers, Acquisition, Transducer
from vgvt.scenario.one_spring import one_suspension
from vgvt.scenario.rig import Excitation, Shaker, Stinger, Suspension, shakers_apart
from vgvt.scenario.sampling import check_sampling
from vgvt.scenario.tolerances import Tolerances


class Simulation(Table):
    """How the test is computed."""

    engine: Literal["mujoco", "linear"] = "mujoco"
    """'mujoco' steps the nonlinear model; 'linear' solves the linearised one exactly."""
    step_s: Positive = 2.5e-4
    """Longest time step of the mujoco engine; shortened to divide the sampling interval, and for stability."""


class Scenario(Table):
    """A complete virtual test; see ``vgvt list scenarios`` for the bundled ones."""

    schema_version: Literal[1] = 1
    """Version of this file format."""
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    """Lower-case letters, digits and hyphens."""
    summary: str
    """One sentence."""
    lesson: str = ""
    """What a reader can learn from it."""
    seed: Whole = Field(default=0, ge=0)
    """Every random number of the test follows from it; the same seed gives the same records."""
    airframe: Airframe
    """The aircraft, without instruments."""
    suspension: Suspension
    """What the aircraft hangs on."""
    shaker: Shaker
    """What shakes it, and where. Several [[shaker]] tables: the first, the others go to further_shaker."""
    further_shaker: tuple[Shaker, ...] = ()
    """More shakers at once, each at a point of its own with a stinger and a transducer like the first's."""
    hammer: Hammer | None = None
    """What strikes it instead, where excitation.kind is 'impact'."""
    stinger: Stinger
    """The rod between shaker and force transducer."""
    transducer: Transducer
    """What measures the force."""
    accelerometers: Accelerometers
    """What measures the motion, and where it can sit."""
    acquisition: Acquisition
    """What samples the signals, and in which runs."""
    excitation: Excitation
    """The command to the shaker."""
    generator: Generator = Generator()
    """What sends that command."""
    effect: tuple[EffectTable, ...] = ()
    """Departures from the ideal test, all at work together: their order changes no aircraft."""
    simulation: Simulation = Simulation()
    """How the test is computed."""
    tolerances: Tolerances = Tolerances()
    """How well the numbers above are known; a simulation does not use them, reconcile does."""

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """What a scenario is in one line; ``to_toml`` has all of it."""
        yield "name", self.name
        yield "airframe", " ".join((self.airframe.name, self.airframe.configuration)).strip()
        yield "beams", len(self.airframe.beam)
        yield "points", len(self.accelerometers.grid.node)
        yield "runs", len(self.acquisition.run_nodes)
        yield "excitation", self.excitation.kind
        yield "band_hz", self.excitation.band_hz
        yield "effects", [table.name for table in self.effect]

    @property
    def shakers(self) -> tuple[Shaker, ...]:
        """All shakers, the first one first."""
        return (self.shaker, *self.further_shaker)

    @property
    def unrecorded_samples(self) -> int:
        """How many samples the shaker has run for when the record begins."""
        return round(self.excitation.before_record_s * self.acquisition.sample_rate_hz)

    @model_validator(mode="before")
    @classmethod
    def _several_shakers(cls, tables: Any) -> Any:
        return shakers_apart(tables) if isinstance(tables, dict) else tables

    @field_validator("suspension", mode="before")
    @classmethod
    def _one_spring(cls, given: Any) -> Any:
        return one_suspension(given)

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        nodes = self.accelerometers.grid.node
        for k, run in enumerate(self.acquisition.runs):
            key = ("acquisition", "runs", k)
            unknown = [node for node in run if node not in nodes]
            if unknown:
                known = f"The grid has {', '.join(map(str, nodes[:30]))}{' …' if len(nodes) > 30 else ''}."
                raise MisfitError(key, f"names node {unknown[0]}, which is not in accelerometers.grid.node", known)
            if len(set(run)) != len(run) or not run:
                raise MisfitError(key, f"is {list(run)}", "Give every run at least one node, and each node once.")
        self.airframe.require_part(("shaker", "attached_to"), self.shaker.attached_to)
        for i, part in enumerate(self.accelerometers.grid.attached_to or ()):
            self.airframe.require_part(("accelerometers", "grid", "attached_to", i), part)
        if self.shaker.node in nodes:
            raise MisfitError(
                ("shaker", "node"),
                f"is {self.shaker.node}, which is also an accelerometer's",
                "Give the drive point a number of its own.",
            )
        check_shakers(self.airframe, self.shakers, self.excitation, self.acquisition, nodes)
        check_hammer(self.hammer, self.excitation, self.acquisition, nodes)
        check_generator(self.generator, self.excitation, self.acquisition)
        drives = len(self.shakers)
        check_sampling(self.excitation, self.acquisition, self.accelerometers, self.transducer, drives)
        return self
