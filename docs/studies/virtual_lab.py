"""What the studies share: a reduced Hati, repetitions with other noise, intervals, tables that land in the page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import scipy.stats
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel
from vgvt.files.atomically import replacing
from vgvt.scenario import Scenario, load_scenario

mpl.use("Agg")
mpl.rcParams.update({"svg.hashsalt": "vgvt", "font.size": 9})

PAGES = Path(__file__).parent
IMAGES = PAGES.parent / "images"
START, END = "<!-- results of the script: start -->", "<!-- results of the script: end -->"
CONFIDENCE = 0.95


def reduced_hati(
    start_hz: float, stop_hz: float, *, duration_s: float = 16.0, cells: int = 6, sample_rate_hz: float = 250.0
) -> Scenario:
    """The bundled scenario ``quick`` with fewer cells, a lower sampling rate and another sweep, solved linearly."""
    scenario = load_scenario("quick")
    beams = tuple(beam.model_copy(update={"cells": cells}) for beam in scenario.airframe.beam)
    sweep = {"start_hz": start_hz, "stop_hz": stop_hz, "duration_s": duration_s, "ring_down_s": 3.0}
    return scenario.model_copy(
        update={
            "airframe": scenario.airframe.model_copy(update={"beam": beams}),
            "acquisition": scenario.acquisition.model_copy(update={"sample_rate_hz": sample_rate_hz}),
            "excitation": scenario.excitation.model_copy(update=sweep),
            "simulation": scenario.simulation.model_copy(update={"engine": "linear"}),
        }
    )


def save_figure(figure: Figure, path: Path, **options: Any) -> None:
    """Draw a figure into a file, which holds the old one until the new one is whole."""
    dated: dict[str, Any] = {"metadata": {"Date": None}} if path.suffix == ".svg" else {}
    with replacing(path) as part:
        figure.savefig(part, format=path.suffix.removeprefix("."), **dated, **options)


def shorten_paths(path: Path) -> None:
    """Two decimals are enough for the lines of a drawing; what scales its letters keeps all of them."""

    def shortened(found: re.Match[str]) -> str:
        return re.sub(r"(\d+\.\d{2})\d+", r"\1", found[0])

    text = path.read_text(encoding="utf-8")
    with replacing(path) as part:
        part.write_text(re.sub(r'\bd="[^"]*"', shortened, text), encoding="utf-8")


def with_fields(scenario: Scenario, table: str, **values: Any) -> Scenario:
    """The scenario with some keys of one of its tables changed."""
    return scenario.model_copy(update={table: getattr(scenario, table).model_copy(update=values)})


def nearest(modes: ModalModel, frequency_hz: float, within: float = 0.05) -> int | None:
    """Index of the mode nearest to a frequency; None if it is further away than the part ``within`` of it."""
    if not len(modes):
        return None
    k = int(np.argmin(np.abs(modes.natural_frequency_hz - frequency_hz)))
    return k if abs(modes.natural_frequency_hz[k] / frequency_hz - 1) < within else None


def deviation_ratio(wide: NDArray[np.float64], narrow: NDArray[np.float64]) -> tuple[float, float, float]:
    """Ratio of two independent samples' standard deviations with its F interval: (ratio, low, high)."""
    ratio = float(np.std(wide, ddof=1) / np.std(narrow, ddof=1))
    tail = (1 - CONFIDENCE) / 2
    upper, lower = scipy.stats.f.ppf([1 - tail, tail], wide.size - 1, narrow.size - 1)
    return ratio, ratio / float(np.sqrt(upper)), ratio / float(np.sqrt(lower))


def mean_interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """Mean and half width of its Student interval."""
    t = scipy.stats.t.ppf((1 + CONFIDENCE) / 2, values.size - 1)
    return float(values.mean()), float(t * values.std(ddof=1) / np.sqrt(values.size))


def share_interval(hits: int, trials: int) -> tuple[float, float]:
    """Clopper-Pearson interval of a rate."""
    interval = scipy.stats.binomtest(hits, trials).proportion_ci(CONFIDENCE, "exact")
    return float(interval.low), float(interval.high)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def write_results(page: Path, text: str, of: str = "of the script") -> None:
    """Replace what stands between the two marks of a page, or of a part of it; InputError where a mark is gone."""
    start, end = (mark.replace("of the script", of) for mark in (START, END))
    old = page.read_text(encoding="utf-8")
    if old.count(start) != 1 or old.count(end) != 1 or old.index(end) < old.index(start):
        raise InputError(str(page), "has no one place for the results", f"write {start} and, below it, {end}")
    before, after = old.split(start)[0], old.split(end)[1]
    with replacing(page) as part:
        part.write_text(f"{before}{start}\n\n{text}\n\n{end}{after}", encoding="utf-8")
