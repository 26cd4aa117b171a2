"""Every effect has a small scenario of its own, and its records differ from the clean ones as the effect says."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.cli import main
from vgvt.data import InputError, Record
from vgvt.effects import Family, available_effects
from vgvt.scenario import Scenario, bundled_scenarios, load_scenario, spoiled_scenarios
from vgvt.scenario.library import library_folder
from vgvt.simulation import SimulationResult, simulate, truth_of

OWN = {name: cls for name, cls in available_effects().items() if cls.__module__.startswith("vgvt.effects.")}
BAND_HZ = (3.0, 58.0)
TOP_HZ = 60.0
SHOWS = 5e-4
# One of each way to show, quick to simulate; the others are slow.
REPRESENTATIVE = (
    "channel-delay",
    "clipping-range",
    "local-absorber",
    "loose-sensor-mount",
    "run-drift",
    "stinger-compliance",
    "suspension-damping",
)
IN_THE_FORCE_S_PATH = (
    "force-distortion",
    "mount-compliance",
    "mount-creep",
    "mount-lift-off",
    "shaker-backlash",
    "stinger-compliance",
)
ONE_SENSOR = {
    "channel-gain": (0, 2),
    "loose-sensor-mount": (0,),
    "sensor-position-error": (0,),
    "sign-flip": (1,),
    "swapped-sensors": (0, 2),
}
MORE_MODES = {
    "carry-through-torsion": 1,
    "control-surface": 1,
    "control-surface-freeplay": 1,
    "frame-resonance": 1,
    "local-absorber": 1,
    "suspension-surge": 6,
}
HARMONICS = (
    "clipping-range",
    "control-surface-freeplay",
    "force-distortion",
    "mount-lift-off",
    "rattling-mass",
    "shaker-backlash",
)
POLES_STAY = (
    "aliased-interference",
    "anti-alias-delay",
    "channel-delay",
    "channel-gain",
    "clipping-range",
    "clock-skew",
    "dropped-samples",
    "force-distortion",
    "gain-drift",
    "high-pass-mismatch",
    "loose-sensor-mount",
    "mains-hum",
    "quantisation",
    "sensor-tilt",
    "sign-flip",
    "swapped-sensors",
    "transverse-sensitivity",
)


load = lru_cache(maxsize=None)(load_scenario)
"""Loaded once: most of these tests want the words."""


@lru_cache(maxsize=2)
def flown(scenario: Scenario) -> SimulationResult:
    return simulate(scenario)


def spoiled(effect: str) -> SimulationResult:
    return flown(load(f"spoiled-{effect}"))


def clean(effect: str) -> SimulationResult:
    """The same without its effect; one result for all that share the base's tables."""
    whole = load(f"spoiled-{effect}")
    return _without_words(whole.model_copy(update={"effect": (), "name": "clean", "summary": "", "lesson": ""}))


@lru_cache(maxsize=2)
def _without_words(scenario: Scenario) -> SimulationResult:
    return simulate(scenario)


def frf(record: Record, reference: int = 1) -> NDArray[np.complex128]:
    """Responses over the force (1) or the command (0) in the band, (sensors, lines)."""
    frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
    inside = (frequency > BAND_HZ[0]) & (frequency < BAND_HZ[1])
    spectra = np.fft.rfft(record.samples, axis=1)[:, inside]
    return np.asarray(spectra[2:] / spectra[reference])


def change(effect: str, run: int = -1, reference: int = 1) -> NDArray[np.float64]:
    """Relative change of each sensor's FRF in a run, (sensors,)."""
    got, wanted = (frf(r.campaign.runs[run], reference) for r in (spoiled(effect), clean(effect)))
    return np.asarray(np.linalg.norm(got - wanted, axis=1) / np.linalg.norm(wanted, axis=1))


def poles(result: SimulationResult, run: int = -1) -> NDArray[np.complex128]:
    """True poles as tested below the top of the sweep, over 2π."""
    modes = result.truth.as_tested[run]
    frequency, ratio = modes.natural_frequency_hz, modes.damping_ratio
    return np.asarray((frequency * (-ratio + 1j * np.sqrt(1 - ratio**2)))[frequency < TOP_HZ])


