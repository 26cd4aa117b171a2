"""Draw every effect with and without, and write the page of them: ``python docs/make_effect_figures.py [EFFECT ...]``.

Left of every picture is response over force at the sensor that the effect changes most; right is
where the effect shows best. Both come from the effect's spoiled scenario, the clean curve
from the same scenario with its effects taken out.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tomllib
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from effect_panels import CLEAN, SPOILED, Pair, draw_panel, panel_of
from numpy.typing import NDArray
from studies.command_line import BEGIN_AGAIN, one_of, parser_of, raise_if_asked, worked_off
from studies.kept_documents import read_kept

from vgvt.bench.executors import at_work, leave_with_parent
from vgvt.effects import Family, available_effects
from vgvt.files.atomically import replacing
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate
from vgvt.simulation.campaign import SimulationResult

DOCS = Path(__file__).parent
SPOILED_SCENARIOS = DOCS.parent / "scenarios" / "spoiled"
IMAGES = DOCS / "images" / "effects"
CHANGES = IMAGES / "changes.json"
PAGE = DOCS / "reference" / "effect-gallery.md"
UNSEEN = 0.01
"""Relative change of A/F below which an effect counts as unseen."""

_HEAD = """# Every effect, with and without

Written by `python docs/make_effect_figures.py` from `scenarios/spoiled/`; edit those, not this page.

Each picture is a simulated test with one effect (red) over the same test without it (grey). Left: response over
force, A/F, at the sensor that changes most, in the last run. Right: where the effect shows best. The change of A/F in
per cent is the norm of the difference over the norm, along the swept band. Where it is below one per cent the
caption says so: an effect that leaves no trace in A/F can only be found elsewhere, and does little harm to what is
identified from A/F. What each effect is, its numbers and the test that tells it from others: [the effects](effects.md).
"""


def spoiled_scenarios() -> dict[str, Path]:
    """The spoiled scenario of every effect that comes with vgvt, by the effect's name."""
    found: dict[str, Path] = {}
    for path in sorted(SPOILED_SCENARIOS.glob("*.toml")):
        tables = tomllib.loads(path.read_text(encoding="utf-8")).get("effect", [])
        for table in tables:
            # A scenario named after the effect wins over one that merely has it.
            if table["name"] not in found or path.stem == table["name"]:
                found[table["name"]] = path
    own = {n for n, cls in available_effects().items() if cls.__module__.startswith("vgvt.effects.")}
    return {name: path for name, path in found.items() if name in own}


def pair_of(effect: str, path: Path) -> Pair:
    """The scenario with its effect and without, simulated, at other levels too where the panel asks for them."""
    spoiled = load_scenario(path)
    quiet = tuple(simulate(_at(spoiled, share)) for share in panel_of(effect).quieter)
    return Pair(spoiled, simulate(spoiled), _clean(_without_effects(spoiled).model_dump_json()), quiet)


def _without_effects(scenario: Scenario) -> Scenario:
    return scenario.model_copy(update={"effect": (), "name": "clean", "summary": "clean", "lesson": "clean"})


@lru_cache(maxsize=8)
def _clean(document: str) -> SimulationResult:
    return simulate(Scenario.model_validate_json(document))


def _at(scenario: Scenario, share: float) -> Scenario:
    excitation = scenario.excitation
    update = {"amplitude_v": share * excitation.amplitude_v}
    return scenario.model_copy(update={"excitation": excitation.model_copy(update=update)})


