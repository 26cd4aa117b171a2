"""Pictures of the assembled rig, rendered without a display, and mode shapes in motion."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vgvt.data import InputError
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import Plan, Rig, driven_spec, hung_rig, plans
from vgvt.simulation.drawing import METAL, draw_rig, span_m
from vgvt.simulation.linear import linearise, site_row
from vgvt.simulation.modes import eigenpairs
from vgvt.simulation.rig import ARMATURE, FRAME_SITE, HOOK_SITE, numbered

# The camera stands ahead of the aircraft and above, on the shaker's side.
_AZIMUTH_DEG, _ELEVATION_DEG = 30.0, -19.0
_FRAMED = 0.92
_LONGEST_SHOWN = 1.5  # suspension, in spans
_LARGEST_TRAVEL, _LARGEST_TURN_RAD = 0.06, 0.35
_FRAMES, _FRAME_MS = 24, 50
_COILS, _COIL_STEPS = 16, 14


class RenderingError(RuntimeError):
    """This machine cannot render: OpenGL is missing or broken."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """The rig of a run with its looks, at rest, and how large the aircraft is."""

    layout: Plan
    run: int
    rig: Rig
    span_m: float


def drawing_of(scenario: Scenario, run: int = 0, width: int = 1280, height: int = 800) -> Drawing:
    """The rig of a run (counted from 0) ready to be rendered ``width`` by ``height`` pixels."""
    layout = plans(scenario)[run]
    spec, qpos = driven_spec(layout, run)
    draw_rig(spec, layout, run)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.global_.fovy = 30.0
    spec.visual.quality.offsamples, spec.visual.quality.shadowsize = 8, 8192
    spec.visual.map.shadowclip, spec.visual.map.zfar = 2.5, 100.0
    span = span_m(layout)
    # Set, not measured: anchors of effects may lie a kilometre away.
    spec.stat.extent, spec.stat.center = span, layout.drive.position_m
    model = spec.compile()
    return Drawing(layout, run, Rig(model, np.concatenate([qpos, np.zeros(model.nq - qpos.size)])), span)


def write_picture(drawing: Drawing, path: Path) -> None:
    """Render the rig at rest into a PNG file, whatever its name; RenderingError without OpenGL."""
    with _camera_man(drawing, [drawing.rig.qpos]) as shoot:
        Image.fromarray(shoot(drawing.rig.qpos)).save(path, format="PNG")


def write_animation(drawing: Drawing, mode: int, path: Path) -> None:
    """Animate a mode of the rig as tested (counted from 1, as in the truth) as an endless WebP, whatever its name.

    The largest travel is 6 % of the span, less where joints would turn too far. Raises
    InputError for a mode that there is not, RenderingError without OpenGL.
    """
    swing = mode_swing(drawing, mode)
    positions = [drawing.rig.qpos + np.sin(angle) * swing for angle in 2 * np.pi * np.arange(_FRAMES) / _FRAMES]
    with _camera_man(drawing, [drawing.rig.qpos, *positions[:: _FRAMES // 4]]) as shoot:
        frames = [Image.fromarray(shoot(qpos)) for qpos in positions]
    frames[0].save(path, format="WEBP", save_all=True, append_images=frames[1:], duration=_FRAME_MS, loop=0, quality=82)


def mode_swing(drawing: Drawing, mode: int) -> NDArray[np.float64]:
    """Coordinates (nq,) of the driven rig at the far point of a mode's swing, from rest.

    An armature goes with its drive point, as the stinger makes it.
    """
    layout, model = drawing.layout, drawing.rig.model
    hung = hung_rig(layout, drawing.run)
    _, vectors = eigenpairs(linearise(hung.model, hung.qpos))
    if not 1 <= mode <= vectors.shape[1]:
        raise InputError("--mode", f"there is no mode {mode}", f"choose one from 1 to {vectors.shape[1]}")
    shape = vectors[:, mode - 1]
    swing = np.zeros(model.nq)
    swing[: shape.size] = np.real(shape * np.exp(-1j * np.angle(shape[np.argmax(np.abs(shape))])))
    data = _posed(model, drawing.rig.qpos)
    for k, drive in enumerate(layout.drives if layout.strike is None else ()):
        armature = model.joint(numbered(ARMATURE, k)).qposadr[0]
        swing[armature] = site_row(model, data, drive.site, drive.axis) @ swing
    travel = max(
        float(np.linalg.norm([site_row(model, data, p.site, axis) @ swing for axis in np.eye(3)]))
        for p in layout.points
    )
    turning = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
    turn = float(np.abs(swing[model.jnt_qposadr[turning]]).max())
    scale = min(_LARGEST_TRAVEL * drawing.span_m / max(travel, 1e-300), _LARGEST_TURN_RAD / max(turn, 1e-300))
    return np.asarray(scale * swing)


def _posed(model: mujoco.MjModel, qpos: NDArray[np.float64]) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    return data


@contextmanager
def _camera_man(
    drawing: Drawing, framed: list[NDArray[np.float64]]
) -> Iterator[Callable[[NDArray[np.float64]], NDArray[np.uint8]]]:
    """A function that renders the rig at some coordinates (nq,); its camera sees all of the ``framed`` ones."""
    model = drawing.rig.model
    size = model.vis.global_
    side = -1.0 if drawing.layout.drive.position_m[1] > 0 else 1.0
    camera = _camera(model, framed, size.offwidth / size.offheight, side * _AZIMUTH_DEG)
    option = mujoco.MjvOption()
    option.sitegroup[:] = 0
    try:
        renderer = mujoco.Renderer(model, size.offheight, size.offwidth)
    except Exception as error:
        # What goes wrong here depends on the driver: every kind of exception was seen.
        backend = os.environ.get("MUJOCO_GL") or "the default"
        raise RenderingError(f"OpenGL does not work here (back end: {backend}): {error}") from error

    def shoot(qpos: NDArray[np.float64]) -> NDArray[np.uint8]:
        data = _posed(model, qpos)
        renderer.update_scene(data, camera, option)
        _add_spring(renderer.scene, data.site(FRAME_SITE).xpos, data.site(HOOK_SITE).xpos, drawing.span_m)
        return np.asarray(renderer.render())

    try:
        yield shoot
    finally:
        renderer.close()


def _camera(
    model: mujoco.MjModel, framed: list[NDArray[np.float64]], aspect: float, azimuth_deg: float
) -> mujoco.MjvCamera:
    """The camera that just sees all but the floor, with the shadow on it; of a long suspension the lower part."""
    points = np.vstack([_corners(model, _posed(model, qpos)) for qpos in framed])
    rest = _posed(model, framed[0])
    top, hook = rest.site(FRAME_SITE).xpos, rest.site(HOOK_SITE).xpos
    shown = _in_view(top, hook, model.stat.extent)
    if shown < 1:
        points[:, 2] = np.minimum(points[:, 2], hook[2] + shown * (top - hook)[2])
    points = np.vstack([points, np.column_stack([points[:, :2], np.full(len(points), points[:, 2].min())])])
    azimuth, elevation = np.radians([azimuth_deg, _ELEVATION_DEG])
    ahead = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([np.sin(azimuth), -np.cos(azimuth), 0.0])
    axes = np.array([right, np.cross(right, ahead)])
    tangent = np.tan(np.radians(model.vis.global_.fovy) / 2) * np.array([aspect, 1.0]) * _FRAMED
    look, distance = points.mean(axis=0), 1.0
    # The nearer a point the wider it is seen: the middle moves with the distance, and a few rounds settle both.
    for _ in range(30):
        depth = (points - look) @ ahead
        across = (points - look) @ axes.T
        distance = float((np.abs(across) / tangent - depth[:, None]).max())
        seen = across / (distance + depth)[:, None]
        look = look + distance * ((seen.max(axis=0) + seen.min(axis=0)) / 2) @ axes
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = look
    camera.distance, camera.azimuth, camera.elevation = distance, azimuth_deg, _ELEVATION_DEG
    return camera


def _in_view(top: NDArray[np.float64], hook: NDArray[np.float64], span_m: float) -> float:
    """The part of the suspension above the hook that the picture shows, 1 for all of it.

    A small aircraft on a soft spring hangs several spans below its frame, and would be a dash in the picture.
    """
    length = float(np.linalg.norm(top - hook))
    return 1.0 if length <= _LONGEST_SHOWN * span_m else span_m / length


def _corners(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """Corners (P, 3) of the boxes around all shapes but the floor."""
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    corners = []
    for geom in np.flatnonzero(model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE):
        box = model.geom_aabb[geom].reshape(2, 3)
        corners.append(data.geom_xpos[geom] + (box[0] + signs * box[1]) @ data.geom_xmat[geom].reshape(3, 3).T)
    return np.vstack(corners)


def _add_spring(scene: mujoco.MjvScene, top: NDArray[np.float64], hook: NDArray[np.float64], span_m: float) -> None:
    """The coils of the suspension, over the middle of the line from the frame to the hook as far as it is in view."""
    top = hook + _in_view(top, hook, span_m) * (top - hook)
    turn = np.linspace(0.0, 2 * np.pi * _COILS, _COILS * _COIL_STEPS + 1)
    fraction = np.linspace(0.15, 0.55, turn.size)[:, None]
    around = np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)]) * span_m / 90
    coil = top + fraction * (hook - top) + around
    for start, stop in pairwise(coil):
        if scene.ngeom >= scene.maxgeom:
            return
        geom = scene.geoms[scene.ngeom]
        capsule = mujoco.mjtGeom.mjGEOM_CAPSULE
        mujoco.mjv_initGeom(geom, capsule, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(METAL, np.float32))
        mujoco.mjv_connector(geom, capsule, span_m / 700, start, stop)
        scene.ngeom += 1
