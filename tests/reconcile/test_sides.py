"""What a parameter changes, kept for an aircraft on which one effect more hangs, against that taken there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.added_mass import AddedMass
from vgvt.reconcile.prediction.sides import sides_of, widened
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.scenario import Scenario


@dataclass(frozen=True, slots=True)
class HeavierOnce(AddedMass):
    """A lump that somebody had left on the aircraft in the second run."""

    def act(self, scenario: Scenario, run: int) -> Action:
        return super(HeavierOnce, self).act(scenario, run) if run == 1 else NOTHING


MASS = Hypothesis(available_effects()["added-mass"], {"x_m": 0.4, "y_m": 0.3})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The small scenario with sensors that rove in four runs."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=80, cache=tmp_path_factory.mktemp("cache"))


def fixed(name: str, **settings: Any) -> Hypothesis:
    return Hypothesis(available_effects()[name], settings)


@pytest.mark.parametrize(
    "beside",
    [
        fixed("local-absorber", x_m=0.4, y_m=-0.5, mass_kg=0.02, frequency_hz=6.0, damping_ratio=0.05),
        fixed("root-compliance", side="both", bending=0.05, torsion=0.05),
        fixed("payload-change", from_run=2, mass_kg=0.1, x_m=0.4, y_m=0.0),
    ],
    ids=lambda h: h.name,
)
def test_what_hangs_beside_it_leaves_what_it_changes_as_it_was(case: Problem, beside: Hypothesis) -> None:
    u, e = np.zeros(case.size), MASS.scores({"mass_kg": 0.05})
    alone = anchor(case, u, (MASS,), e)
    sides = sides_of(alone.structures, u, (MASS,), e, alone.assembled)
    joined = (MASS, beside)
    own = anchor(case, u, joined, e)
    kept = anchor(case, u, joined, e, sides=sides)
    wanted, found = own.slopes()[len(case.unknowns) :], kept.slopes()[len(case.unknowns) :]
    # On a wing whose root gives way a mass moves a little further.
    assert np.linalg.norm(found - wanted) < 0.06 * np.linalg.norm(wanted)
    # And it is that, not nothing: what the mass does to the bare aircraft is another change of A/F.
    bare = alone.slopes()[len(case.unknowns) :]
    assert np.linalg.norm(found - wanted) < 0.2 * np.linalg.norm(bare - wanted)


def test_where_its_coordinates_are_gone_nothing_is_kept(case: Problem) -> None:
    u, e = np.zeros(case.size), MASS.scores({"mass_kg": 0.05})
    absorber = fixed("local-absorber", x_m=0.4, y_m=-0.5, mass_kg=0.02, frequency_hz=6.0, damping_ratio=0.05)
    wide = anchor(case, u, (MASS, absorber), e)
    sides = sides_of(wide.structures, u, (MASS, absorber), e, wide.assembled)
    bare = anchor(case, u, (MASS,), e)
    assert widened(sides, bare.assembled) is None
    assert len(sides) == 1


@pytest.mark.parametrize(("last", "from_run"), [(0, 3), (1, 3), (0, 4), (1, 4)])
def test_runs_that_effects_part_in_another_order_have_their_own_slopes(case: Problem, last: int, from_run: int) -> None:
    """One acts in the second run alone, one from a later on: the order of the runs hangs on which is added last.

    From the fourth on parts have as many channels as each other, and nothing but a slope tells one from another.
    """
    once = Hypothesis(HeavierOnce, {"x_m": 0.4, "y_m": -0.3})
    later = Hypothesis(available_effects()["payload-change"], {"from_run": from_run, "x_m": 0.4, "y_m": 0.3})
    joined = (later, once) if last else (once, later)
    u, e = np.zeros(case.size), np.concatenate([h.scores({"mass_kg": 0.05}) for h in joined])
    found = anchor(case, u, joined, e).slopes()[len(case.unknowns) :]
    for k, step in enumerate(0.01 * np.eye(e.size)):
        ahead, behind = (anchor(case, u, joined, e + side * step, slopes=False).mechanical(u, e + side * step)
                         for side in (1, -1))  # fmt: skip
        wanted = (ahead - behind) / 0.02
        assert np.linalg.norm(found[k] - wanted) < 0.15 * np.linalg.norm(wanted)
