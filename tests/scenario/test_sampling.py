"""What the acquisition cannot sample is refused when the scenario is loaded, not after it was simulated."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import bundled_scenarios, load_scenario, spoiled_scenarios
from vgvt.scenario.sweeps import Axis, sweep

HEAD = 'extends = "quick"\nname = "mine"\nsummary = "A trial."\n'


def loaded(folder: Path, lines: str) -> None:
    path = folder / "mine.toml"
    path.write_text(HEAD + lines, encoding="utf-8")
    load_scenario(path)


@pytest.mark.parametrize(
    ("lines", "key", "problem", "advice"),
    [
        ("[accelerometers]\nhigh_pass_hz = 500.0", "accelerometers.high_pass_hz", "is 500, but", "0 for none"),
        ("[transducer]\nhigh_pass_hz = 700.0", "transducer.high_pass_hz", "below 500 Hz", "far below the 3 Hz"),
        ("[excitation]\nduration_s = 1e-9", "excitation.duration_s", "less than a cycle at 19 Hz", "0.0526 s"),
        (
            '[excitation]\nkind = "burst-random"\nblocks = 4\nburst_fraction = 0.01',
            "excitation.burst_fraction",
            "leaves 0.04 s",
            "0.0526 s",
        ),
        ("[excitation]\nduration_s = 2e8", "excitation.duration_s", "22 channels", "at most 4.55e+04"),
        (
            "[excitation]\nduration_s = 1000000020.0\nunrecorded_s = 1000000000.0",
            "excitation.duration_s",
            "1.76e+05 GB",
            "at most 4.55e+04",
        ),
        (
            "[excitation]\nduration_s = 2.0\nunrecorded_s = 1.9999",
            "excitation.unrecorded_s",
            "leaves 0.0001 s",
            "cycle",
        ),
        ("[acquisition]\nrepeats = 1000000000000", "acquisition.repeats", "8 GB", "2525 times at most"),
    ],
)
def test_it_is_refused_at_its_key(tmp_path: Path, lines: str, key: str, problem: str, advice: str) -> None:
    with pytest.raises(InputError) as refused:
        loaded(tmp_path, lines)
    assert refused.value.where.endswith(f": {key}")
    assert problem in refused.value.problem
    assert advice in refused.value.advice


@pytest.mark.parametrize(
    ("lines", "key", "problem", "advice"),
    [
        (
            "[acquisition]\nsample_rate_hz = 1e9",
            "acquisition.sample_rate_hz",
            "is 1e+09: 22 channels of all runs for 18 s make 3.17e+03 GB",
            "at most 2525252, and more than 70 for the band",
        ),
        (
            "[acquisition]\nrepeats = 2\n[excitation]\nduration_s = 4e4",
            "acquisition.repeats",
            "is 2 and makes 14.1 GB",
            "Repeat 1 times",
        ),
        ("[excitation]\nring_down_s = 1e6", "excitation.ring_down_s", "is 1e+06, and the campaign", "most 4.54e+04"),
        ("[excitation]\nlead_in_s = 1e6", "excitation.lead_in_s", "8 GB", "at most 4.54e+04"),
        (
            "[excitation]\nlead_in_s = 1e6\nring_down_s = 1e6",
            "excitation.lead_in_s",
            "8 GB",
            "make the rest of the record shorter",
        ),
    ],
)
def test_what_makes_too_much_is_told_at_the_key_that_was_written(
    tmp_path: Path, lines: str, key: str, problem: str, advice: str
) -> None:
    with pytest.raises(InputError) as refused:
        loaded(tmp_path, lines)
    assert refused.value.where == f"{tmp_path / 'mine.toml'}: {key}"
    assert problem in refused.value.problem
    assert advice in refused.value.advice


def test_a_duration_of_a_campaign_that_another_file_repeats_fits_when_it_is_what_was_advised(tmp_path: Path) -> None:
    (tmp_path / "twice.toml").write_text(HEAD + "[acquisition]\nrepeats = 2", encoding="utf-8")
    path = tmp_path / "mine.toml"
    head = HEAD.replace('"quick"', '"twice.toml"')
    path.write_text(f"{head}[excitation]\nduration_s = 4e4", encoding="utf-8")
    with pytest.raises(InputError, match=r"mine\.toml: excitation\.duration_s: is 40000: .*, 2 times, at") as refused:
        load_scenario(path)
    assert "at most 2.27e+04" in refused.value.advice
    path.write_text(f"{head}[excitation]\nduration_s = 2.27e4", encoding="utf-8")
    load_scenario(path)


def test_a_sweep_names_the_rate_that_it_sets() -> None:
    with pytest.raises(InputError, match=r"--set .*: acquisition\.sample_rate_hz is 1e\+09"):
        sweep(load_scenario("quick"), [Axis.parse("acquisition.sample_rate_hz=1e9")])


@pytest.mark.parametrize(
    "lines",
    [
        "[accelerometers]\nhigh_pass_hz = 499.9",
        "[excitation]\nduration_s = 0.0527",
        "[acquisition]\nrepeats = 2525",
        "[excitation]\nduration_s = 45450.0",
    ],
)
def test_what_just_fits_is_not(tmp_path: Path, lines: str) -> None:
    loaded(tmp_path, lines)


def test_what_is_bundled_is_far_from_too_long() -> None:
    """The limit is there for slips of the pen: a tenth of it is never in use."""
    for name in (*bundled_scenarios(), *spoiled_scenarios()):
        scenario = load_scenario(name)
        channels = sum(len(nodes) + 2 * len(scenario.shakers) for nodes in scenario.acquisition.run_nodes)
        assert scenario.excitation.record_s * scenario.acquisition.sample_rate_hz * channels < 1e8