def above_the_sweep(result: SimulationResult) -> float:
    """Root mean square of the responses above the sweep, over that of all."""
    record = result.campaign.runs[-1]
    frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
    power = np.abs(np.fft.rfft(record.samples[2:], axis=1)) ** 2
    return float(np.sqrt(power[:, frequency > TOP_HZ + 5].sum() / power.sum()))


def it_shows(effect: str) -> None:
    largest = max(change(effect, reference=reference).max() for reference in (0, 1))
    assert largest > SHOWS


def response_over_force_stays(effect: str) -> None:
    """The force's path: what the gauge measures holds it, the command does not."""
    assert change(effect, reference=0).min() > 0.1
    assert change(effect).max() < 0.1 * change(effect, reference=0).min()


def one_sensor_shows_it(effect: str) -> None:
    """The named sensors change, the others at most by a fifth of that: a misplaced sensor takes its mass along."""
    rows = change(effect)
    named = list(ONE_SENSOR[effect])
    others = [k for k in range(rows.size) if k not in named]
    assert rows[named].min() > 0.1
    assert rows[others].max() < 0.2 * rows[named].min()


def later_runs_show_it(effect: str) -> None:
    """The first run is what it was, the last is not; per command where the force sees it, too."""
    reference = 0 if effect in IN_THE_FORCE_S_PATH else 1
    assert change(effect, 0, reference).max() < 1e-9
    assert change(effect, -1, reference).min() > 0.05


def there_are_more_modes(effect: str) -> None:
    assert poles(spoiled(effect)).size == poles(clean(effect)).size + MORE_MODES[effect]


def there_are_harmonics(effect: str) -> None:
    """Ten times as much above the sweep as the clean test has there."""
    assert above_the_sweep(spoiled(effect)) > 10 * above_the_sweep(clean(effect))


def the_first_peak_rises(effect: str) -> None:
    """A joint that hardens has its first bending 2 % higher, or more, at this level."""
    frequency = np.fft.rfftfreq(clean(effect).campaign.runs[-1].samples.shape[1], 1 / 500.0)
    inside = frequency[(frequency > BAND_HZ[0]) & (frequency < BAND_HZ[1])]
    first = inside < 12.0
    got, wanted = (
        inside[first][np.abs(frf(r.campaign.runs[-1])[0, first]).argmax()] for r in (spoiled(effect), clean(effect))
    )
    assert got > 1.02 * wanted


def poles_stay(effect: str) -> None:
    """The record is wrong and the aircraft is not."""
    np.testing.assert_allclose(poles(spoiled(effect)), poles(clean(effect)), rtol=1e-9)


def even_more_than_odd(effect: str) -> None:
    """A lift-off bends the force to one side: the second harmonic of a slow sweep outweighs the third."""
    record = spoiled(effect).campaign.runs[-1]
    time = np.arange(record.samples.shape[1]) / record.sample_rate_hz
    rate = (60.0 - 2.0) / 20.0
    phase = 2 * np.pi * (2.0 * time + 0.5 * rate * time**2)
    window = np.hanning(time.size) * (time < 20.0)
    second, third = (abs(np.sum(window * record.samples[1] * np.exp(-1j * k * phase))) for k in (2, 3))
    assert second > 3 * third


def checks_of(effect: str) -> list[Callable[[str], None]]:
    """The signatures that are quick to measure, for one effect."""
    chosen: list[tuple[bool, Callable[[str], None]]] = [
        (True, it_shows),
        (effect in IN_THE_FORCE_S_PATH, response_over_force_stays),
        (effect in ONE_SENSOR, one_sensor_shows_it),
        (OWN[effect].family is Family.BETWEEN_RUNS, later_runs_show_it),
        (effect in MORE_MODES, there_are_more_modes),
        (effect in HARMONICS, there_are_harmonics),
        (effect in POLES_STAY, poles_stay),
        (effect == "cubic-root-stiffness", the_first_peak_rises),
        (effect == "mount-lift-off", even_more_than_odd),
    ]
    return [check for wanted, check in chosen if wanted]


