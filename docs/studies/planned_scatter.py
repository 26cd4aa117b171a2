"""Does the scatter of simulated campaigns meet the plan's prediction? Noise drawn anew, the poles fitted each time.

The fit is told the noise (``vgvt.planning.informed``); with ``--identifier`` it is a registered method, told nothing,
on campaigns simulated as ``vgvt plan`` does it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.budget import Budget
from vgvt.planning.confirmation import claims
from vgvt.planning.informed import INFORMED
from vgvt.planning.prediction import predict
from vgvt.planning.proposal import RIGID, elastic, proposal
from vgvt.scenario import Scenario, load_scenario


def estimates(scenario: Scenario, first: int, last: int, identifier: str = INFORMED) -> Iterator[NDArray[np.float64]]:
    """Frequencies and damping ratios (2, M) of one campaign after the other."""
    expected = predict(scenario)
    plan = proposal("plan", scenario, Budget(20.0, 20), elastic(expected), prediction=expected)
    return claims(plan, identifier, range(first, last))


def main() -> None:
    """Write one JSON line per campaign, then print the ratios of scatter to prediction."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenario", help="a plan's TOML file, or a bundled scenario")
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 50), metavar=("FIRST", "LAST"))
    parser.add_argument("--identifier", default=INFORMED, help="a registered method in place of the informed fit")
    parser.add_argument("--out", type=Path, default=Path("planned-scatter.jsonl"))
    given = parser.parse_args()
    scenario, (first, last) = load_scenario(given.scenario), given.seeds
    modes = [m for m in predict(scenario).modes if m.label not in RIGID]
    predicted = np.array([[m.frequency_std_hz for m in modes], [m.damping_ratio_std for m in modes]])
    rows = []
    with given.out.open("a", encoding="utf-8") as lines:
        for row in estimates(scenario, first, last, given.identifier):
            rows.append(row)
            lines.write(json.dumps(row.tolist()) + "\n")
            lines.flush()
    ratio = np.nanstd(rows, axis=0, ddof=1) / predicted
    print(f"{len(rows)} campaigns, each ratio known to {100 / np.sqrt(2 * (len(rows) - 1)):.0f} %")  # noqa: T201
    print("frequency", ratio[0].round(3), "damping", ratio[1].round(3))  # noqa: T201
    print("found", np.isfinite(np.array(rows)[:, 0]).sum(axis=0), "predicted", *predicted)  # noqa: T201


if __name__ == "__main__":
    main()
