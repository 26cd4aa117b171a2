"""The nominal model of the measured campaign stays as it was written down, at the points of the records."""

import hashlib
import json
import re
from copy import deepcopy
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from vgvt.files.open import shipped_sidecar
from vgvt.files.sidecar import Sidecar
from vgvt.files.strict import load_table
from vgvt.reconcile.question.holdout import split
from vgvt.scenario import load_scenario
from vgvt.scenario.inheritance import read_source
from vgvt.scenario.tolerances import Tolerances

STUDIES = Path(__file__).parents[2] / "docs" / "studies"
FULL_SCALES = {("transducer", "range_n"), ("accelerometers", "range_g")}
SCENARIO, PAGE = STUDIES / "hati-measured.toml", STUDIES / "hati-measured-nominal.md"


def test_the_page_names_the_scenario_that_is_there() -> None:
    """The full scales of instruments aside, which came later: a record that they do not end is the same record."""
    stated = deepcopy(read_source(SCENARIO).tables)
    stated.pop("generator", None)
    for table, key in FULL_SCALES:
        stated[table].pop(key, None)
    tables = json.dumps(stated, sort_keys=True)
    written = re.findall(r"^    ([0-9a-f]{64})$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert written == [hashlib.sha256(tables.encode()).hexdigest()]


def test_no_tolerance_is_left_to_a_default_that_may_change() -> None:
    assert set(read_source(SCENARIO).tables["tolerances"]) == set(Tolerances.model_fields)


def test_points_runs_and_drive_are_those_of_the_records() -> None:
    scenario = load_scenario(SCENARIO)
    sidecar = load_table(shipped_sidecar("hati-2015-09-24"), Sidecar)
    measured = dict(zip(sidecar.nodes.node, sidecar.axes.to_aircraft_m(sidecar.nodes.table), strict=True))
    grid = scenario.accelerometers.grid
    for node, x, y in zip(grid.node, grid.x_m, grid.y_m, strict=True):
        assert np.allclose((x, y), measured[node][:2], rtol=0, atol=1e-6)
    assert np.allclose(scenario.shaker.position_m, measured[100], rtol=0, atol=1e-6)
    roving = [tuple(int(run.nodes[name]) for name in ("Accel1", "Accel2")) for run in sidecar.run]
    assert roving == [tuple(run) for run in scenario.acquisition.runs]
    assert {c.direction or c.dof for c in sidecar.channel if c.role.value != "drive"} == {"100+Z", "+Z"}


def test_the_held_out_channels_are_those_of_the_page() -> None:
    scenario = load_scenario(SCENARIO)
    channels = [SimpleNamespace(run=r, node=n) for r, run in enumerate(scenario.acquisition.runs) for n in run]
    everything = SimpleNamespace(channels=channels, used=np.ones(len(channels), dtype=bool))
    parts = split(scenario, everything)  # type: ignore[arg-type]
    runs = sorted({c.run + 1 for c, held in zip(channels, parts.held_runs, strict=True) if held})
    points = [(c.node, c.run + 1) for c, held in zip(channels, parts.held_channels, strict=True) if held]
    (named,) = re.findall(
        r"\*\*runs (\d+) and (\d+) whole, and points (\d+) \(run (\d+)\) and (\d+) \(run (\d+)\)\*\*",
        PAGE.read_text(encoding="utf-8"),
    )
    numbers = [int(n) for n in named]
    assert (runs, points) == (numbers[:2], [(numbers[2], numbers[3]), (numbers[4], numbers[5])])
