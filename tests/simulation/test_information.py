"""The bound that the truth states: laws of force, noise and number of sensors, for every exciter."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import revised

from vgvt.scenario import Hammer, NoiseSpectrum, Scenario
from vgvt.simulation import truth_of

HAMMER = Hammer(
    head_mass_kg=0.15, tip_mass_kg=0.01, tip_stiffness_n_per_m=24e3, peak_force_n=5.0, sensitivity_v_per_n=0.01
)
BURST: dict[str, object] = {"kind": "burst-random", "blocks": 4, "burst_fraction": 0.5, "taper_s": 0.05}


def stated(scenario: Scenario, run: int = 0) -> np.ndarray:
    """Least relative deviations of frequencies, then of damping ratios, over the damping, (2, modes in the band)."""
    modes = truth_of(scenario).as_tested[run].band(*scenario.excitation.band_hz)
    assert modes.natural_frequency_std_hz is not None
    assert modes.damping_ratio_std is not None
    relative = modes.natural_frequency_std_hz / modes.natural_frequency_hz
    return np.array([relative, modes.damping_ratio_std]) / modes.damping_ratio


def noisy(small: Scenario, **acquisition: object) -> Scenario:
    sensors = {"mass_kg": 0.0, "noise": NoiseSpectrum(frequency_hz=(1.0, 100.0), density=(1e-6, 1e-6))}
    return revised(small, acquisition=acquisition, accelerometers=sensors, excitation={"duration_s": 30.0})


def test_more_sensors_do_not_average_the_noise_of_the_force_away(small: Scenario) -> None:
    """It is the same in all of them: where it dominates, ten sensors know what two do."""
    few = noisy(small, runs=((1, 10),))
    many = noisy(small, runs=((1, 2, 5, 9, 10, 11, 12, 15, 19, 20),))
    loud = {"noise": NoiseSpectrum(frequency_hz=(1.0, 100.0), density=(1e-3, 1e-3))}
    quiet = {"noise": NoiseSpectrum(frequency_hz=(1.0, 100.0), density=(1e-9, 1e-9))}
    shared = stated(revised(few, transducer=loud)) / stated(revised(many, transducer=loud))
    own = stated(revised(few, transducer=quiet)) / stated(revised(many, transducer=quiet))
    assert shared == pytest.approx(1.0, abs=0.2)
    assert (own > 1.3).all()


def test_what_ac_coupling_takes_of_the_responses_is_not_known(small: Scenario) -> None:
    """With a quiet force a mode is known less by the gain of the sensors' filter at its frequency."""
    quiet = {"noise": NoiseSpectrum(frequency_hz=(1.0, 100.0), density=(1e-9, 1e-9))}
    plain = revised(noisy(small), transducer=quiet)
    coupled = revised(plain, accelerometers={"high_pass_hz": 10.0})
    modes = truth_of(plain).as_tested[0].band(*plain.excitation.band_hz)
    gain = 1 / np.sqrt(1 + (10.0 / modes.natural_frequency_hz) ** 2)
    assert gain.min() < 0.7
    np.testing.assert_allclose(stated(coupled), stated(plain) / gain, rtol=0.1)


def test_damping_is_known_as_frequency_is_where_modes_are_apart(small: Scenario) -> None:
    """std(ζ)/ζ = std(f) / (ζ f) of a mode alone; neighbours and the force's drop-out leave 15 % of difference."""
    frequency, damping = stated(noisy(small))
    assert damping == pytest.approx(frequency, rel=0.15)


@pytest.mark.parametrize("kind", ["shaker", "two shakers", "one of two shakers", "hammer"])
def test_twice_the_force_halves_what_is_not_known(small: Scenario, kind: str) -> None:
    base = noisy(small, noise_v_per_rthz=1e-4)
    if kind == "hammer":
        hit = {"kind": "impact", "blocks": 4, "duration_s": 40.0, "ring_down_s": 0.0, "taper_s": 0.0}
        base = revised(base, excitation=hit).model_copy(update={"hammer": HAMMER})
        louder = base.model_copy(update={"hammer": HAMMER.model_copy(update={"peak_force_n": 10.0})})
    else:
        if kind != "shaker":
            second = small.shaker.model_copy(update={"node": 101, "position_m": (0.7112, 0.0, 0.0)})
            signals = BURST if kind == "two shakers" else {"shakers": "sequential"}
            base = revised(base, excitation=signals, acquisition={"repeats": 2})
            base = base.model_copy(update={"further_shaker": (second,)})
        louder = revised(base, excitation={"amplitude_v": 2 * base.excitation.amplitude_v})
    found = stated(base)
    assert np.isfinite(found).all()
    assert (found > 0).all()
    # A better test may have to find more of what is around the band.
    assert stated(louder) == pytest.approx(found / 2, rel=0.15)


def test_outside_the_swept_band_nothing_is_stated(small: Scenario) -> None:
    modes = truth_of(noisy(small)).as_tested[0]
    low, high = small.excitation.band_hz
    swept = (modes.natural_frequency_hz >= low) & (modes.natural_frequency_hz <= high)
    for limit in (modes.natural_frequency_std_hz, modes.damping_ratio_std):
        assert limit is not None
        assert np.isfinite(limit[swept]).all()
        assert np.isnan(limit[~swept]).all()
