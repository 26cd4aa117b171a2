"""A free force is pushed where it is said to be, on whatever aircraft a run has."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.mechanics.response import accelerances
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.simulation import simulated_campaign


def test_a_force_is_found_where_it_acts_though_runs_have_different_joints(tmp_path: Path) -> None:
    """A root that creeps from the second run on has joints there that the first run's aircraft has not."""
    scenario = without_instrument_noise(roving_scenario())
    case = make_problem(simulated_campaign(scenario, engine="linear"), scenario, lines=100, cache=tmp_path)
    creep = Hypothesis(available_effects()["root-creep"], {"shape": "step", "from_run": 2})
    u, e = np.zeros(case.size), creep.scores({"bending": 0.02, "torsion": 0.02})
    here = anchor(case, u, (creep,), e)
    first, *others = here.assembled
    assert others
    assert all(len(group.structure.joints) > len(first.structure.joints) for group in others)
    omega = 2 * np.pi * case.measured.frequency_hz
    pushed = np.zeros(case.measured.values.shape, dtype=complex)
    (point,) = (p for p in first.plan.grid if p.dof.node == 13)
    for group, reduced in zip(here.assembled, here.groups, strict=True):
        row = group.structure.axis[group.structure.places.index(point.site)]
        wide = np.concatenate([row, np.zeros(reduced.basis.shape[0] - row.size)])
        moved = replace(reduced.matrices, drive=reduced.basis.T @ wide, spare=np.zeros_like(reduced.matrices.spare))
        loads = tuple(reduced.masses_kg[r] if reduced.roving else np.zeros(r.size) for r in reduced.runs)
        pushed[reduced.channels] = accelerances(moved, omega, reduced.runs, loads)
    stated = here.predict(u, e)
    force = 0.05 * np.exp(1j * omega / 11)
    missed = replace(case, measured=replace(case.measured, values=stated + here.chain(u, e) * pushed * force))
    found = localise(fit(missed, (creep,), u, e, ()))
    assert found.places[0].label == f"force at {point.dof}"
    assert found.places[0].explained > 0.95
    # What one channel has a free force explains from anywhere.
    alone = np.arange(missed.split.train.size) == int(np.flatnonzero(missed.split.train)[0])
    single = replace(missed, split=replace(missed.split, train=alone))
    assert localise(fit(single, (creep,), u, e, ())).places == ()
    # And what one point has, however often it was measured.
    again = tuple(replace(c, dof=case.measured.channels[0].dof) for c in missed.measured.channels)
    often = replace(missed, measured=replace(missed.measured, channels=again))
    asked = SimpleNamespace(problem=often, chi2_per_dof=1.0)
    assert localise(asked).places == ()  # type: ignore[arg-type]
