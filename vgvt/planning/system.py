"""A rig as far as a plan needs it: poles, residues everywhere, and the force that a volt of command becomes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import Plan, bare_rig, plans
from vgvt.simulation.fisher import RunInformation
from vgvt.simulation.force_path import ForcePath
from vgvt.simulation.information import Seen, seen_in_run
from vgvt.simulation.state_space import StateSpace
from vgvt.simulation.truth import bare_modes, driven_state_space, modes_as_tested

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """One run's rig: ``modes`` (as tested, residues at all points), ``bare`` ones, and how a command becomes force.

    ``driven`` is the whole rig behind them, ``sensors`` are the indices of the run's points among the modes' DOFs.
    """

    layout: Plan
    modes: ModalModel
    bare: ModalModel
    driven: StateSpace
    force: ForcePath
    sensors: tuple[int, ...]

    def force_per_volt(self, frequency_hz: Array) -> Complex:
        """Measured force per volt of command, N/V (K,), at frequencies (K,)."""
        return np.asarray(self.force.per_input(frequency_hz)[:, 0, 0])

    @property
    def residues(self) -> Complex:
        """Residues (M, D) of all modes at all points for the force."""
        assert self.modes.residues is not None, "the truth states residues"
        return np.asarray(self.modes.residues[:, :, 0])


def check_one_shaker(scenario: Scenario) -> None:
    """InputError for a scenario of several shakers or a hammer: what to write for a test with one shaker."""
    count = len(scenario.shakers)
    own = "write a file of your own, with a name and a summary, that extends this scenario"
    if scenario.excitation.kind == "impact":
        raise InputError(
            f"scenario {scenario.name}: excitation.kind",
            "is 'impact', and plans are made for one shaker",
            f'{own}, and into its [excitation] kind = "linear-chirp" and amplitude_v',
        )
    if count > 1:
        raise InputError(
            f"scenario {scenario.name}: further_shaker",
            f"makes {count} shakers, and plans are made for one",
            f"{own}, and into it further_shaker = [], which leaves the first",
        )


def systems_of(scenario: Scenario) -> tuple[System, ...]:
    """The rig of every run of a scenario with one shaker, repeats included; InputError for another exciter.

    Without effects the repeats of a run are one and the same rig.
    """
    check_one_shaker(scenario)
    repeats = scenario.acquisition.repeats
    if repeats > 1 and not scenario.effect:
        once = scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"repeats": 1})})
        return tuple(system for system in systems_of(once) for _ in range(repeats))
    layouts = plans(scenario)
    driven = [driven_state_space(layout, run)[1] for run, layout in enumerate(layouts)]
    bare = bare_modes(layouts[0], bare_rig(layouts[0]))
    return tuple(
        _system(layout, run, model, bare) for run, (layout, model) in enumerate(zip(layouts, driven, strict=True))
    )


def _system(layout: Plan, run: int, driven: StateSpace, bare: ModalModel) -> System:
    modes = modes_as_tested(layout, run, driven)
    index = {dof.node: i for i, dof in enumerate(modes.dofs)}
    sensors = tuple(index[node] for node in layout.scenario.acquisition.run_nodes[run])
    return System(layout, modes, bare, driven, ForcePath.of(driven), sensors)


def seen_by(system: System, run: int = 0) -> Seen:
    """What a run of the system's own scenario would see, before sensors are chosen."""
    return seen_in_run(system.layout, run, system.force, system.modes, system.sensors)


def information_by_response(
    system: System, seen: Seen, together: NDArray[np.intp] | tuple[int, ...]
) -> tuple[Complex, Array]:
    """Unknown poles (U,) and what each point tells about them (D, 2 U, 2 U), ``together`` (S,) measured at once."""
    poles = system.modes.poles
    return poles[seen.unknown], seen.information_by_response(poles, together)


def run_information(system: System, run: int = 0) -> tuple[RunInformation, Seen]:
    """The information of one run with its own sensors, and what it saw."""
    seen = seen_by(system, run)
    poles, each = information_by_response(system, seen, system.sensors)
    return RunInformation(poles, each[list(system.sensors)].sum(axis=0)), seen