def cases() -> list[object]:
    marks = {True: (), False: pytest.mark.slow}
    return [
        pytest.param(check, effect, id=f"{effect}-{check.__name__}", marks=marks[effect in REPRESENTATIVE])
        for effect in OWN
        for check in checks_of(effect)
    ]


@pytest.mark.parametrize(("check", "effect"), cases())
def test_the_spoiled_record_shows_its_signature(check: Callable[[str], None], effect: str) -> None:
    check(effect)


def test_every_effect_has_a_spoiled_scenario_with_that_effect_alone() -> None:
    assert set(spoiled_scenarios()) == {f"spoiled-{name}" for name in (*OWN, "base")}
    assert not set(spoiled_scenarios()) & set(bundled_scenarios())
    for name in spoiled_scenarios():
        scenario = load(name)
        assert scenario.name == name
        assert len(scenario.summary) > 20
        assert len(scenario.lesson) > 40
        wanted = [] if name == "spoiled-base" else [name.removeprefix("spoiled-")]
        assert [table.name for table in scenario.effect] == wanted


def test_nonlinear_ones_are_stepped_where_the_structure_is_nonlinear() -> None:
    """The linear engine would leave them clean; those that act on command and channels alone do without."""
    outside = ("aliased-interference", "force-distortion", "clipping-range", "mains-hum", "quantisation")
    for name, effect in OWN.items():
        engine = load(f"spoiled-{name}").simulation.engine
        assert engine == ("linear" if effect.linear or name in outside else "mujoco"), name


def test_the_catalogue_states_lessons_and_true_modes() -> None:
    """The table in scenarios/README.md says what the files say, and the base's modes to the last digit given."""
    rows = [
        [cell.strip(" `") for cell in line.strip("|").split("|")]
        for line in (library_folder() / "README.md").read_text(encoding="utf-8").splitlines()
        if line.startswith("| ")
    ]
    lessons = {row[0]: row[2] for row in rows if row[0].startswith("spoiled-")}
    assert lessons == {name: " ".join(load(name).lesson.split()) for name in spoiled_scenarios()}
    families = {row[0].removeprefix("spoiled-"): row[1] for row in rows if row[0].startswith("spoiled-")}
    assert {name: families[name] for name in OWN} == {name: str(cls.family) for name, cls in OWN.items()}
    bare = truth_of(load("spoiled-base")).bare
    stated = {row[0]: row[1:] for row in rows if row[0] in bare.labels and len(row) == 3 and row[2].endswith("%")}
    below = [k for k, f in enumerate(bare.natural_frequency_hz) if f < TOP_HZ]
    assert stated == {
        bare.labels[k]: [f"{bare.natural_frequency_hz[k]:.2f}", f"{100 * bare.damping_ratio[k]:.1f} %"] for k in below
    }


def test_nothing_is_wrong_with_the_base() -> None:
    """Both runs agree to the last bit, and every mode in the band is one of the aircraft's own."""
    result = flown(load("spoiled-base"))
    first, second = result.campaign.runs
    np.testing.assert_array_equal(first.samples, second.samples)
    assert not first.overloaded
    assert sum("bending" in label or "torsion" in label for label in result.truth.as_tested[0].labels[:12]) == 6


def test_the_list_keeps_them_apart(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """The default list counts them in one line; an option lists them, with their effects."""
    monkeypatch.setattr("vgvt.scenario.spoiled_scenarios", lambda: ("spoiled-added-mass", "spoiled-base"))
    monkeypatch.setattr("vgvt.scenario.bundled_scenarios", lambda: ("quick",))
    assert main(["list", "scenarios"]) == 0
    said = capsys.readouterr().out
    assert "2 small ones" in said
    assert "spoiled-added-mass" not in said
    assert main(["list", "scenarios", "--spoiled", "--json"]) == 0
    items = {item["name"]: item["effects"] for item in json.loads(capsys.readouterr().out)["items"]}
    assert items == {"spoiled-added-mass": ["added-mass"], "spoiled-base": []}


def test_a_misspelt_one_is_guessed() -> None:
    with pytest.raises(InputError, match="spoiled-added-mass"):
        load_scenario("spoiled-aded-mass")
