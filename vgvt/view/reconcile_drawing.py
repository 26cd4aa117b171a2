"""Where a residual comes from, drawn on the aircraft's outline: an SVG that needs no script and prints well."""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_uppercase

import numpy as np

from vgvt.data import Geometry
from vgvt.view.html_page import escaped
from vgvt.view.reconcile_account import PlaceRow
from vgvt.view.reconcile_wording import share_words
from vgvt.view.shape_drawing import TOP, Frame, outline_rings, svg_element

_WIDTH = 680.0
_MARGIN = 34.0
_LARGEST_PX = 22.0
_LABELLED = 5


def places_drawing(geometry: Geometry, places: Sequence[PlaceRow]) -> str:
    """Plan view with a disc at every place, its area the share explained; empty where no place has a position.

    Diamonds are joints (bending or torsion at a root), discs are forces at points. The best are lettered, by their
    rank among all places: some have no point to be drawn at.
    """
    there = [p for p in places if p.position_m is not None]
    if not there:
        return ""
    at = np.array([p.position_m for p in there], dtype=float)
    everything = np.vstack([at, *(np.asarray(ring, dtype=float).reshape(-1, 3) for ring in geometry.outline_m)])
    frame = Frame(TOP, everything, margin=_MARGIN, width=_WIDTH)
    spots = _spread(frame(at), there)
    parts = [outline_rings(geometry, frame)]
    order = sorted(range(len(there)), key=lambda k: -there[k].explained)
    # Large ones first, so that a small one on top of it stays visible.
    parts += [_mark(there[k], float(spots[k][0]), float(spots[k][1])) for k in order]
    for letter, place in _lettered(places):
        if place in there:
            x, y = spots[there.index(place)]
            parts.append(f'<text class="place-label" x="{x:.1f}" y="{y + 4.5:.1f}">{letter}</text>')
    return svg_element("".join(parts), frame.height, "Share of the residual that each place explains", width=_WIDTH)


def places_key(places: Sequence[PlaceRow]) -> str:
    """What the letters of the drawing stand for, and which of them are not on it."""
    words = [
        f"<b>{letter}</b> {escaped(p.label)}: {share_words(p.explained)}"
        + (" (no point on the map)" if p.position_m is None else "")
        for letter, p in _lettered(places)
    ]
    return f'<p class="note">{"; ".join(words)}.</p>' if words else ""


def _lettered(places: Sequence[PlaceRow]) -> list[tuple[str, PlaceRow]]:
    """The places that explain most, best first, with their letters."""
    best = sorted((p for p in places if p.explained > 0), key=lambda p: -p.explained)
    return list(zip(ascii_uppercase, best[:_LABELLED], strict=False))


def _mark(place: PlaceRow, x: float, y: float) -> str:
    share = min(max(place.explained, 0.0), 1.0)
    radius = 1.8 + (_LARGEST_PX - 1.8) * share**0.5
    title = f"<title>{escaped(place.label)}: {share_words(place.explained)}</title>"
    if "root" in place.label:
        return (
            f'<path class="place" d="M{x:.1f} {y - radius:.1f}l{radius:.1f} {radius:.1f}l{-radius:.1f} {radius:.1f}'
            f'l{-radius:.1f} {-radius:.1f}z">{title}</path>'
        )
    return f'<circle class="place" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}">{title}</circle>'


def _spread(spots: np.ndarray, places: Sequence[PlaceRow]) -> np.ndarray:
    """Moves marks that share a point a little apart, sideways."""
    moved = spots.copy()
    seen: dict[tuple[int, int], int] = {}
    for k in range(len(places)):
        key = (round(float(spots[k, 0])), round(float(spots[k, 1])))
        moved[k, 0] += 16.0 * seen.get(key, 0)
        seen[key] = seen.get(key, 0) + 1
    return moved
