"""Where to put things: the aircraft from above with its shaker, accelerometers and hook, as one SVG."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario import Beam, Scenario, SensorPoint, expanded_beams, outlines_m, sensor_points
from vgvt.view.theme import FONT, NEGATIVE_COLOUR, POSITIVE_COLOUR, TRUTH_COLOUR

INCH_M = 0.0254
_WIDTH, _MARGIN, _FOOT = 960.0, 44.0, 58.0
_RADIUS = 9.0
_RUN_COLOURS = (NEGATIVE_COLOUR, "#7B61C4", "#A3541B", "#56616d", "#B0307A")


def plan_drawing(scenario: Scenario, title: str) -> str:
    """Plan view, nose up, right wing on the right: numbered accelerometers coloured by run, shaker, hook, a scale."""
    outlines, points = outlines_m(scenario.airframe), sensor_points(scenario)
    measured = _measured(scenario, points)
    places = [np.array(p.position_m) for p, _ in measured] + [np.array(scenario.shaker.position_m)]
    beams = [np.array(beam.stations.position_m) for beam in expanded_beams(scenario.airframe)]
    everything = np.vstack([*outlines, *beams, np.array(places), np.array([scenario.suspension.hook_m])])
    frame = _Frame(everything)
    several = len(scenario.acquisition.runs) > 1
    parts = [_bare_beam(beam, frame) for beam in expanded_beams(scenario.airframe) if not _has_edges(beam)]
    parts += [_outline(outline, frame) for outline in outlines]
    parts += [_hook(scenario, frame), _shaker(scenario, frame)]
    parts += [_sensor(p, run, frame, several) for p, run in measured]
    parts += [_nose(everything, frame), _foot(scenario, frame)]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:.0f} {frame.height:.0f}" role="img" '
        f'aria-label="{html.escape(title)}" font-family="{html.escape(FONT)}" font-size="12">'
        f"<title>{html.escape(title)}</title>{''.join(parts)}</svg>"
    )


def run_colour(run: int) -> str:
    """The colour of a run's accelerometers, counted from 0; they repeat, the run's number stands in the table."""
    return _RUN_COLOURS[run % len(_RUN_COLOURS)]


class _Frame:
    """Aircraft axes to the drawing's: right is right, the nose is up."""

    def __init__(self, points_m: NDArray[np.float64]) -> None:
        low, high = points_m[:, :2].min(axis=0), points_m[:, :2].max(axis=0)
        size = np.maximum(high - low, 1e-6)
        # No taller than wide: a page has room for other things.
        self.scale = float(min((_WIDTH - 2 * _MARGIN) / size[1], 0.46 * _WIDTH / size[0]))
        self.left = _WIDTH / 2 - self.scale * (low[1] + high[1]) / 2
        self.top = _MARGIN - self.scale * low[0]
        self.bottom = float(self.top + self.scale * high[0])
        self.height = self.bottom + _FOOT

    def __call__(self, position_m: Sequence[float] | NDArray[np.float64]) -> tuple[float, float]:
        return self.left + self.scale * float(position_m[1]), self.top + self.scale * float(position_m[0])


def _measured(scenario: Scenario, points: tuple[SensorPoint, ...]) -> list[tuple[SensorPoint, int]]:
    first = {node: k for k, run in reversed(list(enumerate(scenario.acquisition.runs))) for node in run}
    return [(p, first[p.dof.node]) for p in points if p.dof.node in first]


def _outline(outline: NDArray[np.float64], frame: _Frame) -> str:
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(frame, outline))
    return f'<polygon points="{corners}" fill="#e9ecf0" stroke="#59626d" stroke-width="1.2" stroke-linejoin="round"/>'


