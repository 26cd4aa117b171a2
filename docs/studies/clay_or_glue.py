"""What clay in place of glue changes: ``python docs/studies/clay_or_glue.py [SEEDS]`` fills clay-or-glue.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import matplotlib.pyplot as plt
import numpy as np
from command_line import BEGIN_AGAIN, parser_of_seeds, whole_number, worked_off
from numpy.typing import NDArray
from virtual_lab import (
    IMAGES,
    PAGES,
    mean_interval,
    nearest,
    reduced_hati,
    save_figure,
    table,
    with_fields,
    write_results,
)

from vgvt.data import Campaign, ChannelRole, ModalModel, Record, modal_assurance
from vgvt.identification import make_identifier
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulate, truth_of

BAND_HZ = (3.0, 35.0)
MODES = ("1st symmetric bending", "1st antisymmetric bending", "2nd symmetric bending")
ROD_N_M_PER_RAD = 84.0
SEEDS = 20


@dataclass(frozen=True, slots=True)
class Mount:
    """What holds the force gauge: axial and rotational stiffness, loss factor."""

    axial_n_per_m: float
    rotational_n_m_per_rad: float
    loss_factor: float


GLUE = Mount(3e6, 30.0, 0.1)
CLAY = Mount(20e3, 0.2, 0.6)
PATHS: Mapping[str, tuple[str, ...]] = {
    "axial path alone": ("axial",),
    "moment path alone": ("moment",),
    "both": ("axial", "moment"),
}


def scenario_with(mount: Mount | None, paths: tuple[str, ...] = (), shift_x_m: float = 0.0) -> Scenario:
    """The reduced Hati with a plain steel rod, and of the mount only the paths named; a remount moves the point."""
    scenario = with_fields(reduced_hati(*BAND_HZ), "stinger", axial_stiffness_n_per_m=15.6e6)
    effects = []
    if mount is not None and "axial" in paths:
        compliance = 1 / mount.axial_n_per_m
        effects.append(
            EffectTable(name="mount-compliance", compliance_m_per_n=compliance, loss_factor=mount.loss_factor)
        )
    if mount is not None and "moment" in paths:
        series = 1 / (1 / mount.rotational_n_m_per_rad + 1 / ROD_N_M_PER_RAD)
        # Of the energy in the series only the mount's share is lost.
        loss = mount.loss_factor * series / mount.rotational_n_m_per_rad
        effects.append(EffectTable(name="stinger-moment", rotational_stiffness_n_m_per_rad=series, loss_factor=loss))
    if shift_x_m:
        effects.append(EffectTable(name="drive-remount", shift_x_m=shift_x_m, from_run=3))
        runs = tuple(tuple(range(first, first + 5)) for first in (1, 6, 11, 16))
        scenario = with_fields(scenario, "acquisition", runs=runs)
    return scenario.model_copy(update={"effect": tuple(effects)})


def per_command(campaign: Campaign) -> Campaign:
    """The same records with the command in the force's place: what is identified is A/D."""

    def swapped(record: Record) -> Record:
        rows = record.samples.copy()
        roles = [channel.role for channel in record.channels]
        rows[roles.index(ChannelRole.REFERENCE)] = rows[roles.index(ChannelRole.DRIVE)]
        return replace(record, samples=rows)

    return replace(campaign, runs=tuple(swapped(record) for record in campaign.runs))


def identify(campaign: Campaign) -> ModalModel:
    """The claim of the quadrature identifier."""
    return make_identifier("quadrature").identify(campaign, BAND_HZ)


@dataclass(frozen=True, slots=True, eq=False)
class Repetitions:
    """Claims of the three modes over the seeds: (seeds, modes) and shapes (seeds, modes, DOFs)."""

    frequency_hz: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    shapes: NDArray[np.complex128]


def repeat(scenario: Scenario, seeds: range, command_as_input: bool = False) -> Repetitions:
    """Measure and identify once a seed; RuntimeError where a mode is not found."""
    modes = truth_of(scenario).as_tested[0]
    targets = [float(modes.natural_frequency_hz[modes.labels.index(name)]) for name in MODES]
    frequency, damping, shapes = [], [], []
    for seed in seeds:
        campaign = simulate(scenario.model_copy(update={"seed": seed})).campaign
        claim = identify(per_command(campaign) if command_as_input else campaign)
        found = [nearest(claim, target, within=0.25) for target in targets]
        if None in found:
            raise RuntimeError(f"seed {seed}: modes at {claim.natural_frequency_hz} Hz, wanted {targets}")
        index = [k for k in found if k is not None]
        frequency.append(claim.natural_frequency_hz[index])
        damping.append(claim.damping_ratio[index])
        shapes.append(claim.shapes[index])
    return Repetitions(np.array(frequency), np.array(damping), np.array(shapes))


def shape_change(a: Repetitions, b: Repetitions) -> NDArray[np.float64]:
    """1 - MAC between two sets of claims, seed by seed, (seeds, modes)."""
    return np.array([1 - np.diag(modal_assurance(x, y)) for x, y in zip(a.shapes, b.shapes, strict=True)])


