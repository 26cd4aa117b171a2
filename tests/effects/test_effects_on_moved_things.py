"""Effects that meet on one thing: sensors that others moved, tables that others wrote out, the same effect twice."""

from __future__ import annotations

import numpy as np
import pytest
from effect_rig import FORE, TIP, WING, effect_rig
from hung_hati import made, with_effect
from small_rig import revised

from vgvt.data import InputError
from vgvt.effects.acting import acted
from vgvt.effects.elements import GroundSpring
from vgvt.effects.registry import effects_of
from vgvt.scenario import Scenario, load_scenario, sensor_points
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.assembly import bare_rig, plans
from vgvt.simulation.damping import MODAL_DAMPING
from vgvt.simulation.effect_conformance import example_scenario
from vgvt.simulation.linear import linearise

Places = dict[int, tuple[str, tuple[float, ...]]]


def seats(scenario: Scenario, run: int = 0) -> Places:
    """Where the sensors of a run sit, by label."""
    points = plans(scenario)[run].run_points(run)
    return {p.dof.node: (p.part, tuple(p.position_m.tolist())) for p in points}


def cables(scenario: Scenario, run: int = 0) -> Places:
    """Where the cables of a run are tied, by label."""
    springs = (e for a in plans(scenario)[run].actions for e in a.elements if isinstance(e, GroundSpring))
    return {s.node or 0: (s.part, tuple(s.position_m)) for s in springs}


@pytest.mark.parametrize("cables_first", [True, False])
@pytest.mark.parametrize(
    "astray",
    [
        [("swapped-sensors", {"node": TIP, "other_node": FORE})],
        [("sensor-position-error", {"node": TIP, "dx_m": 0.02, "dy_m": -0.03})],
        [
            ("swapped-sensors", {"node": TIP, "other_node": FORE}),
            ("sensor-position-error", {"node": FORE, "dy_m": 0.01}),
        ],
    ],
)
def test_a_cable_hangs_from_its_sensor(cables_first: bool, astray: list[tuple[str, dict[str, object]]]) -> None:
    """Mass and cable of one label are at one place, the other sensors' where they were, in any order of the tables."""
    drag: tuple[str, dict[str, object]] = ("cable-drag", {"stiffness_n_per_m": 20.0})
    scenario = effect_rig()
    for name, values in [drag, *astray] if cables_first else [*astray, drag]:
        scenario = with_effect(scenario, name, **values)
    assert cables(scenario) == seats(scenario)
    plain = seats(effect_rig())
    assert seats(scenario)[TIP] != plain[TIP]
    assert seats(scenario)[WING] == plain[WING]


def test_two_exchanges_that_share_a_node_leave_one_sensor_at_each_place() -> None:
    """Labels 1 and 2, then 2 and 3 from where they sit by then: two had been left at one place, none at another."""
    scenario, one, two, three = effect_rig(), WING, TIP, FORE
    plain = seats(scenario)
    for pair in ((one, two), (two, three)):
        scenario = with_effect(scenario, "swapped-sensors", node=pair[0], other_node=pair[1])
    assert [seats(scenario)[n] for n in (one, two, three)] == [plain[n] for n in (two, three, one)]
    back = with_effect(
        with_effect(effect_rig(), "swapped-sensors", node=one, other_node=two),
        "swapped-sensors",
        node=two,
        other_node=one,
    )
    assert seats(back) == plain


def with_dihedral(rise: float) -> Scenario:
    """Wings that rise by so much a metre of span, and sensors on the surface of what carries them."""
    rig = effect_rig()
    (beam,) = rig.airframe.beam
    raised = tuple((x, y, z + rise * y) for x, y, z in beam.stations.position_m)
    beam = beam.model_copy(update={"stations": beam.stations.model_copy(update={"position_m": raised})})
    grid = rig.accelerometers.grid.model_copy(update={"z_m": None})
    return revised(rig, airframe={"beam": (beam,)}, accelerometers={"grid": grid})


@pytest.mark.parametrize("exchanged_first", [True, False])
def test_an_exchanged_sensor_is_moved_along_what_it_sits_on(exchanged_first: bool) -> None:
    """One with the label of the level body, on a wing that rises: it had been left below, and the wing's in the air."""
    rise, out_m = 0.2, 0.04
    exchanged = ("swapped-sensors", {"node": TIP, "other_node": FORE})
    # Along the wing's axis, which is swept: its surface rises with the axis.
    inner, outer = with_dihedral(rise).airframe.beam[0].stations.position_m[-2:]
    aft_m = out_m * (outer[0] - inner[0]) / (outer[1] - inner[1])
    plain = seats(with_dihedral(rise))
    for node, other, higher_m in ((FORE, TIP, rise * out_m), (TIP, FORE, 0.0)):
        part, (x, y, z) = plain[other]
        aside = out_m if y >= 0 else -out_m
        moved = ("sensor-position-error", {"node": node, "dx_m": aft_m, "dy_m": aside})
        scenario = with_effect(with_dihedral(rise), "cable-drag", stiffness_n_per_m=20.0)
        for name, values in (exchanged, moved) if exchanged_first else (moved, exchanged):
            scenario = with_effect(scenario, name, **values)  # type: ignore[arg-type]
        assert seats(scenario)[node] == (part, pytest.approx((x + aft_m, y + aside, z + higher_m), abs=1e-7))
        assert cables(scenario) == seats(scenario)


