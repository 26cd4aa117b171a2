"""Places at which something unknown could act, and what it would do to A/F: a force, or a factor on some channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import GroundSpring
from vgvt.reconcile.mechanics.response import accelerances
from vgvt.reconcile.prediction.grouping import Group
from vgvt.reconcile.prediction.surrogate import Anchor, Reduced
from vgvt.reconcile.question.problem import Problem
from vgvt.scenario.planform import part_at, surface_height_m
from vgvt.simulation.attached import held_row, point_rows

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_UP = np.array([0.0, 0.0, 1.0])
EVERY_RUN = " in every run"
"""What the label of a place ends with that is one sensor, wherever it roves."""
ON_BOTH_SIDES = " and its mirror image"
"""What the label of two places ends with that are asked together."""
_MIRRORED_M = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class FreePlace:
    """A place: rows (n,) over the coordinates of each group of runs, which differ, or a mask (C,) of channels.

    ``kind`` is 'structure', 'drive', 'sensor' or 'airframe'. The last is everywhere: of rows (J, n) that act alike.
    What acts where something ``turns`` is a moment in N m over an angle in rad, and elsewhere a force in N over a way
    in m; on the whole airframe it is relative to what is there. ``motion`` says along what, alike on both sides of an
    aircraft: a direction, 'bending' or 'torsion'.
    """

    label: str
    kind: str
    position_m: tuple[float, float, float] | None
    rows: tuple[Array, ...] | None
    mask: NDArray[np.bool_] | None
    turns: bool = False
    motion: str = ""


def with_article(label: str, kind: str) -> str:
    """The label of a place within a sentence: of sensors there are many, of the force and the airframe one."""
    return f"the {label}" if kind in ("drive", "airframe") else label


def free_places(problem: Problem, here: Anchor, keep: NDArray[np.bool_]) -> list[FreePlace]:
    """Every place that could carry something: grid points, body, hook, roots, and the channels that are kept (C,)."""
    groups = here.assembled
    plan = groups[0].plan
    found = []
    for point in plan.grid:
        at = (float(point.position_m[0]), float(point.position_m[1]), float(point.position_m[2]))
        rows = tuple(g.structure.axis[g.structure.places.index(point.site)] for g in groups)
        motion = point.dof.direction.name
        found.append(FreePlace(f"force at {point.dof}", "structure", at, rows, None, motion=motion))
    # A body without an outline is a point.
    for x, y in dict.fromkeys(on_centre_line(problem)):
        at = (x, y, plan.scenario.airframe.body.centre_of_gravity_m[2])
        rows = tuple(_UP @ point_rows(g.structure, g.plan, "body", np.array(at))[0] for g in groups)
        found.append(FreePlace(f"force on the body at x = {x:.2f} m", "structure", at, rows, None))
    hook = plan.scenario.suspension.hook_m
    rows = tuple(_UP @ point_rows(g.structure, g.plan, "body", np.array(hook))[0] for g in groups)
    found.append(FreePlace("force at the hook", "structure", hook, rows, None))
    # The first six coordinates: translation, then rotation about the body's own x, y and z.
    for axis, name in ((4, "pitch"), (3, "roll")):
        rows = tuple(_unit(g.structure.drive.size, axis) for g in groups)
        found.append(FreePlace(f"{name} moment on the centre body", "structure", None, rows, None, turns=True))
    for beam, chain in plan.parts.chains.items():
        for kind in ("bending", "torsion"):
            first = [k for g in groups if (k := _first_joint(g, beam, kind)) is not None]
            if len(first) == len(groups):
                rows = tuple(_unit(g.structure.drive.size, k) for g, k in zip(groups, first, strict=True))
                x, y, z = (float(v) for v in chain.table.point_m(0.0))
                label = f"{kind} at the root of {beam}"
                found.append(FreePlace(label, "structure", (x, y, z), rows, None, turns=True, motion=kind))
    channels = problem.measured.channels
    everything = np.ones(len(channels), dtype=bool)
    found.append(FreePlace("force channel", "drive", None, None, everything))
    instruments = np.array([c.instrument for c in channels])
    if len(problem.measured.runs) > 1:
        found += [
            FreePlace(f"sensor-{k + 1}{EVERY_RUN}", "sensor", None, None, instruments == k)
            for k in np.unique(instruments)
        ]
    found += [
        FreePlace(channel.label, "sensor", None, None, np.arange(len(channels)) == i)
        for i, channel in enumerate(channels)
        if keep[i]
    ]
    return found


def place_at(here: Anchor, x_m: float, y_m: float) -> FreePlace:
    """Up and down at (x, y), wherever sensors sit: a place of the part there, as its beam between two links moves."""
    airframe = here.assembled[0].plan.scenario.airframe
    part = part_at(airframe, (x_m, y_m))
    at = (x_m, y_m, surface_height_m(airframe, part, x_m, y_m))
    rows = tuple(held_row(g.structure, g.plan, GroundSpring(part, at, 0.0, 0.0)) for g in here.assembled)
    return FreePlace(label_at(x_m, y_m), "structure", at, rows, None, motion="PLUS_Z")


def label_at(x_m: float, y_m: float) -> str:
    """What a place at (x, y) is called."""
    return f"force at x = {x_m:.2f} m, y = {y_m:.2f} m"


def places_differ(problem: Problem) -> bool:
    """Whether fitted data could tell one place from another: they are of two points or more, in however many runs."""
    channels = problem.measured.channels
    return len({c.dof for c, fitted in zip(channels, problem.split.train, strict=True) if fitted}) > 1


def on_centre_line(problem: Problem) -> list[tuple[float, float]]:
    """Three points (x, y) of the body, from nose to tail."""
    body = problem.scenario.airframe.body
    x = [p[0] for p in body.outline_m] or [body.centre_of_gravity_m[0]]
    return [(float(v), 0.0) for v in np.linspace(min(x) + 0.05 * np.ptp(x), max(x) - 0.05 * np.ptp(x), 3)]


def with_mirror_images(places: Sequence[FreePlace]) -> dict[str, tuple[FreePlace, ...]]:
    """Places by their labels, each alone, and those together that are each other's mirror images."""
    found: dict[str, tuple[FreePlace, ...]] = {p.label: (p,) for p in places}
    for k, j in mirror_images(places):
        found[f"{places[k].label}{ON_BOTH_SIDES}"] = (places[k], places[j])
    return found


