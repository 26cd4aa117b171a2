"""Names of true modes: six rigid ones on a soft suspension, none twice; the elastic ones as on the bare airframe."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from vgvt.cli.document import plain
from vgvt.files.claim import mode_documents
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import Rig, bare_rig, hung_rig, plans, rigid_body
from vgvt.simulation.labels import mode_labels
from vgvt.simulation.linear import linearise
from vgvt.simulation.modes import eigenpairs

RIGID = {"fore-aft swing", "sideways swing", "heave", "yaw", "pitch", "roll"}
ELASTIC_IN_BAND = {
    "bff": 6,
    "bff-hung-aft": 6,
    "garteur-sm-ag19": 8,
    "hati-unsymmetric": 4,
    "skoll-gvt1": 5,
    "teaching-beam": 8,
}


def labels_of(scenario: Scenario, rig: Rig) -> tuple[str, ...]:
    linear = linearise(rig.model, rig.qpos)
    return mode_labels(plans(scenario)[0].parts, rig.model, linear.mass, eigenpairs(linear)[1])


@pytest.mark.parametrize("name", ELASTIC_IN_BAND)
def test_a_hung_aircraft_has_six_rigid_modes_and_the_bare_airframes_elastic_ones(name: str) -> None:
    """Heave on a soft wing is heave; a swing and a pitch that mix are one each; bending counts from the first."""
    scenario = load_scenario(name)
    layout = plans(scenario)[0]
    hung = labels_of(scenario, hung_rig(layout, 0))
    assert set(hung[:6]) == RIGID
    count = ELASTIC_IN_BAND[name]
    assert hung[6 : 6 + count] == labels_of(scenario, bare_rig(layout))[:count]
    assert max(Counter(hung).values()) == 1


def test_an_aircraft_that_hangs_rolled_keeps_its_names() -> None:
    """An absorber at one tip lets Hati hang at 18 degrees of roll, where inertia is another than level."""
    layout = plans(load_scenario("spoiled-local-absorber"))[0]
    rig = hung_rig(layout, 0)
    assert abs(rig.qpos[rig.model.joint("roll").qposadr[0]]) > 0.2
    labels = labels_of(layout.scenario, rig)
    assert set(labels[:6]) == RIGID
    assert labels[6:10] == (
        "1st symmetric bending",
        "1st absorber",
        "1st antisymmetric bending",
        "2nd symmetric bending",
    )


@pytest.mark.parametrize("name", ELASTIC_IN_BAND)
def test_heave_is_where_spring_and_mass_say(name: str) -> None:
    """sqrt(k/m) of the suspension names the same mode: within 2 %, and nothing else as near."""
    scenario = load_scenario(name)
    rig = hung_rig(plans(scenario)[0], 0)
    poles, _ = eigenpairs(linearise(rig.model, rig.qpos))
    expected = np.sqrt(scenario.suspension.stiffness_n_per_m / rigid_body(rig).mass_kg)
    nearest = int(np.argmin(np.abs(np.abs(poles) - expected)))
    assert labels_of(scenario, rig)[nearest] == "heave"
    assert np.abs(poles[nearest]) == pytest.approx(expected, rel=0.02)


def test_no_deviation_is_stated_outside_the_swept_band(small: Scenario) -> None:
    """Bounds are numbers where the sweep passes, NaN elsewhere, and null in JSON."""
    modes = truth_of(small).as_tested[0]
    low, high = small.excitation.band_hz
    swept = (modes.natural_frequency_hz >= low) & (modes.natural_frequency_hz <= high)
    assert 0 < swept.sum() < len(modes)
    assert modes.natural_frequency_std_hz is not None
    assert modes.damping_ratio_std is not None
    for bound in (modes.natural_frequency_std_hz, modes.damping_ratio_std):
        np.testing.assert_array_equal(np.isfinite(bound), swept)
    stated = [row["frequency_std_hz"] is not None for row in plain(mode_documents(modes))]
    assert stated == swept.tolist()
