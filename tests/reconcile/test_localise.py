"""A free force is pushed where it is said to be, on whatever aircraft a run has."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from reconciled_case import claimed, problem, roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.localise import Localisation, _least, _Rest, interface_type, localise
from vgvt.reconcile.evidence.whole_airframe import WHOLE
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


@pytest.fixture(scope="module")
def soft_root(tmp_path_factory: pytest.TempPathFactory) -> Localisation:
    """Where the stated scenario misses an aircraft whose right root gives way."""
    case = problem(tmp_path_factory.mktemp("root"), 1)
    values = claimed(case, "root-compliance", {"bending": 0.1, "torsion": 0.0001}, side="right").predicted
    missed = replace(case, measured=replace(case.measured, values=values))
    return localise(fit(missed, (), np.zeros(case.size), np.zeros(0), ()))


def test_what_is_the_same_everywhere_is_no_force_at_a_point(tmp_path: Path) -> None:
    """A material that loses energy otherwise than modes are said to."""
    case = problem(tmp_path, 1)
    values = claimed(case, "hysteretic-damping", {"loss_factor": 0.02}).predicted
    missed = replace(case, measured=replace(case.measured, values=values))
    without = fit(missed, (), np.zeros(case.size), np.zeros(0), ())
    found = localise(without)
    best = found.places[0]
    assert (best.label, best.kind, best.position_m) == (WHOLE, "airframe", None)
    assert best.explained > 0.99 and best.dynamic_stiffness is None
    # At points alone, as a search asks, something leaves several times as much.
    points = localise(without, everywhere=False)
    assert {p.label for p in points.places} == {p.label for p in found.places} - {WHOLE}
    assert 1 - points.places[0].explained > 5 * (1 - best.explained)


def test_what_turns_has_a_moment_an_angle_and_their_units(soft_root: Localisation) -> None:
    """A root whose stiffness was "-981 N/m"."""
    turning = {p.label: p for p in soft_root.places if p.turns}
    assert {"bending at the root of wing-right", "torsion at the root of wing-left"} <= set(turning)
    assert {"pitch moment on the centre body", "roll moment on the centre body"} <= set(turning)
    assert soft_root.places[0].label == "bending at the root of wing-right"
    for place in soft_root.places:
        told = {"stiffness": "N/m", "mass": "kg", "damper": "N s/m"}
        if place.turns:
            told = {"stiffness": "N m/rad", "mass": "kg m^2", "damper": "N m s/rad"}
        assert place.unit == (told | {"resonant": "Hz"}).get(place.type, "")
    # What makes it softer is a spring of less than nothing beside it.
    assert soft_root.places[0].type == "stiffness" and soft_root.places[0].size < 0


OMEGA = 2 * np.pi * np.linspace(3.0, 35.0, 160)


def swinging(frequency_hz: float, ratio: float) -> np.ndarray:
    """-z of an absorber of 1 kg."""
    own = 2 * np.pi * frequency_hz
    pole = own**2 + 2j * ratio * own * OMEGA
    return np.asarray(OMEGA**2 * pole / (pole - OMEGA**2))


@pytest.mark.parametrize("frequency_hz", [3.2, 8.04, 20.0, 34.0])
@pytest.mark.parametrize("ratio", [0.005, 0.03, 0.08])
def test_a_mass_but_for_a_trace_is_a_mass_and_what_swings_is_found(frequency_hz: float, ratio: float) -> None:
    """3 in 10 000 of the force's power a pole's: data are good enough to fit it, and it is still a mass."""
    first = 2 * np.pi * 15.0
    motion = 1 / (first**2 - OMEGA**2 + 0.04j * first * OMEGA)
    mass, pole = 0.05 * OMEGA**2 * motion, swinging(frequency_hz, ratio) * motion
    trace = np.sqrt(3e-4) * np.linalg.norm(mass) / np.linalg.norm(pole)
    told = interface_type(OMEGA, mass + trace * pole, motion, np.ones_like(OMEGA))
    assert told[0] == "mass" and told[1] == pytest.approx(0.05, rel=0.05) and told[2] == "kg"
    kind, size, unit = interface_type(OMEGA, 0.05 * pole, motion, np.ones_like(OMEGA))
    assert (kind, unit) == ("resonant", "Hz") and size == pytest.approx(frequency_hz, rel=0.02)


def test_what_a_free_force_leaves_is_what_is_left_off_its_direction() -> None:
    g = np.random.default_rng(4)
    rho, direction = (g.standard_normal((5, 30)) + 1j * g.standard_normal((5, 30)) for _ in range(2))
    direction[:, 7] = 0.0
    tangent = 40 * (g.standard_normal((5, 30, 6)) + 1j * g.standard_normal((5, 30, 6)))
    scores = g.standard_normal(6)
    power = np.sum(np.abs(direction) ** 2, axis=0)
    unit = direction / np.sqrt(np.where(power > 0, power, 1.0))
    r = (rho - unit * np.sum(unit.conj() * rho, axis=0)).ravel()
    t = (tangent - unit[:, :, None] * np.einsum("cl,clp->lp", unit.conj(), tangent)[None]).reshape(-1, 6)
    stacked = np.concatenate([t.real, t.imag, np.sqrt(0.5) * np.eye(6)])
    target = np.concatenate([r.real, r.imag, np.sqrt(0.5) * scores])
    left = target - stacked @ np.linalg.lstsq(stacked, target, rcond=None)[0]
    found = _Rest.of(rho, tangent, scores).least(direction)
    assert found == pytest.approx(float(left @ left), rel=1e-10)


def test_many_least_squares_are_each_by_itself() -> None:
    g = np.random.default_rng(5)
    columns, target = g.standard_normal((7, 40, 4)) * [1.0, 1e3, 1e-3, 5.0], g.standard_normal(40)
    sizes, lefts = _least(columns, target)
    for k, own in enumerate(columns):
        amounts = np.linalg.lstsq(own, target, rcond=None)[0]
        assert np.allclose(sizes[k], amounts, rtol=1e-8)
        assert lefts[k] == pytest.approx(float(np.sum((target - own @ amounts) ** 2)), rel=1e-9)