def _sensor(point: SensorPoint, run: int, frame: _Frame, several: bool) -> str:
    x, y = frame(point.position_m)
    colour = run_colour(run) if several else NEGATIVE_COLOUR
    return (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{_RADIUS}" fill="{colour}" stroke="#fff" stroke-width="1.2"/>'
        f'<text x="{x:.1f}" y="{y + 3.4:.1f}" text-anchor="middle" fill="#fff" font-size="9.5" '
        f'font-weight="600">{point.dof.node}</text>'
    )


def _has_edges(beam: Beam) -> bool:
    return beam.stations.forward_edge_m is not None or beam.stations.aft_edge_m is not None


def _bare_beam(beam: Beam, frame: _Frame) -> str:
    """A beam without a planform, as a bar along its axis."""
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(frame, beam.stations.position_m))
    return (
        f'<polyline points="{corners}" fill="none" stroke="#59626d" stroke-width="15" stroke-linecap="round"/>'
        f'<polyline points="{corners}" fill="none" stroke="#e9ecf0" stroke-width="12.6" stroke-linecap="round"/>'
    )


def _shaker(scenario: Scenario, frame: _Frame) -> str:
    x, y = frame(scenario.shaker.position_m)
    return f'<path d="M{x:.1f} {y - 5:.1f}l14 24h-28z" fill="{POSITIVE_COLOUR}" stroke="#fff" stroke-width="1.5"/>'


def _hook(scenario: Scenario, frame: _Frame) -> str:
    x, y = frame(scenario.suspension.hook_m)
    return (
        f'<path d="M{x - 8:.1f} {y:.1f}h16M{x:.1f} {y - 8:.1f}v16" stroke="{TRUTH_COLOUR}" stroke-width="3.5"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5.5" fill="none" stroke="{TRUTH_COLOUR}" stroke-width="2"/>'
    )


def _nose(points_m: NDArray[np.float64], frame: _Frame) -> str:
    x, y = frame((float(points_m[:, 0].min()), 0.0))
    return f'<text x="{x:.1f}" y="{y - 10:.1f}" text-anchor="middle" fill="#59626d">nose (x = 0 is the datum)</text>'


def _foot(scenario: Scenario, frame: _Frame) -> str:
    """Legend and scale below the aircraft."""
    y = frame.bottom + 34
    step = next(s for s in (5.0, 2.0, 1.0, 0.5, 0.2, 0.1) if s * frame.scale <= 0.2 * _WIDTH or s == 0.1)
    length, end = step * frame.scale, _WIDTH - _MARGIN
    words = "accelerometers, a colour a run" if len(scenario.acquisition.runs) > 1 else "accelerometers"
    x, aside = (c / INCH_M for c in scenario.shaker.position_m[:2])
    side = "on the centre line" if abs(aside) < 0.05 else f"{abs(aside):.1f} in {'right' if aside > 0 else 'left'}"
    return (
        f'<circle cx="{_MARGIN + 8:.1f}" cy="{y - 4:.1f}" r="7" fill="{NEGATIVE_COLOUR}"/>'
        f'<text x="{_MARGIN + 22:.1f}" y="{y:.1f}">{words}</text>'
        f'<path d="M{_MARGIN + 228:.1f} {y - 12:.1f}l8 14h-16z" fill="{POSITIVE_COLOUR}"/>'
        f'<text x="{_MARGIN + 242:.1f}" y="{y:.1f}" font-weight="600">shaker, pushing up: {x:.1f} in aft, {side}</text>'
        f'<path d="M{_MARGIN + 548:.1f} {y - 4:.1f}h16m-8 -8v16" stroke="{TRUTH_COLOUR}" stroke-width="3.5"/>'
        f'<text x="{_MARGIN + 572:.1f}" y="{y:.1f}">hook of the suspension</text>'
        f'<path d="M{end - length:.1f} {y - 9:.1f}v8h{length:.1f}v-8" fill="none" stroke="#1b1f24" '
        f'stroke-width="1.3"/><text x="{end - length / 2:.1f}" y="{y - 7:.1f}" text-anchor="middle">'
        f"{step:g} m = {step / INCH_M:.1f} in</text>"
    )
