"""Where to push to see torsion: ``python docs/studies/torsion_drive_point.py [SEEDS]`` fills torsion-drive-point.md."""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from command_line import BEGIN_AGAIN, parser_of_seeds, whole_number, worked_off
from numpy.typing import NDArray
from virtual_lab import IMAGES, PAGES, reduced_hati, save_figure, share_interval, table, with_fields, write_results

from vgvt.data import ModeStatus
from vgvt.identification import make_identifier
from vgvt.scenario import Scenario
from vgvt.simulation import simulate, truth_of
from vgvt_scoreboard import score

BAND_HZ = (3.0, 60.0)
TORSION = ("1st antisymmetric torsion", "1st symmetric torsion")
# Full level pushes with 3.9 N; at the weak one torsion is close to what the noise hides.
FULL_V, WEAK_V = 1.0, 0.01
# Least rise of a peak over its saddle that the identifier takes for a mode: its default, and nearly a shoulder.
PICKED_DB, SHOULDER_DB = 1.0, 0.2
SEEDS = 20


@dataclass(frozen=True, slots=True)
class DrivePoint:
    """A place for the shaker; ``twin_wings`` removes the few grams between left and right."""

    name: str
    x_m: float
    y_m: float
    part: str = "body"
    twin_wings: bool = False


DRIVE_POINTS = (
    DrivePoint("plane of symmetry, root of the axis", 0.395, 0.0),
    DrivePoint("plane of symmetry, centre of gravity", 0.6005, 0.0),
    DrivePoint("plane of symmetry, 28 in (hati-symmetric)", 0.7112, 0.0),
    DrivePoint("the same, left and right wing equal", 0.7112, 0.0, twin_wings=True),
    DrivePoint("4.5 in right, on the axis", 0.44125, 0.1143),
    DrivePoint("4.5 in right, 25 in (hati-unsymmetric)", 0.635, 0.1143),
    DrivePoint("wing at y = 0.9 m, on the axis", 0.7595, 0.9, "wing-right"),
    DrivePoint("wing at y = 0.9 m, 0.1 m aft of it", 0.8595, 0.8595, "wing-right"),
)


def scenario_at(point: DrivePoint, amplitude_v: float = FULL_V) -> Scenario:
    """The reduced Hati shaken there up to 60 Hz; modes above 35 Hz have 1 % damping, so that peaks stand apart."""
    scenario = reduced_hati(*BAND_HZ, cells=8)
    airframe = scenario.airframe
    damping = airframe.damping.model_copy(update={"limit_hz": 70.0, "modal": (0.011, 0.013, 0.016, 0.01, 0.01, 0.01)})
    airframe = airframe.model_copy(update={"damping": damping})
    if point.twin_wings:
        right = {item.name: item for item in airframe.item if item.name.endswith("-right")}
        # What stands on the left becomes the mirror image of what stands on the right.
        items = tuple(
            item.model_copy(
                update={
                    "mass_kg": twin.mass_kg,
                    "inertia_kg_m2": twin.inertia_kg_m2,
                    "position_m": (twin.position_m[0], -twin.position_m[1], twin.position_m[2]),
                }
            )
            if item.name.endswith("-left") and (twin := right[item.name.replace("-left", "-right")])
            else item
            for item in airframe.item
        )
        airframe = airframe.model_copy(update={"item": items})
        hook = (scenario.suspension.hook_m[0], 0.0, scenario.suspension.hook_m[2])
        scenario = with_fields(scenario, "suspension", hook_m=hook)
    scenario = scenario.model_copy(update={"airframe": airframe})
    scenario = with_fields(scenario, "shaker", position_m=(point.x_m, point.y_m, 0.0), attached_to=point.part)
    return with_fields(scenario, "excitation", amplitude_v=amplitude_v)


def distance_from_axis_m(x_m: float, y_m: float) -> float:
    """Distance of a point from the elastic axis, positive aft; the centre body's axis is [public] as the wing's."""
    knots = np.array([[0.395, 0.0], [0.4735, 0.194], [0.545606, 0.372], [0.987964, 1.464]])
    point = np.array([x_m, abs(y_m)])
    best, signed = np.inf, 0.0
    for a, b in itertools.pairwise(knots):
        along = (b - a) / np.linalg.norm(b - a)
        part = np.clip((point - a) @ along, 0, np.linalg.norm(b - a))
        offset = point - (a + part * along)
        if np.linalg.norm(offset) < best:
            best = float(np.linalg.norm(offset))
            signed = best if offset[0] > 0 else -best
    return signed


