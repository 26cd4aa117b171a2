"""A rig as far as a plan needs it: poles, residues everywhere, and the force that a volt of command becomes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel
from vgvt.planning.fisher import (
    Lines,
    RunInformation,
    accelerance,
    information_of_responses,
    lines_for,
    weighted_slopes,
)
from vgvt.planning.unknowns import unknowns
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import Plan, plans
from vgvt.simulation.command import sent_commands
from vgvt.simulation.information import force_noise, response_noise
from vgvt.simulation.state_space import StateSpace
from vgvt.simulation.truth import assemble_truth, driven_state_space

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BEYOND = 1.15  # modes as near to the band as this factor may make the responses change within it
_SAMPLES_PER_CYCLE = 8


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """One run's rig: ``modes`` (as tested, residues at all points), ``bare`` ones, and how a command becomes force.

    ``force_poles`` (n,), ``force_gains`` (n,) and ``force_through``: force per volt is
    Σ gain / (s - pole) + through. ``sensors`` are the indices of the run's points among the modes' DOFs.
    """

    layout: Plan
    modes: ModalModel
    bare: ModalModel
    force_poles: Complex
    force_gains: Complex
    force_through: float
    sensors: tuple[int, ...]

    def force_per_volt(self, frequency_hz: Array) -> Complex:
        """Measured force per volt of command, N/V (K,), at frequencies (K,)."""
        s = 2j * np.pi * frequency_hz[:, None]
        return np.asarray((self.force_gains / (s - self.force_poles)).sum(axis=1) + self.force_through)

    @property
    def residues(self) -> Complex:
        """Residues (M, D) of all modes at all points for the force."""
        assert self.modes.residues is not None, "the truth states residues"
        return np.asarray(self.modes.residues[:, :, 0])


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What a run would see over ``lines``: ``unknown`` are the indices of the modes whose poles it must find.

    ``background`` are the powers of s that stand for all other modes;
    ``energy`` (K,) is |F|², N² s²; ``noise`` (K,) of a response and ``felt`` (K,) of the force, per Hz;
    ``response`` (D, K) the accelerance at all points.
    """

    lines: Lines
    unknown: NDArray[np.intp]
    background: tuple[int, ...]
    energy: Array
    noise: Array
    felt: Array
    response: Complex

    def weight(self, sensors: NDArray[np.intp] | tuple[int, ...]) -> Array:
        """4 |F|² / G (K,) of a response when all of ``sensors`` (S,) share the noise of one force."""
        return _weight(self.energy, self.noise, self.felt, self.response[list(sensors)])


def _weight(energy: Array, noise: Array, felt: Array, measured: Complex) -> Array:
    return np.asarray(4 * energy / (noise + felt * (np.abs(measured) ** 2).sum(axis=0)))


def systems_of(scenario: Scenario) -> tuple[System, ...]:
    """The rig of every run of a scenario with one shaker, repeats included; InputError for another exciter.

    Without effects the repeats of a run are one and the same rig.
    """
    if scenario.further_shaker or scenario.excitation.kind == "impact":
        where = f"scenario {scenario.name}: excitation.kind"
        raise InputError(where, "is not one shaker", "Plan with one shaker; a hammer or several shakers cannot be yet.")
    repeats = scenario.acquisition.repeats
    if repeats > 1 and not scenario.effect:
        once = scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"repeats": 1})})
        return tuple(system for system in systems_of(once) for _ in range(repeats))
    layouts = plans(scenario)
    driven = [driven_state_space(layout, run)[1] for run, layout in enumerate(layouts)]
    truth = assemble_truth(layouts, driven)
    return tuple(
        _system(layout, run, model, modes, truth.bare)
        for run, (layout, model, modes) in enumerate(zip(layouts, driven, truth.as_tested, strict=True))
    )


def _system(layout: Plan, run: int, driven: StateSpace, modes: ModalModel, bare: ModalModel) -> System:
    poles, right = np.linalg.eig(driven.state_matrix)
    gains = np.linalg.solve(right, driven.inputs[:, 0].astype(complex)) * (driven.output_matrix[-1] @ right)
    index = {dof.node: i for i, dof in enumerate(modes.dofs)}
    sensors = tuple(index[node] for node in layout.scenario.acquisition.run_nodes[run])
    return System(layout, modes, bare, poles, gains, float(driven.feedthrough_rows[-1, 0]), sensors)


def command_energy(layout: Plan, run: int, lines: Lines) -> Array:
    """|U|², V² s² (K,), of a run's command: its energy spectrum, averaged over the width of each line."""
    excitation = layout.scenario.excitation
    rate = _SAMPLES_PER_CYCLE * excitation.band_hz[1]
    time = np.arange(round(excitation.record_s * rate) + 1) / rate
    spectrum = np.abs(np.fft.rfft(sent_commands(layout, run, time)[0]) / rate) ** 2
    axis = np.arange(spectrum.size + 1) * rate / time.size - 0.5 * rate / time.size
    total = np.concatenate([[0.0], np.cumsum(spectrum) * rate / time.size])
    # A line is averaged over its own bin at least: below that a record knows nothing.
    half = np.maximum(lines.width_hz, rate / time.size) / 2
    above = np.interp(lines.frequency_hz + half, axis, total)
    below = np.interp(lines.frequency_hz - half, axis, total)
    return np.asarray((above - below) / (2 * half))


def seen_by(system: System, run: int = 0) -> Seen:
    """What a run of the system's own scenario would see, before sensors are chosen."""
    low, high = system.layout.scenario.excitation.band_hz
    frequency, poles = system.modes.natural_frequency_hz, system.modes.poles
    lines = lines_for((low, high), poles[(frequency >= low / _BEYOND) & (frequency <= high * _BEYOND)])
    f = lines.frequency_hz
    energy = np.abs(system.force_per_volt(f)) ** 2 * command_energy(system.layout, run, lines)
    noise, felt = response_noise(system.layout, f), force_noise(system.layout, f)
    response = accelerance(f, poles, system.residues)
    inside, measured = np.flatnonzero((frequency >= low) & (frequency <= high)), response[list(system.sensors)]
    asked = unknowns(lines, poles, inside, _weight(energy, noise, felt, measured), measured)
    return Seen(lines, asked.modes, asked.background, energy, noise, felt, response)


def information_by_response(
    system: System, seen: Seen, together: NDArray[np.intp] | tuple[int, ...]
) -> tuple[Complex, Array]:
    """Unknown poles (U,) and what each point tells about them (D, 2 U, 2 U), ``together`` (S,) measured at once."""
    poles = system.modes.poles[seen.unknown]
    gram = weighted_slopes(seen.lines, poles, seen.weight(together), seen.background)
    return poles, information_of_responses(gram, system.residues[seen.unknown])


def run_information(system: System, run: int = 0) -> tuple[RunInformation, Seen]:
    """The information of one run with its own sensors, and what it saw."""
    seen = seen_by(system, run)
    poles, each = information_by_response(system, seen, system.sensors)
    return RunInformation(poles, each[list(system.sensors)].sum(axis=0)), seen