def change(of: NDArray[np.float64], to: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative change in percent, seed by seed: both mounts meet the same noise."""
    return np.asarray(100 * (to / of - 1))


def force_per_command(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequency in Hz and |F/D| in N/V over the swept band."""
    record = simulate(scenario).campaign.runs[0]
    drive = record.select(ChannelRole.DRIVE)[1][0]
    force = record.select(ChannelRole.REFERENCE)[1][0]
    frequency = np.fft.rfftfreq(drive.size, 1 / record.sample_rate_hz)
    keep = (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1])
    return frequency[keep], np.abs(np.fft.rfft(force) / np.fft.rfft(drive))[keep]


def _cells(values: NDArray[np.float64], unit: float = 1.0) -> list[str]:
    pairs = [mean_interval(unit * column) for column in values.T]
    return [f"{mean:+.3g} ± {half:.1g}" for mean, half in pairs]


def results(seeds: range) -> str:
    """The tables of the page."""
    blocks = [f"{len(seeds)} seeds; mean and 95 % interval of the difference, seed by seed."]
    head = ("clay in place of glue", *(name.removeprefix("1st ") for name in MODES))
    for command, title in ((False, "A/F"), (True, "A/D (the command taken as input)")):
        rows = []
        for path, parts in PATHS.items():
            glue = repeat(scenario_with(GLUE, parts), seeds, command)
            clay = repeat(scenario_with(CLAY, parts), seeds, command)
            rows.append((f"{path}: f, %", *_cells(change(glue.frequency_hz, clay.frequency_hz))))
            rows.append((f"{path}: ζ, %", *_cells(change(glue.damping_ratio, clay.damping_ratio))))
            rows.append((f"{path}: 1 − MAC, 10⁻⁶", *_cells(shape_change(glue, clay), 1e6)))
        blocks.append(f"**{title}**\n\n{table(head, rows)}")
    blocks.append(_against_ideal(seeds))
    blocks.append(_drive_path())
    blocks.append(_remounted(seeds))
    return "\n\n".join(blocks)


def _against_ideal(seeds: range) -> str:
    ideal = repeat(scenario_with(None), seeds)
    rows = []
    for name, mount in (("glue", GLUE), ("clay", CLAY)):
        measured = repeat(scenario_with(mount, PATHS["both"]), seeds)
        rows.append((f"{name}: f, %", *_cells(change(ideal.frequency_hz, measured.frequency_hz))))
        rows.append((f"{name}: ζ, %", *_cells(change(ideal.damping_ratio, measured.damping_ratio))))
    head = ("A/F, against a rigid mount that passes no moment", *(name.removeprefix("1st ") for name in MODES))
    return table(head, rows)


def _drive_path() -> str:
    rows = []
    for path, parts in PATHS.items():
        frequency, glue = force_per_command(scenario_with(GLUE, parts))
        clay = force_per_command(scenario_with(CLAY, parts))[1]
        step = 20 * np.log10(clay / glue)
        worst = int(np.argmax(np.abs(step)))
        rows.append((path, f"{step[worst]:+.2f} dB at {frequency[worst]:.2f} Hz", f"{np.median(np.abs(step)):.3f} dB"))
    return table(("F/D, clay over glue, 3–35 Hz", "largest change", "median of its size"), rows)


def _remounted(seeds: range) -> str:
    plain = replace_runs(scenario_with(None))
    stayed = repeat(plain, seeds)
    rows = []
    for shift in (0.002, 0.010, 0.025):
        moved = repeat(scenario_with(None, shift_x_m=shift), seeds)
        rows.append((f"{1e3 * shift:.0f} mm: f, %", *_cells(change(stayed.frequency_hz, moved.frequency_hz))))
        rows.append((f"{1e3 * shift:.0f} mm: ζ, %", *_cells(change(stayed.damping_ratio, moved.damping_ratio))))
        rows.append((f"{1e3 * shift:.0f} mm: 1 − MAC, 10⁻⁶", *_cells(shape_change(stayed, moved), 1e6)))
    head = ("A/F, gauge put back that much further aft", *(name.removeprefix("1st ") for name in MODES))
    return (
        f"Four runs of five accelerometers, the gauge taken off and put back after the second:\n\n{table(head, rows)}"
    )


def replace_runs(scenario: Scenario) -> Scenario:
    """The same test in four runs of five accelerometers."""
    runs = tuple(tuple(range(first, first + 5)) for first in (1, 6, 11, 16))
    return with_fields(scenario, "acquisition", runs=runs)


def picture() -> None:
    """Force per command with either mount, path by path."""
    figure, axes = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
    for (path, parts), colour in zip(PATHS.items(), ("tab:blue", "tab:red", "0.2"), strict=True):
        frequency, glue = force_per_command(scenario_with(GLUE, parts))
        clay = force_per_command(scenario_with(CLAY, parts))[1]
        axes.plot(frequency, 20 * np.log10(clay / glue), color=colour, linewidth=0.9, label=path)
    axes.set(xlabel="frequency in Hz", ylabel="force per command,\nclay over glue, in dB")
    axes.grid(alpha=0.3)
    axes.legend()
    save_figure(figure, IMAGES / "study-clay-or-glue.svg")
    plt.close(figure)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    # An interval needs two.
    return parser_of_seeds(__doc__, whole_number(2), SEEDS, "a mount").parse_args(words)


def fill(count: int) -> None:
    """Measure, and fill the page and its figure."""
    write_results(PAGES / "clay-or-glue.md", results(range(count)))
    picture()


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: fill(given.seeds), BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