@at_work()
def draw(effect: str, path: Path, folder: Path) -> float:
    """Write FOLDER/EFFECT.png; returns the relative change of A/F at the sensor that changes most."""
    pair = pair_of(effect, path)
    frequency, clean, spoiled = pair.accelerance()
    change = _change(clean, spoiled)
    sensor = int(np.argmax(change))
    mpl.rcParams.update({"font.size": 7, "axes.titlesize": 7.5, "axes.linewidth": 0.6, "axes.grid": True})
    mpl.rcParams.update({"grid.alpha": 0.25, "grid.linewidth": 0.5, "lines.linewidth": 0.9})
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 2.25), layout="constrained")
    left.semilogy(frequency, np.abs(clean[sensor]), color=CLEAN, linewidth=1.6, label="without")
    left.semilogy(frequency, np.abs(spoiled[sensor]), color=SPOILED, label="with")
    floor = np.percentile(np.abs(clean[sensor]), 1)
    left.set(
        title=f"|A/F| in (m/s²)/N, sensor {pair.sensor_name(sensor)}",
        xlabel="frequency in Hz",
        ylim=(0.3 * floor, 3 * max(np.abs(clean[sensor]).max(), np.abs(spoiled[sensor]).max())),
        xlim=(frequency[0], frequency[-1]),
    )
    left.legend(loc="lower right", framealpha=0.8)
    draw_panel(right, panel_of(effect), pair, sensor)
    with replacing(folder / f"{effect}.png") as part:
        figure.savefig(part, format="png", dpi=100, metadata={"Software": None}, pil_kwargs={"optimize": True})
    plt.close(figure)
    return float(change.max())


def _change(clean: NDArray[np.complex128], spoiled: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Relative change (sensors,) of each response as a whole: norm of the difference over norm, along the band."""
    return np.asarray(np.linalg.norm(spoiled - clean, axis=1) / np.linalg.norm(clean, axis=1))


def gallery(changes: dict[str, float]) -> str:
    """The page as Markdown, family by family, from the largest change of A/F of every effect."""
    effects: dict[str, Any] = {name: available_effects()[name] for name in changes}
    lines = [_HEAD.rstrip("\n")]
    for family in Family:
        names = sorted(name for name, cls in effects.items() if cls.family is family)
        if names:
            lines += ["", f"## {family.capitalize()}"]
        for name in names:
            lines += ["", f"### [{name}](effects.md#{name})", "", f"![{name}](../images/effects/{name}.png)"]
            lines += ["", _caption(name, effects[name], changes[name])]
    return "\n".join(lines) + "\n"


def _caption(name: str, effect: Any, change: float) -> str:
    share = "nothing" if change < 1e-9 else f"{100 * change:.2g} %"
    signature = f"{effect.signature[0].upper()}{effect.signature[1:]}."
    if change < UNSEEN:
        where = f"**No trace in A/F** ({share}); right: {panel_of(name).says}."
        return f"{signature} {where}"
    return f"{signature} A/F changes by {share}; right: {panel_of(name).says}."


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; ``effects`` are those to draw."""
    parser, names = parser_of(__doc__), list(spoiled_scenarios())
    said = "an effect that comes with vgvt (all of them if nothing is said)"
    parser.add_argument("effects", nargs="*", type=one_of(names), metavar="EFFECT", help=said)
    given = parser.parse_args(words)
    given.effects = given.effects or names
    return given


def fill(names: Sequence[str]) -> None:
    """Draw some effects, and write the page of all that were ever drawn."""
    scenarios = spoiled_scenarios()
    advice = "restore it, or remove it and draw all effects: python docs/make_effect_figures.py"
    kept = read_kept(CHANGES, advice) if CHANGES.exists() else {}
    pool = ProcessPoolExecutor(initializer=leave_with_parent, initargs=(os.getpid(),))
    try:
        drawn = pool.map(draw, names, [scenarios[name] for name in names], [IMAGES] * len(names))
        changes = {}
        for name, change in zip(names, drawn, strict=True):
            raise_if_asked()
            changes[name] = float(f"{change:.3g}")
            sys.stdout.write(f"{name}: A/F changes by {100 * change:.3g} %\n")
            sys.stdout.flush()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    changes = {name: kept[name] for name in scenarios if name in kept} | changes
    with replacing(CHANGES) as part:
        part.write_text(json.dumps(changes, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    with replacing(PAGE) as part:
        part.write_text(gallery(changes), encoding="utf-8")


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: fill(given.effects), BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