def limits_hz(scenario: Scenario) -> dict[str, float]:
    """Smallest possible standard deviation of the torsion modes' natural frequency: the truth's bound."""
    modes = truth_of(scenario).as_tested[0]
    limit = modes.natural_frequency_std_hz
    if limit is None:
        raise RuntimeError("the truth states no bound")
    return {name: float(limit[modes.labels.index(name)]) for name in TORSION}


def found(scenario: Scenario, seeds: range, prominence_db: float = PICKED_DB) -> dict[str, int]:
    """In how many repetitions the quadrature identifier's claim is paired with each torsion mode."""
    return _found_with(scenario, seeds, (prominence_db,))[prominence_db]


def _found_with(scenario: Scenario, seeds: range, prominences_db: tuple[float, ...]) -> dict[float, dict[str, int]]:
    hits = {prominence: dict.fromkeys(TORSION, 0) for prominence in prominences_db}
    for seed in seeds:
        result = simulate(scenario.model_copy(update={"seed": seed}))
        for prominence, counts in hits.items():
            claim = make_identifier("quadrature", prominence_db=prominence).identify(result.campaign, BAND_HZ)
            for row in score(result.truth, claim, BAND_HZ).modes:
                if row.label in counts and row.status is ModeStatus.FOUND:
                    counts[row.label] += 1
    return hits


def results(seeds: int) -> str:
    """The table of the page."""
    rows = []
    for point in DRIVE_POINTS:
        full = scenario_at(point)
        limit = limits_hz(full)
        cells = [point.name, f"{1e3 * distance_from_axis_m(point.x_m, point.y_m):+.0f}"]
        cells += [f"{1e3 * limit[name]:.3g}" if limit[name] < 1e3 else "no information" for name in TORSION]
        for level, prominences in ((FULL_V, (PICKED_DB, SHOULDER_DB)), (WEAK_V, (PICKED_DB,))):
            hits = _found_with(scenario_at(point, level), range(seeds), prominences)
            cells += [_rate(counts[name], seeds) for counts in hits.values() for name in TORSION]
        rows.append(cells)
    head = ("drive point", "off the axis, mm", "bound anti, mHz", "bound sym, mHz")
    for condition in ("3.9 N, 1 dB", "3.9 N, 0.2 dB", "39 mN, 1 dB"):
        head += (f"anti, {condition}", f"sym, {condition}")
    intro = (
        f"{seeds} seeds a point and level. The last six columns: share of the seeds in which the mode was found, with"
    )
    return f"{intro}\nits 95 % interval, by force and by the least prominence of a peak.\n\n{table(head, rows)}"


def _rate(hits: int, trials: int) -> str:
    low, high = share_interval(hits, trials)
    return f"{hits}/{trials} ({100 * low:.0f}–{100 * high:.0f} %)"


def along_the_body() -> tuple[NDArray[np.float64], dict[float, dict[str, NDArray[np.float64]]]]:
    """Bounds at full level for drive points along the body, on its plane of symmetry and 4.5 in right."""
    x = np.linspace(0.36, 0.76, 41)
    curves = {}
    for y in (0.0, 0.1143):
        limits = [limits_hz(scenario_at(DrivePoint("", float(place), y))) for place in x]
        curves[y] = {name: np.array([limit[name] for limit in limits]) for name in TORSION}
    return x, curves


def picture() -> None:
    """The bound of both torsion modes against the drive point's place."""
    x, curves = along_the_body()
    figure, axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    for y, style in ((0.0, "--"), (0.1143, "-")):
        for name, colour in zip(TORSION, ("tab:red", "tab:blue"), strict=True):
            label = f"{name.removeprefix('1st ')}, y = {y:g} m"
            axes.semilogy(x, 1e3 * curves[y][name], style, color=colour, label=label)
    axes.set(xlabel="drive point aft of the nose in m", ylabel="bound on std(f) in mHz")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    save_figure(figure, IMAGES / "study-torsion-drive-point.svg")
    plt.close(figure)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    return parser_of_seeds(__doc__, whole_number(1), SEEDS, "a point and level").parse_args(words)


def fill(count: int) -> None:
    """Measure, and fill the page and its figure."""
    write_results(PAGES / "torsion-drive-point.md", results(count))
    picture()


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: fill(given.seeds), BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
