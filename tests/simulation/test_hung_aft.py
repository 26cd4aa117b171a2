"""BFF hung behind its centre of gravity: nose down, pushed sideways, swinging, and its modes a little elsewhere."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from vgvt.data import ModalModel
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.library import library_folder
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import driven_rig, hung_rig, plans
from vgvt.simulation.attitude import attitudes_deg
from vgvt.simulation.labels import mode_labels
from vgvt.simulation.linear import linearise
from vgvt.simulation.modes import eigenpairs
from vgvt.simulation.rig import ARMATURE

LEVEL, AFT = "bff", "bff-hung-aft"


def one_run(name: str) -> Scenario:
    """The scenario with the run of the sensor at the right wing tip alone."""
    scenario = load_scenario(name)
    return scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"runs": ((18,),)})})


@functools.cache
def modes_of(name: str) -> ModalModel:
    """Modes as tested in that run."""
    return truth_of(one_run(name)).as_tested[0]


def driven_share(name: str) -> dict[str, float]:
    """For each mode of the hung aircraft by its label: how far the force moves its own point, φ²/(φᵀMφ), 1/kg."""
    layout = plans(one_run(name))[0]
    rig = hung_rig(layout, 0)
    linear = linearise(rig.model, rig.qpos, ((layout.drive.site, layout.drive.axis),))
    vectors = eigenpairs(linear)[1]
    labels = mode_labels(layout.parts, rig.model, linear.mass, vectors)
    moved = np.abs(linear.displacement[0] @ vectors) ** 2
    weight = np.einsum("ik,ij,jk->k", vectors.conj(), linear.mass, vectors).real
    return dict(zip(labels, moved / weight, strict=True))


def pushed_sideways(name: str) -> float:
    """The horizontal part of the direction that the shaker pushes in, 0 to 1."""
    rig = driven_rig(plans(one_run(name))[0], 0)
    axis = rig.model.jnt_axis[rig.model.joint(ARMATURE).id]
    return float(np.hypot(axis[0], axis[1]))


def test_it_hangs_nose_down_as_its_file_says() -> None:
    ((_, level),), ((_, aft),) = (attitudes_deg(one_run(name)) for name in (LEVEL, AFT))
    assert abs(level) < 1
    assert aft == pytest.approx(-66, abs=0.6)
    text = (library_folder() / f"{AFT}.toml").read_text(encoding="utf-8")
    assert f"it hangs at {-aft:.0f} degrees" in text


def test_a_stinger_at_right_angles_to_its_surface_pushes_sideways() -> None:
    assert pushed_sideways(LEVEL) < 0.1
    assert pushed_sideways(AFT) > 0.9


def test_the_force_makes_it_swing() -> None:
    """As the paper saw; hung level the force stands at right angles to the swing."""
    level, aft = driven_share(LEVEL), driven_share(AFT)
    assert level["fore-aft swing"] < 1e-3
    assert aft["fore-aft swing"] > 100 * level["fore-aft swing"]
    assert aft["fore-aft swing"] == pytest.approx(0.6 * aft["1st symmetric bending"], rel=0.1)


def test_the_hang_moves_the_elastic_modes_as_the_catalogue_says() -> None:
    text = (library_folder() / "README.md").read_text(encoding="utf-8")
    table = text.split(f"`{LEVEL}`, against")[1].split("\n\n")[1].splitlines()
    column = [cell.strip() for cell in table[0].strip("|").split("|")].index("the hang moves it by")
    stated = [row.strip("|").split("|")[column].replace("−", "-").replace("%", "") for row in table[2:]]
    level, aft = (modes_of(name).band(3.0, 35.0) for name in (LEVEL, AFT))
    assert level.labels == aft.labels
    moved = 100 * (aft.natural_frequency_hz / level.natural_frequency_hz - 1)
    np.testing.assert_allclose([float(cell) for cell in stated], moved, atol=0.06)
