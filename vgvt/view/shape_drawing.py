"""Mode shapes and the test set-up as small SVG drawings that need no script and print well."""

from __future__ import annotations

import html
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Geometry, ModalModel
from vgvt.view.shape_geometry import Mesh, aligned, displacement, main_axis, mesh_of
from vgvt.view.theme import NEGATIVE_COLOUR, POSITIVE_COLOUR

_WIDTH = 340.0
_AZIMUTH_RAD, _ELEVATION_RAD = np.radians(15.0), np.radians(26.0)
_DEFLECTION_SHARE = 0.13

TOP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Plan view: right is right, the nose is up (screen y grows downwards, as in SVG)."""
_OBLIQUE = np.array(
    [
        [np.sin(_AZIMUTH_RAD), np.cos(_AZIMUTH_RAD), 0.0],
        [
            np.sin(_ELEVATION_RAD) * np.cos(_AZIMUTH_RAD),
            -np.sin(_ELEVATION_RAD) * np.sin(_AZIMUTH_RAD),
            -np.cos(_ELEVATION_RAD),
        ],
    ]
)
"""Seen from behind, above and a little to the left: the z axis is up."""


def shape_drawing(
    geometry: Geometry, model: ModalModel, mode: int, title: str, reference: tuple[ModalModel, int] | None = None
) -> str:
    """Plan view with signed dots above an oblique view with the deflected grid, as one SVG element.

    ``reference`` is another model and its mode, drawn dashed after scaling (the truth under a claim).
    """
    nodes = shape_nodes(geometry, model)
    if not nodes:
        return '<p class="note">The shape has no DOF with a position.</p>'
    mesh = mesh_of(geometry, nodes)
    vectors = displacement(model, mode, nodes)
    other = None
    if reference is not None:
        other = aligned(displacement(reference[0], reference[1], nodes), vectors)
    span = float(np.ptp(_extent(geometry, mesh), axis=0).max()) or 1.0
    plan, plan_height = _plan_view(geometry, mesh, vectors, span)
    oblique, oblique_height = _oblique_view(geometry, mesh, vectors, other, span)
    height = plan_height + oblique_height + 10
    body = f'{plan}<g transform="translate(0 {plan_height + 10:.0f})">{oblique}</g>'
    return svg_element(body, height, title)


def setup_drawing(campaign: Campaign) -> str:
    """Plan view of the aircraft with numbered response points and the drive points, as one SVG element."""
    geometry = campaign.geometry
    responses = tuple(dict.fromkeys(d.node for d in campaign.response_dofs))
    drives = tuple(dict.fromkeys(d.node for d in campaign.reference_dofs))
    nodes = responses + tuple(n for n in drives if n not in responses)
    mesh = mesh_of(geometry, nodes)
    everything = _extent(geometry, mesh)
    frame = Frame(TOP, everything, margin=26.0, width=2 * _WIDTH)
    parts = [outline_rings(geometry, frame), _edges(mesh, frame(mesh.positions_m), "grid")]
    points = dict(zip(nodes, frame(mesh.positions_m), strict=True))
    for node in responses:
        x, y = points[node]
        parts.append(f'<circle class="sensor" cx="{x:.1f}" cy="{y:.1f}" r="4.5"/>')
        parts.append(f'<text x="{x:.1f}" y="{y - 8:.1f}">{node}</text>')
    for node in drives:
        x, y = points[node]
        parts.append(f'<path class="drive" d="M{x:.1f} {y - 8:.1f}l7 13h-14z"/>')
        parts.append(f'<text class="drive-label" x="{x + 11:.1f}" y="{y + 5:.1f}">{node}</text>')
    title = "Plan view of the response points and drive points"
    return svg_element("".join(parts), frame.height, title, width=2 * _WIDTH)


def shape_nodes(geometry: Geometry, model: ModalModel) -> tuple[int, ...]:
    """The nodes of a model's translations that the geometry can place, in order of first appearance."""
    known = set(geometry.nodes)
    return tuple(dict.fromkeys(d.node for d in model.dofs if d.node in known and not d.direction.is_rotation))


