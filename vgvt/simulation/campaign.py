"""Simulate a campaign: from a scenario to the records a lab would bring home, and the truth beside them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Geometry, Truth
from vgvt.data.shown import brief, headed
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import outlines_m
from vgvt.simulation.acquisition import record
from vgvt.simulation.assembly import Plan, Rig, driven_rig, plan, plans
from vgvt.simulation.command import drive_commands, excitation_in_words, excitation_notes, sent_commands
from vgvt.simulation.converter import Converter
from vgvt.simulation.linear_engine import prepared, respond
from vgvt.simulation.mujoco_engine import Progress, step_runs
from vgvt.simulation.state_space import StateSpace, state_space
from vgvt.simulation.stepping import substeps
from vgvt.simulation.truth import assemble_truth


@dataclass(frozen=True, slots=True, eq=False)
class SimulationResult:
    """A campaign, the truth to seal beside it, and where the time went in seconds."""

    campaign: Campaign
    truth: Truth
    timing_s: dict[str, float]

    def __repr__(self) -> str:
        parts = map(brief, (self.campaign, self.truth))
        return headed(f"SimulationResult in {sum(self.timing_s.values()):.1f} s", parts)


def simulate(
    scenario: Scenario, *, engine: str | None = None, progress: Callable[[float, str], None] | None = None
) -> SimulationResult:
    """Simulate every run of a scenario with the 'mujoco' or the 'linear' engine (default: the scenario's).

    ``progress(fraction, message)`` is called now and then. Deterministic for a
    seed, whatever the number of threads.
    """
    made = _Made(scenario, engine, progress)
    truth = assemble_truth(made.layouts, made.models)
    made.clock.lap("truth")
    return SimulationResult(made.campaign(), truth, made.clock.laps)


def simulated_campaign(
    scenario: Scenario, *, engine: str | None = None, progress: Callable[[float, str], None] | None = None
) -> Campaign:
    """The records of :func:`simulate` alone: for many campaigns whose modes nobody asks for, in half the time."""
    return _Made(scenario, engine, progress).campaign()


def stepping_work(scenario: Scenario) -> float:
    """What the mujoco engine takes for a scenario: steps of time of all runs, times degrees of freedom squared."""
    made = _Made(scenario, "mujoco", None)
    samples = Converter.of(scenario).times_s().size
    return float(samples * made.substeps() * sum(rig.model.nv**2 for rig in made.rigs))


class _Made:
    """A scenario's rigs and models, from which its records and its truth come."""

    def __init__(self, scenario: Scenario, engine: str | None, progress: Progress | None) -> None:
        self.engine = engine or scenario.simulation.engine
        if self.engine not in ("mujoco", "linear"):
            raise ValueError(f"engine must be 'mujoco' or 'linear', got {self.engine!r}")
        self.clock = _Clock()
        self._scenario, self._progress = scenario, progress
        self.layouts = plans(scenario)
        self.rigs = [driven_rig(layout, run) for run, layout in enumerate(self.layouts)]
        self.models = [
            state_space(layout, rig, (*layout.points, *layout.run_points(run)))
            for run, (layout, rig) in enumerate(zip(self.layouts, self.rigs, strict=True))
        ]
        self.clock.lap("assemble")

    def campaign(self) -> Campaign:
        """Simulate, and record."""
        scenario, layouts = self._scenario, self.layouts
        if self.engine == "linear":
            readings = _linear_readings(layouts, self.models, self._progress)
        else:
            readings = _mujoco_readings(layouts, self.rigs, self.substeps(), self._progress)
        self.clock.lap("simulate")
        converter = Converter.of(scenario)
        times = converter.times_s()
        records = tuple(
            record(layout, run, converter.delivered(drive_commands(scenario, run, times)), readings[run])
            for run, layout in enumerate(layouts)
        )
        self.clock.lap("acquire")
        notes = {
            "aircraft": " ".join((scenario.airframe.name, scenario.airframe.configuration)).strip(),
            "excitation": excitation_in_words(scenario),
            "engine": self.engine,
            "seed": str(scenario.seed),
        } | excitation_notes(scenario)
        return Campaign(scenario.name, geometry(plan(scenario)), records, scenario.excitation.recorded_band_hz, notes)

    def substeps(self) -> int:
        """Steps of time that the mujoco engine takes from one instant of the converter to the next."""
        rate = Converter.of(self._scenario).instant_rate_hz
        poles = np.concatenate([np.linalg.eigvals(model.state_matrix) for model in self.models])
        return substeps(poles, rate, self._scenario.simulation.step_s)


def geometry(layout: Plan) -> Geometry:
    """The test geometry: sensor points and drive point, with lines along each row and the outline for drawings."""
    nodes = tuple(p.dof.node for p in layout.points)
    return Geometry(
        nodes, np.array([p.position_m for p in layout.points]), _rows(layout), outlines_m(layout.scenario.airframe)
    )


def _linear_readings(
    layouts: list[Plan], models: list[StateSpace], progress: Progress | None
) -> list[NDArray[np.float64]]:
    converter, readings = Converter.of(layouts[0].scenario), []
    times, sent = converter.times_s(), prepared(np.zeros(4))
    for run, (layout, model) in enumerate(zip(layouts, models, strict=True)):
        # After the truth's points the model's outputs are the sensors of the run, then the forces.
        index = list(range(len(layout.points), model.output_matrix.shape[0]))
        command = sent_commands(layout, run, times)
        # A sweep is the same in every run: its spline and spectrum are, too.
        sent = sent if np.array_equal(command, sent.samples_v) else prepared(command)
        readings.append(converter.delivered(respond(model.outputs(index), sent, converter.instant_rate_hz)))
        if progress is not None:
            progress((run + 1) / len(models), f"run {run + 1} of {len(models)} solved")
    return readings


def _mujoco_readings(
    layouts: list[Plan], rigs: list[Rig], count: int, progress: Progress | None
) -> list[NDArray[np.float64]]:
    converter = Converter.of(layouts[0].scenario)
    rate = converter.instant_rate_hz
    for rig in rigs:
        rig.model.opt.timestep = 1.0 / (rate * count)
    commands = [sent_commands(layout, run, converter.times_s(count)) for run, layout in enumerate(layouts)]
    return [converter.delivered(r) for r in step_runs(layouts, rigs, commands, count, rate, progress)]


def _rows(layout: Plan) -> tuple[tuple[int, ...], ...]:
    """Lines through the grid points of each part: forward and aft of its axis, from the root to the tip."""
    lines = []
    for chain in layout.parts.chains.values():
        rows: dict[bool, list[tuple[float, int]]] = {False: [], True: []}
        links = {link.name for link in chain.links}
        for point in (p for p in layout.grid if p.carrier in links):
            arc = chain.table.nearest_arc_m(point.position_m)
            aft = (point.position_m - chain.table.point_m(arc)) @ chain.table.frame(arc)[2] > 0
            rows[bool(aft)].append((arc, point.dof.node))
        lines += [tuple(node for _, node in sorted(row)) for row in rows.values() if len(row) > 1]
    return tuple(lines)


class _Clock:
    """Seconds between laps."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        """Book the time since the last lap under a name."""
        now = time.perf_counter()
        self.laps[name] = now - self._last
        self._last = now
