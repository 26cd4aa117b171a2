"""What nothing that is foretold depends on is not told, as if records had said it: the gap of a loose flap."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.decision.kinds import kind_of
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.decision.verdict import named_effects
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.untold import untold_parameters
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.thresholds import stored_thresholds


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("slopes"), 1)


def begun(case: Problem, *names: str, e: float = 0.0) -> Fit:
    """Effects as they are at scores, beside the stated aircraft."""
    hypotheses = tuple(Hypothesis(available_effects()[name]) for name in names)
    scores = np.full(sum(len(h.parameters) for h in hypotheses), e)
    return fit(case, hypotheses, np.zeros(case.size), scores, ())


@pytest.mark.parametrize(
    ("name", "untold"),
    [
        ("control-surface-freeplay", ("gap_rad",)), ("rattling-mass", ("gap_m",)),
        ("mount-lift-off", ("stiffness_loss", "preload_n")), ("shaker-backlash", ("gap_m", "preload_n")),
        ("control-surface", ()), ("root-compliance", ()), ("root-freeplay", ()), ("channel-delay", ()),
    ],
)  # fmt: skip
def test_what_moves_nothing_is_known(case: Problem, name: str, untold: tuple[str, ...]) -> None:
    """And it does move nothing: the same prediction at either end of what is plausible."""
    found = begun(case, name)
    assert untold_parameters(found, 0) == untold
    names = [p.name for p in found.hypotheses[0].parameters]
    for k, each in enumerate(names):
        ends = [
            fit(case, found.hypotheses, found.u, side * np.eye(len(names))[k], ()).predicted for side in (-1.5, 1.5)
        ]
        moved = np.abs(ends[1] - ends[0]).max() / np.abs(found.predicted).max()
        assert (moved < 1e-6) == (each in untold), (each, moved)


def test_they_are_looked_for_among_those_of_their_own_effect(case: Problem) -> None:
    both = begun(case, "root-compliance", "control-surface-freeplay")
    assert untold_parameters(both, 0) == () and untold_parameters(both, 1) == ("gap_rad",)


def test_the_end_of_what_is_tried_is_no_such_thing(case: Problem) -> None:
    """Far beyond it nothing moves a gain either; that it is at its end is told otherwise."""
    assert untold_parameters(begun(case, "channel-gain", e=40.0), 0) == ()


def test_a_name_has_no_number_that_no_record_told(case: Problem) -> None:
    """The verdict says so, and the gap has neither a value nor an interval."""
    found = begun(case, "control-surface-freeplay")
    hypothesis = found.hypotheses[0]
    winner: Any = SimpleNamespace(
        name=hypothesis.name, hypothesis=hypothesis, gain_nats=90.0, lasting_nats=80.0, held_out=1.0, fit=found
    )
    addition: Any = SimpleNamespace(
        winner=winner, alike=(), equivalent=(winner,), rivals=(winner,), in_its_place=(), held_out_before=2.0
    )
    null = fit(case, (), found.u, np.zeros(0), ())
    limits = stored_thresholds()
    told: Any = SimpleNamespace(
        rounds=(addition,), final=found, null=null, vetoed=(), last_rivals=(), leads=(), led=None, still=None,
        nameless=None, null_residual=residual(null, limits), final_residual=residual(found, limits),
    )  # fmt: skip
    (effect,) = named_effects(told)
    assert set(effect.parameters) == set(effect.ranges) == {"compliance_rad_per_n_m", "arm_m", "damping_ratio"}
    said = reasons_of(kind_of(told), told, limits, None)
    assert "No record told gap_rad of control-surface-freeplay: nothing that is foretold depends on it" in said
