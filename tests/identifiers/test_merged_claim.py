"""Modes of single runs become one claim: recognised, averaged, put together over sensors and drive points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Direction, Dof, Outcome, modal_assurance
from vgvt.identification.example import Example
from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.completed_runs import completed_runs
from vgvt_identifiers.joint_poles import joint_parameters
from vgvt_identifiers.merged_claim import merged_claim, merged_pole
from vgvt_identifiers.spectra import campaign_spectra

FREQUENCY = np.array([8.0, 15.0, 15.3, 30.0])
DAMPING = np.full(4, 0.01)
MASS = np.array([2.0, 1.0, 0.5, 3.0])
NODES = 8
SHAPES = np.random.default_rng(7).standard_normal((4, NODES))
DRIVE, OTHER = Dof(1, Direction.PLUS_Z), Dof(5, Direction.PLUS_Z)


def poles_at(frequency_hz: np.ndarray) -> np.ndarray:
    omega = 2 * np.pi * frequency_hz
    return np.asarray(omega * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2)))


def run_modes(run: int, nodes: tuple[int, ...], drive: Dof = DRIVE, shift: float = 0.0, std: float = 1e-3) -> RunModes:
    """What a perfect identification of one run tells: SHAPES at some nodes, poles shifted by a share."""
    poles = poles_at(FREQUENCY * (1 + shift))
    size = SHAPES[:, [n - 1 for n in nodes]] * SHAPES[:, [drive.node - 1]]
    return RunModes(
        run,
        drive,
        tuple(Dof(n, Direction.PLUS_Z) for n in nodes),
        poles,
        size / (2j * poles.imag[:, None] * MASS[:, None]),
        np.full(4, std),
        np.full(4, std / 10),
    )


def without(modes: RunModes, which: int) -> RunModes:
    keep = np.delete(np.arange(modes.poles.size), which)
    return replace(
        modes,
        poles=modes.poles[keep],
        residues=modes.residues[keep],
        frequency_std_hz=modes.frequency_std_hz[keep],
        damping_ratio_std=modes.damping_ratio_std[keep],
    )


ROVING = tuple(run_modes(i + 1, (2 * i + 1, 2 * i + 2), shift=1e-3 * (-1) ** i) for i in range(4))


def test_roving_runs_make_whole_shapes_with_their_modal_masses() -> None:
    model = merged_claim(ROVING)
    assert len(model) == 4
    np.testing.assert_allclose(model.natural_frequency_hz, FREQUENCY, rtol=2e-4)
    np.testing.assert_allclose(np.diag(modal_assurance(model.shapes, SHAPES)), 1.0, rtol=1e-5)
    # Shapes have their largest entry at 1; the modal mass goes with the square of that scale.
    assert model.modal_mass_kg is not None
    np.testing.assert_allclose(model.modal_mass_kg, MASS / np.abs(SHAPES).max(axis=1) ** 2, rtol=4e-3)
    assert all("seen_in=4/4" in flags for flags in model.flags)


def test_the_order_of_the_runs_is_no_information() -> None:
    first, second = merged_claim(ROVING), merged_claim(ROVING[::-1])
    # Sums in another order differ in their last digit, on some machines' linear algebra.
    np.testing.assert_allclose(first.natural_frequency_hz, second.natural_frequency_hz, rtol=1e-13)
    np.testing.assert_allclose(second.at(first.dofs).shapes, first.shapes, rtol=1e-12)


def test_a_mode_that_one_run_lacks_is_no_other_mode() -> None:
    lacking = (without(ROVING[0], 2), *ROVING[1:])
    groups = common_modes(lacking)
    assert sorted(map(tuple, groups)) == [(-1, 2, 2, 2), (0, 0, 0, 0), (1, 1, 1, 1), (2, 3, 3, 3)]
    model = merged_claim(lacking)
    assert "shape_incomplete" in model.flags[2] and "seen_in=3/4" in model.flags[2]
    assert len(merged_claim(lacking, fewest_runs=4)) == 3


def test_runs_are_completed_with_the_modes_of_the_others() -> None:
    """The third run misses a mode at first; its residues come from the records for the pole that the others found."""
    example = Example()
    spectra = campaign_spectra(example.campaign(), example.band_hz)
    found = tuple(
        RunModes(
            run.run,
            run.reference,
            run.responses,
            example.modes().poles[keep],
            np.ones((keep.size, 2), complex),
            np.full(keep.size, 1e-3),
            np.full(keep.size, 1e-4),
        )
        for run, keep in zip(spectra.runs, (*[np.arange(3)] * 2, np.array([0, 2]), np.arange(3)), strict=True)
    )
    model = merged_claim(completed_runs(spectra, found))
    np.testing.assert_allclose(model.poles, example.modes().poles)
    assert modal_assurance(model.shapes[1], example.modes().at(model.dofs).shapes[1])[0, 0] > 0.9999
    assert "seen_in=3/4" in model.flags[1] and "seen_in=4/4" in model.flags[0]


def test_shapes_part_what_poles_cannot() -> None:
    """Two runs of the same sensors, in which two close modes come in the opposite order of frequency."""
    first = run_modes(1, (1, 2, 3, 4))
    second = run_modes(2, (1, 2, 3, 4))
    swapped = replace(second, residues=second.residues[[0, 2, 1, 3]])
    np.testing.assert_array_equal(
        common_modes((first, swapped), tolerance=0.05)[:4, :], [[0, 0], [1, 2], [2, 1], [3, 3]]
    )


def test_scatter_beyond_the_standard_deviations_is_reported_and_included() -> None:
    calm = merged_claim(tuple(run_modes(i + 1, (2 * i + 1, 2 * i + 2)) for i in range(4)))
    assert calm.natural_frequency_std_hz is not None
    np.testing.assert_allclose(calm.natural_frequency_std_hz, 1e-3 / 2)
    assert not any("runs_disagree" in flags for flags in calm.flags)
    wild = merged_claim(tuple(run_modes(i + 1, (2 * i + 1, 2 * i + 2), shift=0.006 * (-1) ** i) for i in range(4)))
    assert wild.natural_frequency_std_hz is not None
    assert (wild.natural_frequency_std_hz > 0.006 * FREQUENCY / 2).all()
    assert all("runs_disagree" in flags for flags in wild.flags)


@pytest.mark.parametrize("moved_hz", [0.0, 5e-3])
def test_stated_deviations_of_merged_poles_cover_what_they_say(moved_hz: float) -> None:
    generator = np.random.default_rng(11)
    covered = np.zeros(1000)
    for trial in range(covered.size):
        std = generator.uniform(0.5e-3, 2e-3, 6)
        found = 8.0 + moved_hz * generator.standard_normal(6) + std * generator.standard_normal(6)
        runs = tuple(_one_mode(run, hz, s) for run, (hz, s) in enumerate(zip(found, std, strict=True)))
        pole = merged_pole(runs, np.zeros(6, int))
        covered[trial] = abs(pole.natural_frequency_hz - 8.0) <= 1.96 * pole.natural_frequency_std_hz
    # 95 % nominal; 1000 trials know the share within 0.7 % (one standard deviation).
    assert 0.925 < covered.mean() < 0.98


def _one_mode(run: int, frequency_hz: float, std_hz: float) -> RunModes:
    pole = 2 * np.pi * frequency_hz * np.array([-0.01 + 1j * np.sqrt(1 - 1e-4)])
    return RunModes(run, DRIVE, (DRIVE,), pole, np.ones((1, 1), complex), np.array([std_hz]), np.array([1e-4]))


def test_several_drive_points_complete_each_other() -> None:
    """Nodes 1 to 6 under one drive point, 4 to 8 under another: the shared nodes tie the two together."""
    runs = (run_modes(1, (1, 2, 3, 4, 5, 6)), run_modes(2, (4, 5, 6, 7, 8), OTHER))
    model = merged_claim(runs)
    assert model.references == (DRIVE, OTHER) and model.residues is not None
    np.testing.assert_allclose(np.diag(modal_assurance(model.shapes, SHAPES)), 1.0)
    wanted = SHAPES[:, :, None] * SHAPES[:, None, [0, 4]] / (2j * poles_at(FREQUENCY).imag * MASS)[:, None, None]
    np.testing.assert_allclose(model.residues, wanted, rtol=1e-6)


def test_drive_points_that_share_no_sensor_leave_the_shape_incomplete() -> None:
    model = merged_claim((run_modes(1, (1, 2, 3)), run_modes(2, (6, 7, 8), OTHER)))
    assert all("shape_incomplete" in flags for flags in model.flags)


def test_no_drive_point_response_no_modal_mass() -> None:
    assert merged_claim((run_modes(1, (2, 3, 4)),)).modal_mass_kg is None


def test_a_sensor_that_is_turned_round_between_runs_keeps_its_sign() -> None:
    upright, turned = run_modes(1, (1, 2, 3)), run_modes(2, (2, 4))
    down = Dof(2, Direction.MINUS_Z)
    turned = replace(turned, responses=(down, turned.responses[1]), residues=turned.residues * [-1, 1])
    model = merged_claim((upright, turned))
    np.testing.assert_allclose(np.diag(modal_assurance(model.shapes, SHAPES[:, :4])), 1.0)


def test_a_shaker_that_is_turned_round_between_runs_is_one_reference() -> None:
    """Residues for a force along 1-Z, and one sensor along 3-Z: every sign is undone."""
    upright, turned = run_modes(1, (1, 2)), run_modes(2, (3, 4))
    down = Dof(3, Direction.MINUS_Z)
    turned = replace(
        turned,
        reference=Dof(1, Direction.MINUS_Z),
        responses=(down, turned.responses[1]),
        residues=-turned.residues * [-1, 1],
    )
    model = merged_claim((upright, turned))
    assert model.references == (DRIVE,)
    assert not any("shape_incomplete" in flags for flags in model.flags)
    np.testing.assert_allclose(np.diag(modal_assurance(model.shapes, SHAPES[:, :4] * [1, 1, -1, 1])), 1.0)


def test_common_poles_are_taken_as_they_are() -> None:
    runs = tuple(run_modes(i + 1, (2 * i + 1, 2 * i + 2)) for i in range(4))
    model = merged_claim(runs, poles="common", flags=(("a",), ("b",), ("c",), ("d",)))
    assert model.natural_frequency_std_hz is not None
    np.testing.assert_allclose(model.natural_frequency_std_hz, 1e-3)
    assert [f[0] for f in model.flags] == ["a", "b", "c", "d"]


def test_no_modes_is_an_answer() -> None:
    empty = without(without(without(without(ROVING[0], 3), 2), 1), 0)
    model = merged_claim((empty,), advice=("nothing stands out",))
    assert model.outcome is Outcome.NOTHING_FOUND and model.advice


def test_sizes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="residues"):
        replace(ROVING[0], residues=ROVING[0].residues[:, :1])


def test_errors_that_go_together_are_undone_by_runs_that_see_them_differently() -> None:
    """Two runs whose errors lie along different directions: only together do they know either mode well."""
    first, second = (np.array([[1.0, c], [c, 1.0]]) for c in (0.95, -0.95))
    poles = 2 * np.pi * np.array([10.0, 10.2]) * (-0.01 + 1j)
    names = (run_modes(1, (1, 2)), run_modes(2, (3, 4)))
    moved = np.array([0.02, 0.02]), np.array([-0.01, 0.01])  # each along its own long axis
    runs = []
    for modes, matrix, shift in zip(names, (first, second), moved, strict=True):
        covariance = np.zeros((4, 4))
        covariance[:2, :2] = 0.02**2 * matrix
        covariance[2:, 2:] = 1e-8 * np.eye(2)
        own = poles * (1 + shift / np.array([10.0, 10.2]))
        known = np.sqrt(np.diag(covariance))
        shapes = modes.residues[:2]
        runs.append(
            replace(
                modes,
                poles=own,
                residues=shapes,
                frequency_std_hz=known[:2],
                damping_ratio_std=known[2:],
                covariance=covariance,
            )
        )
    groups = np.array([[0, 0], [1, 1]])
    mean, std = joint_parameters(tuple(runs), groups) or (None, None)
    weights = [np.linalg.inv(0.02**2 * m) for m in (first, second)]
    together = np.linalg.inv(sum(weights))
    expected = np.abs(poles) / (2 * np.pi) + together @ sum(w @ m for w, m in zip(weights, moved, strict=True))
    assert mean is not None and std is not None
    np.testing.assert_allclose(mean[0], expected, rtol=1e-6)
    np.testing.assert_allclose(std[0], np.sqrt(np.diag(together)), rtol=1e-9)
    # One mode after the other would state 0.02 / sqrt(2).
    assert (std[0] < 0.5 * 0.02 / np.sqrt(2)).all()
    claim = merged_claim(tuple(runs), groups=groups)
    np.testing.assert_allclose(claim.natural_frequency_hz, expected, rtol=1e-6)


def test_a_run_that_does_not_know_a_mode_has_no_say_in_it() -> None:
    covariance = np.diag([1e-4, 1e-4, 1e-8, 1e-8])
    blind = covariance.copy()
    blind[1] = blind[3] = 0.0
    poles = 2 * np.pi * np.array([10.0, 14.0]) * (-0.01 + 1j)
    runs = []
    for modes, matrix, own in ((run_modes(1, (1, 2)), covariance, poles), (run_modes(2, (3, 4)), blind, 1.001 * poles)):
        known = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), np.inf))
        shapes = modes.residues[:2]
        runs.append(
            replace(
                modes,
                poles=own,
                residues=shapes,
                frequency_std_hz=known[:2],
                damping_ratio_std=known[2:],
                covariance=matrix,
            )
        )
    claim = merged_claim(tuple(runs), groups=np.array([[0, 0], [1, 1]]))
    np.testing.assert_allclose(claim.natural_frequency_hz * (2 * np.pi), np.abs(poles) * [1.0005, 1.0], rtol=1e-9)