class Frame:
    """An orthographic projection that fits some points (N, 3) into a drawing's width."""

    def __init__(
        self, projection: NDArray[np.float64], points_m: NDArray[np.float64], margin: float, width: float = _WIDTH
    ) -> None:
        self.projection = projection
        flat = points_m @ projection.T
        low, high = flat.min(axis=0), flat.max(axis=0)
        size = np.maximum(high - low, 1e-9)
        self.scale = float(min((width - 2 * margin) / size[0], (0.8 * width) / size[1]))
        left = (width - self.scale * size[0]) / 2
        self.offset = np.array([left, margin]) - self.scale * low
        self.height = float(self.scale * size[1] + 2 * margin)

    def __call__(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(self.scale * (points_m @ self.projection.T) + self.offset)


def _extent(geometry: Geometry, mesh: Mesh) -> NDArray[np.float64]:
    return np.vstack([mesh.positions_m, *(np.asarray(line).reshape(-1, 3) for line in geometry.outline_m)])


def _plan_view(geometry: Geometry, mesh: Mesh, vectors: NDArray[np.complex128], span: float) -> tuple[str, float]:
    frame = Frame(TOP, _extent(geometry, mesh), margin=12.0)
    points = frame(mesh.positions_m)
    level = vectors[:, main_axis(vectors)].real
    parts = [outline_rings(geometry, frame), _edges(mesh, points, "grid")]
    for (x, y), value in zip(points, level, strict=True):
        sign = "positive" if value >= 0 else "negative"
        radius = 1.2 + 7.5 * np.sqrt(abs(value))
        parts.append(f'<circle class="{sign}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>')
        if abs(value) > 0.12:
            stroke = f"M{x - 2.5:.1f} {y:.1f}h5" + (f"M{x:.1f} {y - 2.5:.1f}v5" if value >= 0 else "")
            parts.append(f'<path class="sign" d="{stroke}"/>')
    return "".join(parts), frame.height


def _oblique_view(
    geometry: Geometry,
    mesh: Mesh,
    vectors: NDArray[np.complex128],
    other: NDArray[np.complex128] | None,
    span: float,
) -> tuple[str, float]:
    scale = _DEFLECTION_SHARE * span
    moved = mesh.positions_m + scale * vectors.real
    everything = np.vstack([_extent(geometry, mesh), moved])
    frame = Frame(_OBLIQUE, everything, margin=12.0)
    rest, points = frame(mesh.positions_m), frame(moved)
    level = vectors[:, main_axis(vectors)].real
    parts = [outline_rings(geometry, frame)]
    parts += [_line(a, b, "stem") for a, b in zip(rest, points, strict=True)]
    parts += [_face(points[list(face)], float(level[list(face)].mean())) for face in mesh.faces]
    if other is not None:
        parts.append(_edges(mesh, frame(mesh.positions_m + scale * other.real), "reference"))
    parts.append(_edges(mesh, points, "shape"))
    parts += [f'<circle class="point" cx="{x:.1f}" cy="{y:.1f}" r="2"/>' for x, y in points]
    return "".join(parts), frame.height


def outline_rings(geometry: Geometry, frame: Frame) -> str:
    """The aircraft's outline as polygons of class ``outline``."""
    rings = (frame(np.asarray(line).reshape(-1, 3)) for line in geometry.outline_m)
    return "".join(f'<polygon class="outline" points="{_points(ring)}"/>' for ring in rings)


def _edges(mesh: Mesh, points: NDArray[np.float64], css: str) -> str:
    path = "".join(
        f"M{points[a, 0]:.1f} {points[a, 1]:.1f}L{points[b, 0]:.1f} {points[b, 1]:.1f}" for a, b in mesh.edges
    )
    return f'<path class="{css}" d="{path}"/>' if path else ""


def _face(points: NDArray[np.float64], level: float) -> str:
    colour = POSITIVE_COLOUR if level >= 0 else NEGATIVE_COLOUR
    return f'<polygon points="{_points(points)}" fill="{colour}" fill-opacity="{0.1 + 0.6 * abs(level):.2f}"/>'


def _line(start: NDArray[np.float64], end: NDArray[np.float64], css: str) -> str:
    return f'<line class="{css}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}"/>'


def _points(points: Iterable[NDArray[np.float64]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def svg_element(body: str, height: float, title: str, width: float = _WIDTH) -> str:
    """A drawing of class ``drawing`` with its title for those who cannot see it."""
    label = html.escape(title, quote=True)
    return (
        f'<svg class="drawing" viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{label}">'
        f"<title>{label}</title>{body}</svg>"
    )
