"""What nonlinear joints make of a prediction: their limits at whisper and shout, and MuJoCo's records between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from reconciled_case import small_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.effects.conformance import with_effect
from vgvt.reconcile.mechanics import joints
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question import problem
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import depends_on_level, level_grid, linear_first, several_levels
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.scenario import Scenario
from vgvt.simulation import reduced, simulated_campaign

ROOT = {"root_stiffness_n_m_per_rad": 2000.0, "kind": "bending", "side": "both"}
CUBIC = Hypothesis(available_effects()["cubic-root-stiffness"], {"cubic_n_m_per_rad3": 2e7, **ROOT})
FRICTION = Hypothesis(available_effects()["root-friction"], {"friction_n_m": 0.3, **ROOT})
PLAY = Hypothesis(available_effects()["root-freeplay"], {"gap_rad": 2e-3, **ROOT})
NOTHING = np.zeros(0)


def on_the_left(hypothesis: Hypothesis) -> Hypothesis:
    """The same of one root alone."""
    return replace(hypothesis, settings={**hypothesis.settings, "side": "left"})


def driven(scenario: Scenario, volt: float) -> Scenario:
    """A short sweep over the first two bending modes."""
    sweep = scenario.excitation.model_copy(update={"stop_hz": 19.0, "duration_s": 8.0, "amplitude_v": volt})
    return scenario.model_copy(update={"excitation": sweep})


SCENARIO = driven(without_instrument_noise(small_scenario()), 1.0)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    campaign = simulated_campaign(SCENARIO, engine="linear")
    return make_problem(campaign, SCENARIO, lines=120, cache=tmp_path_factory.mktemp("cache"))


def truth(case: Problem) -> NDArray[np.float64]:
    """Scores of the scenario as stated, cells included."""
    scores = np.zeros(case.size)
    # A bounded amount comes to its end slowly.
    scores[case.unknowns.index(CELLS)] = -10 / CELLS.sd
    return scores


def predicted(case: Problem, hypotheses: tuple[Hypothesis, ...], force: float = 1.0) -> NDArray[np.complex128]:
    """A/F of the scenario as stated with effects, pushed ``force`` times as hard as it was."""
    louder = replace(case, measured=replace(case.measured, pushed=force * case.measured.pushed))
    u = truth(case)
    return anchor(louder, u, hypotheses, NOTHING, slopes=False).predict(u, NOTHING)


def distance(one: NDArray[np.complex128], other: NDArray[np.complex128]) -> float:
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


def test_a_whisper_leaves_the_linear_model(case: Problem) -> None:
    """A cubic joint is its tangent; play stays shut under the wing's weight, sensors included."""
    rigid = predicted(case, ())
    assert distance(rigid, case.measured.values) < 0.03
    for hypothesis in (CUBIC, PLAY):
        effect = hypothesis.cls(**hypothesis.settings)
        wanted = measured_frfs(simulated_campaign(with_effect(SCENARIO, effect), engine="linear"), lines=120)
        same = np.isin(case.measured.lines, wanted.lines)
        there = np.isin(wanted.lines, case.measured.lines)
        held = predicted(case, (hypothesis,), 1e-4)
        assert distance(held[:, same], wanted.values[:, there]) < 0.03
        assert distance(held, rigid) > 0.5


