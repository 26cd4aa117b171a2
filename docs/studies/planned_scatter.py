"""Does the scatter of simulated campaigns meet the plan's prediction? Noise drawn anew, the poles fitted each time.

The fit is told the noise (``vgvt.planning.informed``); with ``--identifier`` it is a registered method, told nothing,
on campaigns simulated as ``vgvt plan`` does it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from command_line import (
    file,
    identifier_named,
    made,
    parser_of,
    raise_if_asked,
    scenario_named,
    whole_number,
    worked_off,
)
from numpy.typing import NDArray

from vgvt.planning.budget import Budget
from vgvt.planning.confirmation import claims
from vgvt.planning.informed import INFORMED
from vgvt.planning.prediction import predict
from vgvt.planning.proposal import RIGID, elastic, proposal
from vgvt.scenario import Scenario


def estimates(scenario: Scenario, first: int, last: int, identifier: str = INFORMED) -> Iterator[NDArray[np.float64]]:
    """Frequencies and damping ratios (2, M) of one campaign after the other."""
    expected = predict(scenario)
    plan = proposal("plan", scenario, Budget(20.0, 20), elastic(expected), prediction=expected)
    return claims(plan, identifier, range(first, last))


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; ``scenario`` is the one that is named."""
    parser = parser_of(__doc__)
    parser.add_argument("scenario", type=scenario_named, help="a plan's TOML file, or a bundled scenario")
    said = "campaigns FIRST to LAST - 1, two at least (0 50)"
    parser.add_argument("--seeds", type=whole_number(0), nargs=2, default=(0, 50), metavar=("FIRST", "LAST"), help=said)
    said = "a registered method in place of the informed fit"
    parser.add_argument("--identifier", type=_method, default=INFORMED, metavar="METHOD", help=said)
    parser.add_argument("--out", type=file, default=Path("planned-scatter.jsonl"), help="file that lines are added to")
    given = parser.parse_args(words)
    if given.seeds[1] - given.seeds[0] < 2:
        parser.error("argument --seeds: a scatter needs two campaigns: write LAST as FIRST + 2 or more, like 0 50")
    return given


def _method(text: str) -> str:
    return text if text == INFORMED else identifier_named(text)


def go_on(given: argparse.Namespace) -> None:
    """Write one JSON line per campaign, then print the ratios of scatter to prediction."""
    scenario, (first, last) = given.scenario, given.seeds
    modes = [m for m in predict(scenario).modes if m.label not in RIGID]
    predicted = np.array([[m.frequency_std_hz for m in modes], [m.damping_ratio_std for m in modes]])
    rows = []
    made(given.out.parent)
    with given.out.open("a", encoding="utf-8") as lines:
        for row in estimates(scenario, first, last, given.identifier):
            rows.append(row)
            lines.write(json.dumps(row.tolist()) + "\n")
            lines.flush()
            raise_if_asked()
    ratio = np.nanstd(rows, axis=0, ddof=1) / predicted
    print(f"{len(rows)} campaigns, each ratio known to {100 / np.sqrt(2 * (len(rows) - 1)):.0f} %")  # noqa: T201
    print("frequency", ratio[0].round(3), "damping", ratio[1].round(3))  # noqa: T201
    print("found", np.isfinite(np.array(rows)[:, 0]).sum(axis=0), "predicted", *predicted)  # noqa: T201


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    kept = f"{given.out} has a line of every campaign that is done; --seeds FIRST LAST can begin with the next"
    return worked_off(lambda: go_on(given), kept)


if __name__ == "__main__":
    sys.exit(main())