def test_a_sensor_on_a_fin_slides_up_it() -> None:
    """As one that a grid has drawn there; to the right of a fin there is air, and it had hung in that by an arm."""
    node, aft_m, up_m = 26, 0.02, -0.03
    scenario = load_scenario("garteur-sm-ag19")
    grid = scenario.accelerometers.grid
    assert grid.z_m is not None
    k = grid.node.index(node)
    x_m, z_m = (
        tuple(v + (by if i == k else 0.0) for i, v in enumerate(c)) for c, by in ((grid.x_m, aft_m), (grid.z_m, up_m))
    )
    redrawn = revised(scenario, accelerometers={"grid": grid.model_copy(update={"x_m": x_m, "z_m": z_m})})
    astray = with_effect(scenario, "sensor-position-error", node=node, dx_m=aft_m, dy_m=up_m)
    assert seats(astray) == {n: (part, pytest.approx(at)) for n, (part, at) in seats(redrawn).items()}
    got, wanted, plain = (simulated_campaign(s, engine="linear").runs[0].samples for s in (astray, redrawn, scenario))
    np.testing.assert_allclose(got, wanted, atol=1e-9 * np.abs(wanted).max())
    assert np.abs(plain - wanted).max() > 1e-3 * np.abs(wanted).max()


@pytest.mark.parametrize(("azimuth_rad", "across"), [(0.0, (0.0, 1.0, 0.0)), (np.pi / 2, (0.0, 0.0, 1.0))])
@pytest.mark.parametrize("exchanged_first", [True, False])
def test_a_leaning_sensor_leans_from_where_it_sits(
    azimuth_rad: float, across: tuple[float, ...], exchanged_first: bool
) -> None:
    """One that says it measures up and sits where GARTEUR's measure aft: it had leant by 0.2 degrees of 4.6."""
    up, aft, angle_rad = 1, 8, 0.08
    tilt = ("sensor-tilt", {"angle_rad": angle_rad, "azimuth_rad": azimuth_rad, "sensors": f"{up}+Z"})
    feels = ("transverse-sensitivity", {"fraction": 0.05, "azimuth_rad": azimuth_rad, "sensors": f"{up}+Z"})
    exchanged = ("swapped-sensors", {"node": up, "other_node": aft})
    for effect, wanted in ((tilt, [np.cos(angle_rad), np.sin(angle_rad)]), (feels, [1.0, 0.05])):
        scenario = load_scenario("garteur-sm-ag19")
        for name, values in (exchanged, effect) if exchanged_first else (effect, exchanged):
            scenario = with_effect(scenario, name, **values)  # type: ignore[arg-type]
        (point,) = (p for p in plans(scenario)[0].run_points(0) if p.dof.node == up)
        np.testing.assert_allclose(point.axis, wanted @ np.array([(1.0, 0.0, 0.0), across]), atol=1e-12)


