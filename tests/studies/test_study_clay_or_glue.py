"""Clay against glue: the moment path changes A/F, the axial path changes only what is taken per command."""

import clay_or_glue
import numpy as np
import pytest
from clay_or_glue import CLAY, GLUE, change, force_per_command, repeat, scenario_with, shape_change
from virtual_lab import mean_interval

SEEDS = range(4)


def shifts(paths: tuple[str, ...], seeds: range = SEEDS, command: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Changes of frequency and damping in percent, (seeds, modes), clay in place of glue."""
    glue, clay = (repeat(scenario_with(mount, paths), seeds, command) for mount in (GLUE, CLAY))
    return change(glue.frequency_hz, clay.frequency_hz), change(glue.damping_ratio, clay.damping_ratio)


def test_in_force_ratios_the_moment_path_tells_clay_from_glue_and_the_axial_path_does_not() -> None:
    axial, moment = shifts(("axial",)), shifts(("moment",))
    assert np.abs(axial[0].mean(axis=0)).max() < 1e-3
    assert np.abs(axial[1].mean(axis=0)).max() < 0.05
    for column, least in ((0, 1.0), (1, 0.2)):
        mean, half = mean_interval(moment[0][:, column])
        assert mean + half < -least
        assert moment[1][:, column].max() < -1.0


def test_per_command_the_axial_path_counts_too() -> None:
    frequency, damping = shifts(("axial",), command=True)
    mean, half = mean_interval(frequency[:, 0])
    assert mean + half < -0.1
    assert np.abs(damping.mean(axis=0)).max() > 2.0


def test_the_mount_lies_in_the_path_of_the_force() -> None:
    glue, clay = (force_per_command(scenario_with(mount, ("axial",)))[1] for mount in (GLUE, CLAY))
    assert np.abs(20 * np.log10(clay / glue)).max() > 1.0


def test_a_remounted_gauge_changes_shapes_but_hardly_poles() -> None:
    stayed = repeat(clay_or_glue.replace_runs(scenario_with(None)), range(2))
    moved = repeat(scenario_with(None, shift_x_m=0.010), range(2))
    assert np.abs(change(stayed.frequency_hz, moved.frequency_hz)).max() < 0.05
    assert shape_change(stayed, moved)[:, 0].min() > 1e-4


@pytest.mark.slow
def test_full_size_clay_is_nearer_to_a_mount_that_passes_no_moment() -> None:
    seeds = range(20)
    ideal = repeat(scenario_with(None), seeds)
    glue, clay = (repeat(scenario_with(mount, ("axial", "moment")), seeds) for mount in (GLUE, CLAY))
    off = {name: change(ideal.frequency_hz, m.frequency_hz)[:, 0] for name, m in (("glue", glue), ("clay", clay))}
    assert mean_interval(off["glue"])[0] > 50 * abs(mean_interval(off["clay"])[0])