def test_a_whisper_leaves_a_joint_with_friction_stuck(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if nothing could turn it: up to the steps at whose ends it is stopped, and what rings on behind the record."""
    endless = replace(case, measured=replace(case.measured, endings=()))
    u = truth(case)
    free = anchor(endless, u, (FRICTION,), NOTHING, slopes=False)
    (group,) = free.groups
    assert group.levels is not None
    firm = replace(group, levels=replace(group.levels, shown=np.full_like(group.levels.shown, 1e9)))
    held = replace(free, groups=(firm,)).predict(u, NOTHING)
    # The airframe's damping is set with the joint free, so that the rigid root's peaks differ by some percent.
    assert distance(held, predicted(endless, ())) < 0.06
    assert distance(predicted(endless, (FRICTION,), 1e-4), held) < 0.005
    monkeypatch.setattr("vgvt.reconcile.mechanics.run_march._STEPS_OF_CORNERS", 16.0)
    assert distance(predicted(endless, (FRICTION,), 1e-4), held) > 0.02


@pytest.mark.parametrize("hypothesis", [CUBIC, FRICTION, PLAY])
def test_a_joint_that_the_scenario_has_moves_as_one_that_an_effect_makes(case: Problem, hypothesis: Hypothesis) -> None:
    """All of its motion is in the coordinates, as what holds it where it sticks is damped by modes far above."""
    wing = SCENARIO.airframe.beam[0]
    firm = wing.model_copy(update={"root_bending_stiffness_n_m_per_rad": 2000.0})
    airframe = SCENARIO.airframe.model_copy(update={"beam": (firm, *SCENARIO.airframe.beam[1:])})
    stated = SCENARIO.model_copy(update={"airframe": airframe})
    there = make_problem(simulated_campaign(stated, engine="linear"), stated, lines=120)
    for of in (case, there):
        (group,) = anchor(of, truth(of), (hypothesis,), NOTHING, slopes=False).groups
        assert group.levels is not None
        own = group.levels.joints.rows @ np.linalg.solve(group.matrices.stiffness, group.levels.joints.rows.T)
        assert np.abs(group.levels.joints.between).max() < 1e-8 * own.max()


def test_a_shout_leaves_the_slipping_joint(case: Problem) -> None:
    """Friction is nothing against a thousand times the force."""
    slipping = predicted(case, (PLAY,), 1e-4)
    assert distance(predicted(case, (FRICTION,), 1e3), slipping) < 0.01
    assert distance(predicted(case, (FRICTION,)), slipping) > 0.2


def test_slopes_are_those_of_the_prediction(case: Problem) -> None:
    """In an effect's parameters, the whole way through the march."""
    free = Hypothesis(CUBIC.cls, {"kind": "bending", "side": "both"})
    e = free.scores({"cubic_n_m_per_rad3": 2e7, "root_stiffness_n_m_per_rad": 2000.0})
    u = truth(case)
    here = anchor(case, u, (free,), e)
    slopes = here.slopes()[-2:]
    assert distance(here.mechanical(u, e), anchor(case, u, (free,), e, slopes=False).mechanical(u, e)) < 1e-9
    for k in range(2):
        sides = [e + s * 0.02 * np.eye(2)[k] for s in (1, -1)]
        far, near = (anchor(case, u, (free,), x, slopes=False).mechanical(u, x) for x in sides)
        assert distance(slopes[k], (far - near) / 0.04) < 0.01


def test_slopes_in_the_unknowns_hold_what_a_joint_shows(case: Problem) -> None:
    """Against differences of the linearised response, for every unknown at once."""
    u = truth(case)
    # Slopes of what the record's end leaves out are as exact as the poles that fade out of it.
    for ended, most in ((replace(case, measured=replace(case.measured, endings=())), 1e-5), (case, 1e-4)):
        here = anchor(ended, u, (CUBIC,), NOTHING)
        slopes = here.slopes()
        for k in range(len(case.unknowns)):
            aside = 1e-4 * np.eye(u.size)[k]
            wanted = (here.mechanical(u + aside, NOTHING) - here.mechanical(u - aside, NOTHING)) / 2e-4
            # Below a hundredth differences are round-off; what matters is 0.03 to 170.
            assert np.linalg.norm(slopes[k] - wanted) <= most * max(float(np.linalg.norm(wanted)), 0.01)


def in_runs(*runs: tuple[int, ...]) -> Scenario:
    """The scenario with so many sensors a run, whose weight hardly bends the wings."""
    return SCENARIO.model_copy(update={"acquisition": SCENARIO.acquisition.model_copy(update={"runs": runs})})


def test_a_joint_that_stays_shut_rings_on_at_the_end_of_a_record(tmp_path: Path) -> None:
    """As the linear engine has it, but for what sensors weigh on a soft root: the sweep ends while a mode rings."""
    scenario = in_runs((1, 5, 9, 13), (2, 6, 10, 14))
    campaign = simulated_campaign(with_effect(scenario, PLAY.cls(**PLAY.settings)), engine="linear")
    case = make_problem(campaign, scenario, lines=120, cache=tmp_path)
    assert distance(predicted(case, (PLAY,), 1e-4), case.measured.values) < 0.005
    endless = replace(case, measured=replace(case.measured, endings=()))
    assert distance(predicted(endless, (PLAY,), 1e-4), case.measured.values) > 0.008


@pytest.fixture
def weightless(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Structures that hang without sensors: of two runs the mean is not what either has alone."""
    remembered = (problem._hung, problem.assembled_once)
    for module in (reduced, joints):
        monkeypatch.setattr(module, "mean_sensors_kg", lambda scenario: {})
    for function in remembered:
        function.cache_clear()
    yield
    for function in remembered:
        function.cache_clear()


@pytest.mark.usefixtures("weightless")
def test_a_run_among_others_has_its_own_sensors_on(tmp_path: Path) -> None:
    """A joint that works hard answers as if the campaign had that run alone, but for the mean weight."""
    first, second = (1, 5, 9, 13), (2, 6, 10, 14)
    found = []
    for runs in ((first, second), (first,)):
        scenario = in_runs(*runs)
        case = make_problem(simulated_campaign(scenario, engine="linear"), scenario, lines=120, cache=tmp_path)
        found.append(dict(zip(case.measured.lines, predicted(case, (CUBIC,))[: len(first)].T, strict=True)))
    both = sorted(found[0].keys() & found[1].keys())
    among, alone = (np.array([f[line] for line in both]).T for f in found)
    assert len(both) > 30
    assert distance(among, alone) < 5e-4


def test_sensors_weigh_on_a_joint_once(tmp_path: Path) -> None:
    """A soft root that hangs under them answers as the linear engine's does: to a tenth of what their weight does."""
    scenario = in_runs((1, 5, 9, 13))
    campaign = simulated_campaign(with_effect(scenario, CUBIC.cls(**CUBIC.settings)), engine="linear")
    case = make_problem(campaign, scenario, lines=120, cache=tmp_path)
    assert distance(predicted(case, (CUBIC,), 1e-4), case.measured.values) < 5e-4


def test_levels_are_seen_in_the_force(case: Problem) -> None:
    assert not several_levels(case)
    pushed = np.concatenate([case.measured.pushed, 4 * case.measured.pushed])
    assert several_levels(replace(case, measured=replace(case.measured, pushed=pushed)))


def test_a_shorter_sweep_of_one_level_is_no_other_level(case: Problem) -> None:
    """Half as long it has two thirds of the spectrum."""
    excitation = SCENARIO.excitation.model_copy(update={"duration_s": SCENARIO.excitation.duration_s / 2})
    short = simulated_campaign(SCENARIO.model_copy(update={"excitation": excitation}), engine="linear").runs[0]
    whole = simulated_campaign(SCENARIO, engine="linear")
    both = measured_frfs(replace(whole, runs=(whole.runs[0], replace(short, run=2))), lines=120)
    spectrum = np.sqrt(np.mean(np.abs(both.force) ** 2, axis=1))
    assert spectrum[1] < 0.77 * spectrum[0]
    assert both.level_n[1] == pytest.approx(both.level_n[0], rel=0.1)
    assert not several_levels(replace(case, measured=both))


def test_joints_come_second_at_one_level(case: Problem) -> None:
    """There one variant of each is enough; at two levels all are tried with the others."""
    known = available_effects()
    soft = Hypothesis(known["root-compliance"])
    flap = Hypothesis(known["control-surface-freeplay"], {"item": "flap-outer"})
    twice = [Hypothesis(known["root-friction"], {"kind": kind}) for kind in ("bending", "torsion")]
    at_once, later = linear_first(case, [twice[0], soft, twice[1], flap])
    assert at_once == [soft]
    assert later == [twice[0], flap]
    pushed = np.concatenate([case.measured.pushed, 4 * case.measured.pushed])
    two = replace(case, measured=replace(case.measured, pushed=pushed))
    assert linear_first(two, [soft, *twice]) == ([soft, *twice], [])


def test_only_what_the_prediction_knows_is_looked_for_on_a_grid(case: Problem) -> None:
    known = available_effects()
    assert depends_on_level(case, Hypothesis(known["root-friction"], {"kind": "torsion"}))
    assert not depends_on_level(case, Hypothesis(known["root-compliance"]))
    assert not depends_on_level(case, Hypothesis(known["mains-hum"]))
    grid = level_grid(Hypothesis(known["root-friction"], {"kind": "torsion", "side": "left"}))
    assert len({tuple(values.items()) for values in grid}) == len(grid) == 6
    p, q = Hypothesis(known["root-friction"]).parameters
    assert all(p.low < v[p.name] < p.high and q.low < v[q.name] < q.high for v in grid)


@pytest.mark.parametrize(
    ("hypothesis", "volt", "most"),
    [
        (CUBIC, 1.0, 0.006),
        pytest.param(FRICTION, 0.25, 0.08, marks=pytest.mark.slow),
        pytest.param(FRICTION, 1.0, 0.03, marks=pytest.mark.slow),
        pytest.param(PLAY, 2.5, 0.02, marks=pytest.mark.slow),
        pytest.param(on_the_left(FRICTION), 0.25, 0.01, marks=pytest.mark.slow),
        pytest.param(on_the_left(PLAY), 2.5, 0.02, marks=pytest.mark.slow),
    ],
)
def test_predicts_what_mujoco_records(tmp_path: Path, hypothesis: Hypothesis, volt: float, most: float) -> None:
    """The response to a fast sweep, whose amplitudes no steady state has: far nearer than the linear joint's.

    At 2.5 V finite rotations are 1.1 % without any joint.
    """
    scenario = driven(in_runs((1, 5, 9, 13)), volt)
    effect = hypothesis.cls(**hypothesis.settings)
    campaign = simulated_campaign(with_effect(scenario, effect), engine="mujoco")
    case = make_problem(campaign, scenario, lines=120, cache=tmp_path)
    found = distance(predicted(case, (hypothesis,)), case.measured.values)
    level = 1e3 if hypothesis.name == FRICTION.name else 1e-4
    linear = distance(predicted(case, (hypothesis,), level), case.measured.values)
    assert found < most
    assert found < 0.5 * linear


@pytest.mark.slow
@pytest.mark.parametrize(("volt", "least", "most"), [(1.0, 0.0012, 0.0025), (2.5, 0.009, 0.015)])
def test_what_finite_rotation_leaves_without_any_joint(tmp_path: Path, volt: float, least: float, most: float) -> None:
    """What a scenario driven that hard should state as its ``model_form``; it grows with the square of the voltage."""
    scenario = driven(in_runs((1, 5, 9, 13)), volt)
    case = make_problem(simulated_campaign(scenario, engine="mujoco"), scenario, lines=120, cache=tmp_path)
    assert least < distance(predicted(case, ()), case.measured.values) < most
