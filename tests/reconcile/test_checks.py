"""Readings off the rig: what each instrument shows of each effect, and what that tells of two explanations."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, check, claimed, roving_problem, roving_scenario, small_scenario

from vgvt.effects import available_effects
from vgvt.effects.conformance import switched_on
from vgvt.effects.registry import effects_of
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import TO_THE_END, fit
from vgvt.reconcile.next_test import suggest as suggesting
from vgvt.reconcile.next_test.checks import _aircraft_kg, checks, foretold, seen
from vgvt.reconcile.next_test.procedures import lab_minutes
from vgvt.reconcile.next_test.with_reading import counted_law, reading_density, reading_nats
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.scenario import load_scenario

# The package's lazy name of the same spelling is the function.


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=60)


def shown(case: Problem, words: str, name: str, **values: Any) -> np.ndarray:
    """How a reading changes with an effect."""
    read, scenario = check(case, words).read, case.scenario
    return np.asarray(read(seen(scenario, [available_effects()[name](**values)])) - read(seen(scenario, [])))


def test_each_instrument_shows_what_it_measures(case: Problem) -> None:
    runs, first = case.measured.runs, case.measured.runs[0]
    assert shown(case, "tape where the hook", "hook-offset", aft_m=0.02, up_m=0.1) == pytest.approx([0.02, 0, 0.1])
    assert shown(case, "tape where the shaker", "drive-point-offset", dx_m=0.01, dy_m=-0.02) == pytest.approx(
        [0.01, -0.02]
    )
    assert shown(case, "known mass on the spring", "suspension-stiffness", stiffness_change=0.1) == pytest.approx(
        [np.log(1.1)]
    )
    assert shown(case, "weigh an accelerometer", "roving-sensor-mass", mass_kg=0.004) == pytest.approx([0.004])
    assert shown(case, "weigh the force transducer", "transducer-mass", mass_kg=0.02) == pytest.approx([0.02])
    for axis, reads in (("roll", [3.0, 0.0]), ("pitch", [0.0, 3.0])):
        felt = shown(
            case, "off the force transducer's axis", "base-strain", apparent_force_per_moment_per_m=3.0,
            rotational_stiffness_n_m_per_rad=10.0, axis=axis,
        )  # fmt: skip
        assert felt == pytest.approx(reads)
    stiff = shown(case, "off the force transducer's axis", "stinger-moment", rotational_stiffness_n_m_per_rad=9.0)
    assert stiff == pytest.approx([0.0, 0.0])
    assert shown(case, "weigh the aircraft", "added-mass", mass_kg=0.05) == pytest.approx([0.05, 0.05])
    warming = shown(case, "log the temperature of the structure", "temperature-change", warming_k=3.0)
    assert warming == pytest.approx(np.linspace(0, 3.0, len(runs)))
    # Of runs that are over nobody reads it: it takes as long as they do.
    logged = next(c for c in checks(case) if "thermistor" in c.words)
    assert logged.minutes > lab_minutes(case) > len(runs) * case.scenario.excitation.whole_s / 60
    moved = shown(case, "tape where every sensor", "sensor-position-error", dx_m=0.03, node=first[1]).reshape(-1, 2)
    assert [tuple(m) for m in moved if m.any()] == [pytest.approx((0.03, 0.0))] * sum(first[1] in r for r in runs)
    swapped = shown(case, "tape where every sensor", "swapped-sensors", node=first[0], other_node=first[1])
    apart = swapped.reshape(-1, 2)
    assert np.any(apart[0]) and apart[0] == pytest.approx(-apart[1])
    lean = shown(case, "level to every sensor", "sensor-tilt", angle_rad=0.05, azimuth_rad=0.0).reshape(-1, 3)
    assert lean == pytest.approx(np.tile([np.sin(0.05), 0.0, np.cos(0.05) - 1], (len(lean), 1)))
    assert not shown(case, "level to every sensor", "transverse-sensitivity", fraction=0.05).any()
    across = shown(
        case, "across its axis", "transverse-sensitivity", fraction=0.05, azimuth_rad=0.0, sensors="sensor-2"
    )
    assert across.reshape(-1, 3) == pytest.approx(np.outer(np.arange(5) == 1, [0.05, 0.0, 0.0]))
    assert not shown(case, "across its axis", "sensor-tilt", angle_rad=0.05).any()
    push = shown(case, "level to the stinger", "lateral-force", angle_rad=0.05, azimuth_rad=0.0)
    assert push[0] == pytest.approx(np.sin(0.05))


def test_what_an_absorber_weighs_is_on_the_scale_and_what_the_spring_weighs_is_not(case: Problem) -> None:
    absorber = shown(case, "weigh the aircraft", "local-absorber", mass_kg=0.05, frequency_hz=12.0)
    assert absorber == pytest.approx([0.05, 0.05])
    assert not shown(case, "weigh the aircraft", "suspension-surge", mass_kg=0.5).any()


@pytest.mark.parametrize(("name", "beam"), [("hati-unsymmetric", ""), ("garteur-sm-ag19", "wing")])
def test_air_hangs_on_no_scale(name: str, beam: str) -> None:
    """It moves with the wing; but it has no weight."""
    scenario = load_scenario(name)
    air = available_effects()["entrained-air"](mass_fraction=1.0, beam=beam)
    plain, moved = (seen(scenario, effects)[0] for effects in ([], [air]))
    tables = [b.stations.air_kg_per_m for b in moved.scenario.airframe.beam if beam in ("", b.name)]
    assert tables and all(table is not None and max(table) > 0.01 for table in tables)
    assert _aircraft_kg(moved) == _aircraft_kg(plain)


def test_a_scale_tells_air_from_a_mass_and_not_from_a_damper(case: Problem) -> None:
    air = claimed(case, "entrained-air", {"mass_fraction": 1.0, "drag_n_s_per_m3": 0.5})
    mass = claimed(case, "added-mass", {"mass_kg": 0.13}, x_m=0.45, y_m=0.0)
    damper = claimed(case, "nonproportional-damper", {"damping_n_s_per_m": 0.5}, x_m=0.9, y_m=1.2)
    scale = check(case, "weigh the aircraft")
    for one, other in ((air, mass), (mass, air)):
        told = reading_nats(one, other, scale)
        assert told is not None and told > stored_thresholds().set_nats
    alike = reading_nats(air, damper, scale)
    assert alike is not None and alike < 0.1


def test_a_split_signal_shows_converters_and_a_reference_sensor_shows_all(case: Problem) -> None:
    """A gain of the sensor is beyond the converter; a filter is seen where its corner is, far above the band."""
    split, beside = "split one noise signal", "reference accelerometer"
    node = case.measured.runs[1][2]
    assert not shown(case, split, "channel-gain", gain_error=0.05, channels=f"{node}+Z").any()
    gain = shown(case, beside, "channel-gain", gain_error=0.05, channels=f"{node}+Z")
    real = gain.reshape(-1, 2, 10)[:, 0]
    channels = [n for nodes in case.measured.runs for n in nodes]
    assert [n for n, row in zip(channels, real, strict=True) if row.any()] == [node] * channels.count(node)
    assert set(np.round(real[real != 0], 9)) == {0.05}
    filtered = check(case, split).read(seen(case.scenario, [available_effects()["anti-alias-delay"](delay_s=1e-3)]))
    size = np.hypot(*np.moveaxis(filtered.reshape(-1, 2, 10), 1, 0))
    assert size[0] == pytest.approx(1.0)
    # The force's input comes first, and each other one is there once, in however many runs it was used.
    assert len(size) == 1 + max(len(nodes) for nodes in case.measured.runs)
    # The fourth order falls by 80 dB in a decade.
    assert size[1, 0] == pytest.approx(1.0, abs=1e-3) and size[1, -1] < 1e-3


def test_more_runs_do_not_make_more_of_one_calibration() -> None:
    """It takes a quarter of an hour, and tells what one does; it had been counted once a run."""
    scenario = small_scenario()
    nodes, told = scenario.acquisition.run_nodes[0], []
    delay = available_effects()["channel-delay"](delay_s=1e-6, channels="force")
    for count in (1, 4):
        acquisition = scenario.acquisition.model_copy(update={"runs": (nodes,) * count, "repeats": 1})
        asked = scenario.model_copy(update={"acquisition": acquisition})
        measured = SimpleNamespace(runs=(nodes,) * count, channels=nodes * count, frequency_hz=np.array([1.0, 40.0]))
        split = check(SimpleNamespace(scenario=asked, measured=measured), "split one noise")  # type: ignore[arg-type]
        moved = split.read(seen(asked, (delay,))) - split.read(seen(asked, ()))
        told.append(0.5 * float(moved @ np.linalg.solve(split.covariance(moved.size), moved)))
    assert told[0] > 10 and told[1] == pytest.approx(told[0], rel=1e-9)


@pytest.mark.parametrize(
    ("name", "values"), [("channel-gain", {"gain_error": 0.05}), ("channel-delay", {"delay_s": 1e-4})]
)
def test_no_accelerometer_beside_the_others_shows_the_force(case: Problem, name: str, values: dict[str, float]) -> None:
    assert shown(case, "reference accelerometer", name, **values, channels="response").any()
    assert not shown(case, "reference accelerometer", name, **values, channels="force").any()


@pytest.mark.parametrize(
    ("true", "other", "words"),
    [
        (("hook-offset", {"aft_m": 0.04}, {}), ("stinger-moment", {}, {}), "where the hook is"),
        pytest.param(
            ("run-drift", {"drift": -0.01}, {}),
            ("temperature-change", {"warming_k": 8.0}, {}),
            "temperature",
            marks=pytest.mark.slow,
        ),
        (("anti-alias-delay", {"delay_s": 5e-4}, {}), ("channel-delay", {"delay_s": 5e-4}, {}), "split one noise"),
        (
            ("base-strain", {"apparent_force_per_moment_per_m": 8.0, "rotational_stiffness_n_m_per_rad": 10.0}, {}),
            ("stinger-moment", {"rotational_stiffness_n_m_per_rad": 5.0}, {}),
            "off the force transducer's axis",
        ),
    ],
)  # fmt: skip
def test_an_instrument_tells_what_no_other_sweep_does(case: Problem, true: Any, other: Any, words: str) -> None:
    one, two = (claimed(case, name, values, **settings) for name, values, settings in (true, other))
    nats = {}
    for c in checks(case):
        both = [reading_nats(a, b, c) for a, b in ((one, two), (two, one))]
        nats[c.words] = min(n for n in both if n is not None)
    best = max(nats, key=lambda w: nats[w])
    assert words in best
    assert nats[best] > stored_thresholds().set_nats


@pytest.mark.parametrize(
    "words", ["weigh an accelerometer", pytest.param("known mass on the spring", marks=pytest.mark.slow)]
)
def test_a_reading_and_a_campaign_fitted_together_are_the_normal_law_where_that_is_straight(
    case: Problem, words: str
) -> None:
    """What a sensor weighs, how stiff the spring is: either way of asking must agree on any reading of it.

    Of the spring the campaign says little, so that the reading is as uncertain as its tolerance.
    """
    scale, hypothesis = check(case, words), Hypothesis(available_effects()["channel-gain"])
    null = calibrate(case)
    found = fit(null.problem, (hypothesis,), null.u, hypothesis.scores({"gain_error": 0.01}), TO_THE_END)
    law = counted_law(found, scale)
    assert law is not None
    for away in (0.0, 1.0, -2.0):
        reading = law.mean + away * np.sqrt(np.diag(law.covariance))
        assert reading_density(found, scale, reading) == pytest.approx(law.density(reading), abs=0.15)


@pytest.mark.slow
def test_a_level_and_a_calibrator_tell_a_sensor_that_leans_from_one_that_feels_across() -> None:
    """To a campaign they are one; but the housing of the one is level, and the other is true on a calibrator."""
    leaning = available_effects()["sensor-tilt"](angle_rad=0.087, azimuth_rad=0.5)
    leant = make_problem(campaign_of(roving_scenario(), 1, leaning), roving_scenario(), lines=60)
    started = (
        ("sensor-tilt", {"angle_rad": 0.087, "azimuth_rad": 0.5}),
        ("transverse-sensitivity", {"fraction": 0.087, "azimuth_rad": 0.5}),
    )
    fits = []
    for name, values in started:
        hypothesis = Hypothesis(available_effects()[name], {"sensors": "response"})
        fits.append(fit(leant, (hypothesis,), np.zeros(leant.size), hypothesis.scores(values), TO_THE_END))
    assert fits[0].chi2 == pytest.approx(fits[1].chi2, abs=10)
    for words in ("level to every sensor", "across its axis"):
        nats = [reading_nats(a, b, check(leant, words)) for a, b in (fits, fits[::-1])]
        assert min(n for n in nats if n is not None) > stored_thresholds().set_nats


def test_what_nothing_moves_is_known_as_well_as_it_is_read(case: Problem) -> None:
    found = claimed(case, "channel-gain", {"gain_error": 0.05})
    law = foretold(found, check(case, "where every sensor sits"))
    assert law is not None
    assert np.allclose(law[1], 0.002**2 * np.eye(law[0].size), atol=1e-12)


@pytest.mark.parametrize(("promised", "found"), [(20.0, 3.0), (60.0, 60.0)])
def test_a_reading_is_followed_to_the_end_unless_it_leaves_no_doubt(
    case: Problem, monkeypatch: pytest.MonkeyPatch, promised: float, found: float
) -> None:
    one = claimed(case, "channel-gain", {"gain_error": 0.05})
    hook = check(case, "where the hook is")
    monkeypatch.setattr(suggesting, "checks", lambda problem: (hook,))
    monkeypatch.setattr(suggesting, "procedures", lambda problem: ())
    monkeypatch.setattr(suggesting, "reading_nats", lambda true, other, check: promised)
    monkeypatch.setattr(suggesting, "followed_nats", lambda true, other, check: 3.0)
    assert [t.nats for t in suggesting.suggest([one, one])] == [found]


@pytest.mark.slow
def test_along_a_bent_valley_a_reading_tells_more_than_the_normal_law_foresees(case: Problem) -> None:
    """Stiffness lost is warming times a coefficient: no warming at all would ask for a coefficient beyond reason."""
    made = available_effects()["run-drift"](drift=-0.01)
    drifted = make_problem(campaign_of(roving_scenario(), 1, made), roving_scenario(), lines=60)
    hypothesis = Hypothesis(available_effects()["temperature-change"], {"shape": "linear"})
    found = fit(drifted, (hypothesis,), np.zeros(case.size), hypothesis.scores({"warming_k": 8.0}), TO_THE_END)
    log = check(drifted, "temperature")
    law = counted_law(found, log)
    assert law is not None
    none = np.zeros(law.mean.size)
    told = reading_density(found, log, none)
    assert told is not None
    assert told < law.density(none) - 10


def test_expected_nats_are_the_mean_over_readings(case: Problem) -> None:
    """Divergence in closed form against readings drawn from what the true explanation foretells."""
    hook = check(case, "where the hook is")
    one = claimed(case, "hook-offset", {"aft_m": 0.01, "up_m": 0.004})
    two = claimed(case, "stinger-moment", {})
    laws = [counted_law(f, hook) for f in (one, two)]
    assert laws[0] is not None and laws[1] is not None
    generator = np.random.default_rng(3)
    readings = generator.multivariate_normal(laws[0].mean, laws[0].covariance, size=4000)
    told = [laws[0].density(r) - laws[1].density(r) for r in readings]
    expected = reading_nats(one, two, hook)
    assert expected is not None
    assert np.mean(told) == pytest.approx(expected, abs=5 * np.std(told) / np.sqrt(len(told)))
    assert expected > 0.2


def test_a_reading_is_no_better_known_than_what_the_campaign_left_open(case: Problem) -> None:
    """The hook's tolerance is a part of what the tape is foretold to show, and so is the effect's own spread."""
    hook, tolerance = check(case, "where the hook is"), case.scenario.tolerances.hook_m
    alone = claimed(case, "channel-gain", {"gain_error": 0.05}, channels="response")
    found = foretold(alone, hook)
    assert found is not None
    sd = np.sqrt(np.diag(found[1]))
    assert (sd > 0.002).all() and (sd <= 1.001 * np.hypot(tolerance, 0.002)).all()
    loose = foretold(claimed(case, "hook-offset", {"aft_m": 0.01}), hook)
    assert loose is not None
    assert np.sqrt(np.diag(loose[1]))[0] > 1.1 * sd[0]


@pytest.mark.parametrize("name", sorted(available_effects()))
def test_every_effect_of_the_catalogue_can_be_read(case: Problem, name: str) -> None:
    made = switched_on(available_effects()[name])
    plain = [c.read(seen(case.scenario, effects_of(case.scenario))) for c in checks(case)]
    for one, before in zip(checks(case), plain, strict=True):
        read = one.read(seen(case.scenario, [made]))
        assert read.shape == before.shape
        assert np.isfinite(read).all()