@pytest.mark.parametrize("skewed_first", [True, False])
@pytest.mark.parametrize(
    ("name", "at_hz", "seen_hz"), [("aliased-interference", 100037.0, 87.0185), ("mains-hum", 50.0, 50.025)]
)
def test_a_slow_clock_samples_what_comes_in_at_its_converter(
    skewed_first: bool, name: str, at_hz: float, seen_hz: float
) -> None:
    """By 1 + skew further apart: of interference that moves the line by fifty hertz. It had stayed at 37 Hz."""
    skew: tuple[str, dict[str, object]] = ("clock-skew", {"skew": 5e-4})
    hum: tuple[str, dict[str, object]] = (name, {"frequency_hz": at_hz, "amplitude_v": 0.5, "channels": "all"})
    scenario = example_scenario(1e-9)
    for effect, values in (skew, hum) if skewed_first else (hum, skew):
        scenario = with_effect(scenario, effect, **values)
    record = simulated_campaign(scenario, engine="linear").runs[0]
    time_s = np.arange(record.samples.shape[1]) / record.sample_rate_hz
    prompt_hz = abs(at_hz - 1e5) if name == "aliased-interference" else at_hz
    for row, hz in ((1, prompt_hz), (2, seen_hz)):
        waves = np.stack([np.cos(2 * np.pi * hz * time_s), np.sin(2 * np.pi * hz * time_s)])
        level = 2 * np.hypot(*(waves @ record.samples[row])) / time_s.size * record.channels[row].sensitivity_v_per_unit
        assert level == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize("name", ["stiffness-asymmetry", "root-compliance"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_every_shaker_follows_a_table_that_is_written_out(name: str, side: str) -> None:
    """A second shaker on 'wing' is on the wing of its side when the two wings differ."""
    whole = load_scenario("hati-two-shakers")
    (second,) = whole.further_shaker
    x, y, z = next(p.position_m for p in sensor_points(whole) if p.part == f"wing-{side}")
    on_wing = second.model_copy(update={"attached_to": "wing", "position_m": (x, y, z)})
    scenario = whole.model_copy(update={"further_shaker": (on_wing,)})
    sized: dict[str, object] = {"bending": 0.1} | ({} if name == "stiffness-asymmetry" else {"side": "right"})
    spoiled = plans(with_effect(scenario, name, **sized))[0]
    assert [d.carrier for d in spoiled.drives][1].startswith(f"wing-{side}")
    assert spoiled.drives[0].carrier == plans(scenario)[0].drives[0].carrier


def test_cables_hang_on_wings_that_are_written_out_behind_them() -> None:
    """Of the bundled aircraft whose grid names its parts; the other order always worked."""
    scenario = load_scenario("garteur-sm-ag19")
    tables: list[tuple[str, dict[str, object]]] = [
        ("cable-drag", {"stiffness_n_per_m": 5.0}),
        ("stiffness-asymmetry", {"beam": "wing", "bending": 0.05}),
    ]
    modes = []
    for order in (tables, tables[::-1]):
        spoiled = scenario
        for name, values in order:
            spoiled = with_effect(spoiled, name, **values)
        modes.append(truth_of(spoiled).as_tested[0].natural_frequency_hz)
    np.testing.assert_allclose(modes[0], modes[1], rtol=1e-8)


def test_a_grid_may_name_a_mirrored_part_without_heights() -> None:
    """The copy on the side of each point is meant, and the height is that of its surface."""
    whole = load_scenario("hati-unsymmetric")
    points = sensor_points(whole)
    grid = whole.accelerometers.grid.model_copy(
        update={"attached_to": tuple(p.part.removesuffix("-right").removesuffix("-left") for p in points), "z_m": None}
    )
    named = whole.model_copy(update={"accelerometers": whole.accelerometers.model_copy(update={"grid": grid})})
    assert "wing" in (grid.attached_to or ())
    assert [p.part for p in sensor_points(named)] == [p.part for p in points]
    np.testing.assert_allclose([p.position_m for p in sensor_points(named)], [p.position_m for p in points], atol=1e-9)


def coupled(*couplings: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Stiffness matrix of the example's bare airframe with couplings on top of each other."""
    scenario = example_scenario()
    for coupling in couplings:
        scenario = with_effect(scenario, "bend-twist-coupling", coupling=coupling)
    model = bare_rig(plans(scenario)[0]).model
    return linearise(model, np.zeros(model.nq)).stiffness


@pytest.mark.parametrize("couplings", [(0.2, 0.1), (0.3, -0.1), (-0.2, 0.2), (0.6, -0.5)])
def test_couplings_of_one_wing_add_up(couplings: tuple[float, ...]) -> None:
    """K = (κ1 + κ2) sqrt(EI GJ) at unchanged EI and GJ: each had coupled what the one before left of the hinges."""
    total, size = coupled(sum(couplings)), np.abs(coupled()).max()
    np.testing.assert_allclose(coupled(*couplings), total, atol=1e-7 * size)
    assert np.abs(total - coupled(couplings[0])).max() > 1e-3 * size


def test_couplings_that_leave_no_strain_energy_are_refused() -> None:
    with pytest.raises(InputError, match=r"wing-right: their couplings are 1\.1 together"):
        coupled(0.6, 0.5)


def test_growths_of_damping_add_up() -> None:
    """Of two effects the last had been the only one."""
    scenario = example_scenario()
    drags = []
    for growths in ((5.0,), (2.0, 3.0), (3.0, 2.0)):
        spoiled = scenario
        for growth in growths:
            spoiled = with_effect(spoiled, "amplitude-dependent-damping", growth_per_rtkg_m=growth)
        model = bare_rig(plans(spoiled)[0]).model
        modal = [t for t in range(model.ntendon) if model.tendon(t).name.startswith(MODAL_DAMPING)]
        drags.append(model.tendon_dampingpoly[modal].copy())
    assert np.abs(drags[0]).min(axis=0).max() > 1.0
    for drag in drags[1:]:
        np.testing.assert_allclose(drag, drags[0], rtol=1e-12)


def test_effects_that_move_no_sensor_leave_cables_alone() -> None:
    """What an effect says on its own is what it does then."""
    scenario = with_effect(effect_rig(), "cable-drag", stiffness_n_per_m=20.0)
    effects = effects_of(with_effect(scenario, "sensor-tilt", angle_rad=0.05))
    _, (drag, _) = acted(effects, effect_rig(), 0)
    assert drag.elements == made("cable-drag", stiffness_n_per_m=20.0).act(effect_rig(), 0).elements
