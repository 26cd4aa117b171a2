"""Do unequal wings split Sköll's first bending in two? The paper's explanation, tried: a table of paper-tables.md."""

from __future__ import annotations

import numpy as np
from paper_claims import SPLIT_HZ
from virtual_lab import table

from vgvt.data import ModalModel
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt_scoreboard import merge_truth

TEST = "skoll-gvt2"
"""The second test on Sköll, which was made to part the two modes."""
ASYMMETRIES = (0.0, 0.05, 0.1, 0.15, -0.15, 0.2, 0.45)
"""Parts by which the right wing's EI is higher and the left one's lower; the effect's own range ends at 0.15."""
TIPS = ("9+Z", "19+Z")
"""The outermost forward accelerometer, right and left."""


def with_unequal_wings(asymmetry: float) -> Scenario:
    """The second test on Sköll with (1 + a) of EI on the right and (1 - a) on the left."""
    scenario = load_scenario(TEST)
    if asymmetry == 0:
        return scenario
    effect = EffectTable.model_validate({"name": "stiffness-asymmetry", "bending": asymmetry})
    return scenario.model_copy(update={"effect": (*scenario.effect, effect)})


def elastic_modes(asymmetry: float) -> ModalModel:
    """The modes as tested above 3 Hz, where the sweep begins and all rigid ones are below: averages over the runs."""
    scenario = with_unequal_wings(asymmetry)
    return merge_truth(truth_of(scenario)).model.band(scenario.excitation.band_hz[0], np.inf)


def unequal_wings() -> str:
    """The table: how many modes the sweep passes, the first two, and how unevenly the tips move in either."""
    stop_hz = load_scenario(TEST).excitation.band_hz[1]
    rows = []
    for asymmetry in ASYMMETRIES:
        modes = elastic_modes(asymmetry)
        right, left = ([str(d) for d in modes.dofs].index(tip) for tip in TIPS)
        uneven = [f"{abs(shape[right] / shape[left]):.2f}" for shape in modes.shapes[:2]]
        hertz = [f"{f:.3f}" for f in modes.natural_frequency_hz[:2]]
        passed = int((modes.natural_frequency_hz <= stop_hz).sum())
        rows.append([f"{asymmetry:+.2f}", str(passed), hertz[0], uneven[0], hertz[1], uneven[1]])
    rows.append(["*the paper's two*", "2", f"{SPLIT_HZ[0]:.2f}", "", f"{SPLIT_HZ[1]:.2f}", ""])
    head = ("asymmetry of EI", f"modes from 3 to {stop_hz:g} Hz", "first, Hz", "right tip / left tip")
    return table((*head, "second, Hz", "right tip / left tip"), rows)
