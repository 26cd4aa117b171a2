"""Pictures of the rig: the drawing changes no physics, everything is in view, a mode moves."""

from __future__ import annotations

import os
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")  # before mujoco is imported, where this file comes first

import mujoco
import numpy as np
import pytest
from PIL import Image

from vgvt.data import InputError
from vgvt.scenario import load_scenario
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.linear import linearise
from vgvt.simulation.picture import Drawing, RenderingError, drawing_of, mode_swing, write_animation, write_picture


@pytest.fixture(scope="module")
def drawing() -> Drawing:
    """The small scenario, small."""
    return drawing_of(load_scenario("quick"), width=320, height=200)


def rendered(drawing: Drawing, path: Path) -> np.ndarray:
    """The picture as (height, width, 3) of 0 to 255; skips where OpenGL is missing."""
    try:
        write_picture(drawing, path)
    except RenderingError as error:
        pytest.skip(f"no rendering on this machine: {error}")
    return np.asarray(Image.open(path).convert("RGB")).astype(float)


@pytest.mark.parametrize("name", ["quick", "garteur-sm-ag19"])
def test_looks_weigh_nothing_and_stiffen_nothing(name: str) -> None:
    scenario = load_scenario(name)
    plain, drawn = driven_rig(plans(scenario)[0], 0), drawing_of(scenario).rig
    assert drawn.model.ngeom > plain.model.ngeom
    assert np.array_equal(drawn.qpos, plain.qpos)
    assert np.array_equal(drawn.model.body_mass[: plain.model.nbody], plain.model.body_mass)
    assert np.all(drawn.model.geom_contype == 0) and np.all(drawn.model.geom_conaffinity == 0)
    bare, dressed = linearise(plain.model, plain.qpos), linearise(drawn.model, drawn.qpos)
    for key in ("mass", "damping", "stiffness"):
        before, after = getattr(bare, key), getattr(dressed, key)
        assert np.abs(after - before).max() <= 1e-12 * np.abs(before).max(), key


def test_the_picture_shows_the_rig_whole(drawing: Drawing, tmp_path: Path) -> None:
    picture = rendered(drawing, tmp_path / "rig.png")
    assert picture.shape == (200, 320, 3)
    assert picture.mean() > 100, "the picture is dark"
    orange = (picture[..., 0] > 150) & (picture[..., 2] < 90) & (picture[..., 1] < 150)
    assert orange.any(), "no accelerometer to be seen"
    dark = picture.max(axis=2) < 80
    assert dark.any(), "no shaker to be seen"
    # Floor and background are pale: nothing of the rig may reach the edge of the picture.
    edge = np.concatenate([picture[0], picture[:, 0], picture[:, -1]])
    assert edge.min() > 120


@pytest.fixture(scope="module")
def hung_deep() -> Drawing:
    """The teaching beam on a spring so soft that it hangs seven spans below its frame."""
    scenario = load_scenario("teaching-beam")
    soft = scenario.suspension.model_copy(update={"free_length_m": 14.0})
    return drawing_of(scenario.model_copy(update={"suspension": soft}), width=320, height=200)


def test_a_long_suspension_leaves_the_aircraft_its_size(hung_deep: Drawing, tmp_path: Path) -> None:
    """It had been a dash at the foot of a long line: fewer than 20 pixels wide."""
    picture = rendered(hung_deep, tmp_path / "deep.png")
    orange = (picture[..., 0] > 150) & (picture[..., 2] < 90) & (picture[..., 1] < 150)
    assert np.ptp(np.flatnonzero(orange.any(axis=0))) > 80
    wire = picture[:40].max(axis=2) < 190
    assert wire.any(), "no suspension to be seen"


_SHORT = """
extends = "teaching-beam"
name = "short"
summary = "The beam at 1.2 m."

[[airframe.beam]]
name = "beam"

[airframe.beam.stations]
position_m = [[0.05, 0.0, 0.0], [0.05, 0.6, 0.0]]

[suspension]
hook_m = [0.05, 0.0, 0.05]

[shaker]
position_m = [0.05, 0.45, 0.0]

[accelerometers.grid]
node = [1, 2, 3]
x_m = [0.05, 0.05, 0.05]
y_m = [0.2, 0.4, 0.59]

[acquisition]
runs = [[1, 2, 3]]
"""


def test_the_floor_has_no_speckles(tmp_path: Path) -> None:
    """Under a slanting light shadow maps err: hundreds of dark dots, where nothing casts a shadow."""
    (tmp_path / "short.toml").write_text(_SHORT)
    picture = rendered(drawing_of(load_scenario(tmp_path / "short.toml")), tmp_path / "floor.png").min(axis=2)
    around = np.median([np.roll(np.roll(picture, i, 0), j, 1) for i in (-4, 0, 4) for j in (-4, 0, 4)], axis=0)
    dots = picture < around - 30  # joints of tiles are 15 darker
    assert dots[:, -250:].sum() < 20


def test_the_swing_moves_the_drive_point_and_the_armature_alike(drawing: Drawing) -> None:
    model = drawing.rig.model
    swing = mode_swing(drawing, 7)
    data = mujoco.MjData(model)
    small = 1e-4

    def stinger_m(qpos: np.ndarray) -> float:
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)
        return float(data.ten_length[model.tendon("stinger").id])

    stretch = stinger_m(drawing.rig.qpos + small * swing) - stinger_m(drawing.rig.qpos)
    travel = small * abs(swing[model.joint("armature").qposadr[0]])
    assert travel > 0
    assert abs(stretch) < 1e-2 * travel


@pytest.mark.slow
def test_the_animation_moves_and_closes(drawing: Drawing, tmp_path: Path) -> None:
    rendered(drawing, tmp_path / "rig.png")
    path = tmp_path / "mode.webp"
    write_animation(drawing, 7, path)
    with Image.open(path) as film:
        assert film.format == "WEBP" and film.n_frames >= 12
        frames = []
        for k in (0, film.n_frames // 4, film.n_frames // 2):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB")).astype(float))
    # A standing wave passes through rest at half its period.
    assert np.abs(frames[1] - frames[0]).mean() > 3 * np.abs(frames[2] - frames[0]).mean()


def test_a_mode_that_there_is_not(drawing: Drawing) -> None:
    with pytest.raises(InputError, match="no mode 999"):
        mode_swing(drawing, 999)


def test_without_opengl_it_says_so(drawing: Drawing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise AttributeError("no eglQueryString")

    monkeypatch.setattr(mujoco, "Renderer", broken)
    with pytest.raises(RenderingError, match="OpenGL does not work here"):
        write_picture(drawing, tmp_path / "rig.png")