def mirror_images(places: Sequence[FreePlace]) -> list[tuple[int, int]]:
    """Indices of two places that are each other's mirror images, the one with y > 0 first, where they move alike.

    What an aircraft has on one wing it often has on the other, a soft root or a loose flap.
    """
    points = [(k, place, place.position_m) for k, place in enumerate(places) if place.position_m is not None]
    return [
        (k, j)
        for k, one, (x, y, z) in points
        for j, other, at in points
        if y > _MIRRORED_M and np.allclose(at, (x, -y, z), atol=_MIRRORED_M) and one.motion == other.motion
    ]


def answered(here: Anchor, place: FreePlace, predicted: ComplexArray, chain: ComplexArray) -> ComplexArray:
    """What a unit of something at a place does to A/F (C, L): a force of the shaker's size, or a factor on channels.

    ``predicted`` (C, L) is the prediction at the anchor, ``chain`` (C, L) what the measuring chain makes of it.
    """
    if place.rows is None:
        assert place.mask is not None
        return np.asarray(predicted * place.mask[:, None])
    out = np.zeros(predicted.shape, dtype=complex)
    omega = 2 * np.pi * here.problem.measured.frequency_hz
    for group, row in zip(here.groups, place.rows, strict=True):
        pushed = replace(group.matrices, drive=reduced_row(group, row), spare=np.zeros_like(group.matrices.spare))
        masses = tuple(group.masses_kg[r] if group.roving else np.zeros(r.size) for r in group.runs)
        out[group.channels] = accelerances(pushed, omega, group.runs, masses)
    return np.asarray(out * chain)


def moved(group: Reduced, row: Array, omega: Array) -> tuple[ComplexArray, ComplexArray]:
    """Displacement (L,) along a row over a group's coordinates by a unit of the shaker, and by a unit along the row."""
    own = reduced_row(group, row)
    seen = replace(group.matrices, axis=own[None], tilt=np.zeros((1, own.size)), spare=np.zeros(1))
    runs, none = (np.array([0]),), (np.zeros(1),)
    by_drive = accelerances(seen, omega, runs, none)[0] / -(omega**2)
    return by_drive, accelerances(replace(seen, drive=own), omega, runs, none)[0] / -(omega**2)


def reduced_row(group: Reduced, row: Array) -> Array:
    """A row (n,), or rows (J, n), over a group's assembled coordinates in its reduced ones, (m,) or (J, m)."""
    return np.asarray(row @ group.basis[: row.shape[-1]])


def _unit(size: int, k: int) -> Array:
    """A row (n,) with a one at an index."""
    row = np.zeros(size)
    row[k] = 1.0
    return row


def _first_joint(group: Group, beam: str, kind: str) -> int | None:
    """The coordinate of a beam's innermost joint of a kind, 'bending' or 'torsion': a soft root is one more."""
    joints, links = group.structure.joints, group.plan.parts.chains[beam].links
    return next((joints.index(name) for link in links if (name := f"{link.name}/{kind}") in joints), None)
