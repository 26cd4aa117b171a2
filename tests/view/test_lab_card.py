"""The test card: what a technician is to set is what the command is."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.rig import Excitation
from vgvt.simulation.command import drive_commands, peak_command_v, sample_times_s
from vgvt.view.lab_card import CardFacts, ExpectedMode, card_page

MODES = (ExpectedMode("1st symmetric bending", 8.137, 1e-4, 1.1, 1e-3),)


def excited(**keys: object) -> Scenario:
    quick = load_scenario("quick")
    excitation = {"start_hz": 3.0, "stop_hz": 35.0, "duration_s": 16.0, "amplitude_v": 0.7}
    return quick.model_copy(update={"excitation": Excitation.model_validate(excitation | keys)})


def generator_step(scenario: Scenario) -> str:
    facts = CardFacts("glue", 5.0, 0.5, 6.0, MODES, peak_command_v(scenario), 3.0, 9.0, 0.4, ((0.2, -0.3),))
    return re.findall(r"<b>Set the generator</b> (.*?)</li>", card_page(scenario, "a test", facts))[0]


def test_a_sine_s_amplitude_is_its_peak() -> None:
    gain = load_scenario("quick").shaker.amplifier_gain
    step = generator_step(excited(ring_down_s=2.0, taper_s=0.5))
    assert step.startswith("linear sine sweep from 3 to 35 Hz in 16 s, all of it rising and falling in 0.5 s, 2 s of")
    assert f"; 0.7 V peak ({0.7 * gain:.3g} A at the coil)" in step
    assert "rms" not in step


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"kind": "random"}, "random from 3 to 35 Hz in 16 s; 0.7 V rms (peaks"),
        (
            {"kind": "burst-random", "blocks": 4, "burst_fraction": 0.6, "taper_s": 0.05},
            "each burst rising and falling in 0.05 s, 4 blocks of 4 s, the first 2.4 s of each noise; 0.7 V rms inside",
        ),
        (
            {"kind": "multisine", "blocks": 4, "lines": "odd", "crest_iterations": 50},
            "4 periods of 4 s, odd lines; 0.7 V rms (peaks",
        ),
    ],
)
def test_that_of_noise_is_a_root_mean_square_with_the_peaks_beside_it(keys: dict[str, object], words: str) -> None:
    scenario = excited(**keys)
    step = generator_step(scenario)
    assert words in step
    assert "V peak" not in step
    (volts,) = re.findall(r"peaks of about ([\d.]+) V", step)
    largest = np.abs(drive_commands(scenario, 0, sample_times_s(scenario))).max()
    assert float(volts) == pytest.approx(largest, rel=0.03)
    (ampere,) = re.findall(r"V, ([\d.]+) A at the coil", step)
    assert float(ampere) == pytest.approx(largest * scenario.shaker.amplifier_gain, rel=0.03)


def test_dwells_are_on_it() -> None:
    step = generator_step(excited(kind="stepped-sine", points=8, settle_s=1.0))
    assert "stepped sine from 3 to 35 Hz in 16 s, 8 dwells of 2 s, of which 1 s to settle; 0.7 V peak" in step


def test_noise_is_recorded_and_not_swept() -> None:
    scenario = excited(kind="random")
    several = scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"repeats": 3})})
    facts = replace(CardFacts("glue", 5.0, 0.5, 6.0, MODES, 3.0, 3.0, 9.0, 0.4, ((0.2, -0.3),)), minutes=9.0)
    page = card_page(several, "a test", facts)
    assert "<b>Record</b> 3 records, one after the other" in page
    assert "sweep" not in page.lower()


def card(scenario: Scenario, force_n: float, g: float) -> str:
    facts = CardFacts("glue", 5.0, 0.5, 6.0, MODES, peak_command_v(scenario), force_n, 9.80665 * g, 0.4, ((0.2, -0.3),))
    return card_page(scenario, "a test", facts)


def test_where_force_and_acceleration_end_is_on_the_card_and_what_goes_beyond() -> None:
    page = card(excited(), 20.0, 2.0)
    assert "the force is cut off at 44.5 N (the force transducer&#x27;s ±44.5 N)" in page
    assert "the acceleration at 60.9 g (the converter&#x27;s ±62.58 V)" in page
    assert "Turn the level down" not in page
    loud = card(excited(), 50.0, 2.0)
    assert "<b>Turn the level down</b>: the force of up to 50 N is beyond the force transducer&#x27;s ±44.5 N" in loud


def test_a_record_that_begins_late_says_when() -> None:
    step = generator_step(excited(unrecorded_s=4.0, ring_down_s=2.0))
    assert "14 s a record, begun 4 s after the shaker." in step
    assert "begun" not in generator_step(excited(ring_down_s=2.0))


@pytest.mark.parametrize(
    ("hangs_deg", "words"),
    [
        (((0.2, -0.4),), "it must hang level to 0.5°."),
        (((-1.5, 0.2),), "it must hang right wing down by 1.5°."),
        (((0.8, -66.5),), "it must hang left wing down by 0.8° and nose down by 66.5°."),
        (((0.2, 0.1), (-0.2, 0.1)), "it must hang level to 0.5°."),
        (
            ((-4.7, 0.1), (-5.0, 0.1), (-7.9, 0.9), (-7.8, 0.9)),
            "it must hang right wing down by 4.7° in run 1, and right wing down by 7.9° and nose up by 0.9° in run 3.",
        ),
    ],
)
def test_how_it_hangs_is_said_as_it_is(hangs_deg: tuple[tuple[float, float], ...], words: str) -> None:
    scenario = excited()
    facts = CardFacts("glue", 5.0, 0.5, 6.0, MODES, peak_command_v(scenario), 3.0, 9.0, 0.4, hangs_deg)
    assert words in card_page(scenario, "a test", facts)
