"""Effects of the airframe leave the signature that a formula or independent finite elements predict."""

from __future__ import annotations

import finite_element as fe
import numpy as np
import pytest
from hung_hati import UP, as_tested, bare_bending, elastic, fe_items, hung_hati, made, mode, tips, with_effect
from scipy.optimize import brentq
from uniform_beams import CLAMPED_FREE, UniformBeam, cantilever, virtual_test

from vgvt.data import InputError
from vgvt.effects import make_effect
from vgvt.effects.beams import with_beams, with_columns
from vgvt.effects.entrained_air import chord_m
from vgvt.effects.root_compliance import beam_compliance
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.mirror import expanded_beams
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import bare_rig, hung_rig, plans, rigid_body
from vgvt.simulation.linear import linearise
from vgvt.simulation.reduced import structure


@pytest.fixture(scope="module")
def hati() -> Scenario:
    """Hati, one run, hung right above its centre of gravity."""
    return hung_hati()


def test_asymmetry_equals_two_different_wings_by_finite_elements(hati: Scenario) -> None:
    """Frequencies and left-right ratios of the bare aircraft against finite elements of two wings written by hand."""
    bend, twist = 0.12, -0.08
    table = hati.airframe.beam[0]

    def wing(name: str, sign: int) -> dict[str, object]:
        stations = table.stations.model_dump(exclude_none=True)
        stations["position_m"] = [(x, sign * y, z) for x, y, z in stations["position_m"]]
        stations["bending_stiffness_n_m2"] = [v * (1 + sign * bend) for v in stations["bending_stiffness_n_m2"]]
        stations["torsional_stiffness_n_m2"] = [v * (1 + sign * twist) for v in stations["torsional_stiffness_n_m2"]]
        return {"name": name, "cells": 8, "normal": (0.0, 0.0, 1.0), "stations": stations}

    items = [i.model_dump() for i in fe_items(hati)]
    plain = hati.airframe.model_dump(exclude={"beam", "item"}, exclude_none=True)
    by_hand = type(hati.airframe).model_validate(
        plain | {"beam": [wing("wing-right", 1), wing("wing-left", -1)], "item": items}
    )
    model = fe.build(by_hand)
    expected, shapes = fe.natural_modes(model.mass, model.stiffness)
    bare = truth_of(with_effect(hati, "stiffness-asymmetry", bending=bend, torsion=twist)).bare
    flexible = bare.band(3.0, 55.0)
    count = len(flexible)
    np.testing.assert_allclose(flexible.natural_frequency_hz, expected[6 : 6 + count], rtol=0.01)
    right, left = ([d.node for d in flexible.dofs].index(n) for n in tips(hati))
    positions = {p.dof.node: p.position_m for p in plans(hati)[0].grid}
    for r in range(3):
        z = [
            model.motion_at(positions[n], f"wing-{s}")[2] @ shapes[:, 6 + r]
            for n, s in zip(tips(hati), ("right", "left"), strict=True)
        ]
        assert flexible.shapes[r, right].real / flexible.shapes[r, left].real == pytest.approx(z[0] / z[1], rel=0.03)
        assert abs(abs(z[0] / z[1]) - 1) > 0.02, "asymmetry must show in this test"
    assert not any(label.endswith(" bending") and "symmetric" not in label for label in flexible.labels)


def test_root_compliance_of_a_cantilever() -> None:
    """κ (1 + cos b cosh b) = b (sin b cosh b − cos b sinh b), κ = k L/EI (Blevins, table 8-1)."""
    beam, softness = UniformBeam(), 0.15

    def characteristic(b: float) -> float:
        return (1 + np.cos(b) * np.cosh(b)) / softness - b * (np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b))

    roots = np.array([brentq(characteristic, 0.8 * b, b) for b in CLAMPED_FREE[:2]])
    scenario = virtual_test(cantilever(beam, cells=24), beam.length_m, mirror=False)
    softened = made("root-compliance", bending=softness).act(scenario, 0).scenario
    assert softened is not None
    np.testing.assert_allclose(bare_bending(softened)[:2], beam.bending_hz(roots), rtol=2e-3)
    np.testing.assert_allclose(bare_bending(scenario)[:2], beam.bending_hz(CLAMPED_FREE[:2]), rtol=2e-3)


def test_root_compliance_on_one_side_adds_to_a_joint_that_is_there(hati: Scenario) -> None:
    """In series: 1/k = 1/k0 + β L/EI on the chosen side, k0 on the other, and nothing else changes."""
    jointed = hati.airframe.beam[0].model_copy(update={"root_bending_stiffness_n_m_per_rad": 800.0})
    with_joint = hati.model_copy(update={"airframe": hati.airframe.model_copy(update={"beam": (jointed,)})})
    changed = made("root-compliance", bending=0.1, side="left").act(with_joint, 0).scenario
    assert changed is not None
    right, left = changed.airframe.beam
    length = np.linalg.norm(np.subtract(jointed.stations.position_m[-1], jointed.stations.position_m[0]))
    expected = 1 / (1 / 800.0 + 0.1 * length / 316.04)
    assert right.root_bending_stiffness_n_m_per_rad == 800.0
    assert left.root_bending_stiffness_n_m_per_rad == pytest.approx(expected, rel=2e-3)
    Scenario.model_validate(changed.model_dump(exclude_none=True))


def test_root_compliance_of_a_taper_is_the_integral_of_its_flexibility(hati: Scenario) -> None:
    beam = hati.airframe.beam[0]
    stiffness = (400.0, 300.0, 300.0, 120.0)
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(beam.stations.position_m, axis=0), axis=1))])
    fine = np.linspace(0, arc[-1], 400_001)
    expected = np.trapezoid(1 / np.interp(fine, arc, stiffness), fine)
    assert beam_compliance(beam, stiffness) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("coupling", [0.25, -0.25])
def test_bend_twist_under_a_tip_load(coupling: float) -> None:
    """A tip load on the axis: slope P L²/(2 EI (1 − κ²)), twist κ sqrt(EI/GJ) of it, leading edge up."""
    beam = UniformBeam()
    scenario = virtual_test(cantilever(beam), beam.length_m, mirror=False)
    layout = plans(with_effect(scenario, "bend-twist-coupling", coupling=coupling))[0]
    model = bare_rig(layout).model
    linear = linearise(model, np.zeros(model.nq))
    names = [model.joint(j).name for j in range(model.njnt)]
    flexible = [j for j, name in enumerate(names) if "/" in name]
    hinge_y = {link.name: link.position_m[1] for link in layout.parts.chains["wing"].links}
    # Bending hinges lift the tip, torsion turns about +y, which is leading edge (x < 0) up.
    moment = [
        beam.length_m - hinge_y[names[j].split("/")[0]] if names[j].endswith("bending") else 0.0 for j in flexible
    ]
    angle = np.linalg.solve(linear.stiffness[np.ix_(flexible, flexible)], np.array(moment))
    slope = sum(a for a, j in zip(angle, flexible, strict=True) if names[j].endswith("bending"))
    twist = sum(a for a, j in zip(angle, flexible, strict=True) if names[j].endswith("torsion"))
    ei, gj = beam.bending_stiffness_n_m2, beam.torsional_stiffness_n_m2
    assert slope == pytest.approx(beam.length_m**2 / (2 * ei * (1 - coupling**2)), rel=1e-6)
    assert twist == pytest.approx(coupling * np.sqrt(ei / gj) * slope, rel=1e-6)


def test_bend_twist_is_a_mirror_image_on_the_other_wing(hati: Scenario) -> None:
    """On both wings the symmetric bending mode stays symmetric; on one wing alone it does not."""
    coupled = truth_of(with_effect(hati, "bend-twist-coupling", coupling=0.3)).bare.band(4.0, 12.0)
    plain = truth_of(hati).bare.band(4.0, 12.0)
    nodes = [d.node for d in plain.dofs]
    right, left = (nodes.index(n) for n in tips(hati))
    assert coupled.shapes[0, right].real == pytest.approx(coupled.shapes[0, left].real, rel=0.01)
    one_side = with_effect(hati, "bend-twist-coupling", coupling=0.3, side="left")
    assert abs(truth_of(one_side).bare.band(4.0, 12.0).shapes[0, right] / coupled.shapes[0, right] - 1) > 1e-3


def test_section_offset_equals_finite_elements_with_the_offset(hati: Scenario) -> None:
    """Bare frequencies against finite elements of a table whose offset and pitch inertia were written by hand."""
    table = hati.airframe.beam[0]
    stations = table.stations.model_copy(
        update={"cg_offset_m": (-0.00377,) * 4, "pitch_inertia_kg_m": (0.00215 * 1.3,) * 4}
    )
    by_hand = hati.airframe.model_copy(update={"beam": (table.model_copy(update={"stations": stations}),)})
    model = fe.build(by_hand)
    moved = truth_of(with_effect(hati, "section-cg-offset", offset_m=0.01, pitch_inertia_change=0.3)).bare.band(
        3.0, 55.0
    )
    expected = fe.natural_modes(model.mass, model.stiffness)[0][6 : 6 + len(moved)]
    np.testing.assert_allclose(moved.natural_frequency_hz, expected, rtol=0.01)
    plain = truth_of(hati).bare.band(3.0, 55.0)
    assert mode(moved, "1st symmetric torsion")[0] < 0.97 * mode(plain, "1st symmetric torsion")[0]


def test_added_mass_and_inertia_follow_rayleigh(hati: Scenario) -> None:
    """Δω/ω = −(m φ² + J θ²)/(2 m_r) of the bare aircraft, shapes from the independent finite elements."""
    model = fe.build(hati.airframe)
    shapes = fe.natural_modes(model.mass, model.stiffness)[1]
    place = (1.0, 1.45)
    row = model.motion_at(np.array([*place, 0.0]), "wing-right")
    plain = truth_of(hati).bare.band(3.0, 55.0)
    for name, parameters, energy in (
        ("added-mass", {"mass_kg": 1e-3}, lambda r: 1e-3 * float((row[:3] @ shapes[:, r]) @ (row[:3] @ shapes[:, r]))),
        (
            "added-inertia",
            {"pitch_inertia_kg_m2": 2e-5},
            lambda r: 2e-5 * float((row[[4, 5]] @ shapes[:, r]) @ (row[[4, 5]] @ shapes[:, r])),
        ),
    ):
        loaded = truth_of(with_effect(hati, name, **parameters, x_m=place[0], y_m=place[1])).bare.band(3.0, 55.0)
        got = loaded.natural_frequency_hz / plain.natural_frequency_hz - 1
        predicted = np.array([-0.5 * energy(6 + r) for r in range(len(plain))])
        # Eight links a wing: shapes near a tip are good to a few per cent.
        np.testing.assert_allclose(got, predicted, rtol=0.15, atol=0.03 * np.abs(predicted).max())


def test_a_local_absorber_is_called_one(hati: Scenario) -> None:
    modes = as_tested(with_effect(hati, "local-absorber", mass_kg=0.05, frequency_hz=12.0))
    frequency = mode(modes, "1st absorber")[0]
    assert 11.9 < frequency < 12.5
    assert [label for label in modes.labels if "absorber" not in label] == list(as_tested(hati).labels)


def test_flap_on_a_hinge_by_substructuring(hati: Scenario) -> None:
    """Two routes to the eigenvalues: the rig, and finite elements with the flap's hinge as one more coordinate."""
    compliance, arm = 8.0, 0.03
    flap = next(i for i in fe_items(hati) if i.name == "flap-outer-right")
    others = tuple(i for i in fe_items(hati) if i.name != flap.name)
    model = fe.build(hati.airframe.model_copy(update={"item": others}))
    axis = np.subtract(hati.airframe.beam[0].stations.position_m[2], hati.airframe.beam[0].stations.position_m[1])
    tangent = axis / np.linalg.norm(axis)
    aft = np.cross(UP, -tangent)
    centre = np.array(flap.position_m)
    motion = np.column_stack([model.motion_at(centre - arm * aft, "wing-right"), np.zeros(6)])
    motion[3:, -1] = tangent
    at_centre = fe.rigid_transfer(arm * aft) @ motion
    mass, stiffness = (np.pad(m, (0, 1)) for m in (model.mass, model.stiffness))
    # The rig gives a lump of no stated inertia a radius of gyration of a millimetre.
    mass = mass + fe.inertia_term(at_centre, flap.mass_kg, flap.mass_kg * 1e-6 * np.eye(3))
    stiffness[-1, -1] += 1 / compliance
    expected = fe.natural_modes(mass, stiffness)[0]
    loose = truth_of(with_effect(hati, "control-surface", compliance_rad_per_n_m=compliance, arm_m=arm)).bare.band(
        3.0, 40.0
    )
    np.testing.assert_allclose(loose.natural_frequency_hz, expected[6 : 6 + len(loose)], rtol=0.01)
    assert "1st flap" in loose.labels


def test_a_stiff_hinge_is_the_aircraft_as_it_was(hati: Scenario) -> None:
    """As the compliance goes to nothing so does the effect; the hung flap stays level."""
    stiff = with_effect(hati, "control-surface", compliance_rad_per_n_m=1e-3, side="both")
    np.testing.assert_allclose(elastic(stiff), elastic(hati), rtol=4e-3)
    # Structural damping is that of the airframe with the flap locked: without its mass ratios would be 0.6 % off.
    ratios = [truth_of(s).bare.band(3.0, 40.0).damping_ratio for s in (stiff, hati)]
    np.testing.assert_allclose(*ratios, rtol=1e-3)
    layout = plans(with_effect(hati, "control-surface", compliance_rad_per_n_m=20.0))[0]
    rig = hung_rig(layout, 0)
    flaps = [j for j in range(rig.model.njnt) if rig.model.joint(j).name.endswith("/flap")]
    assert len(flaps) == 1
    assert abs(rig.qpos[flaps[0]]) < 0.01


def test_entrained_air_lowers_bending_by_its_mass_and_damps_by_its_drag() -> None:
    """f ∝ (m + ¼πρc²)^-½ and ζ = c_d c/(2 (m + m_a) ω) for a uniform beam, whatever its shape."""
    beam, chord, drag = UniformBeam(), 0.3, 2.0
    scenario = virtual_test(cantilever(beam, cells=16), beam.length_m, mirror=False)
    still = truth_of(scenario).bare.band(0.5, 30.0)
    moving = truth_of(with_effect(scenario, "entrained-air", mass_fraction=1.0, drag_n_s_per_m3=drag)).bare.band(
        0.5, 30.0
    )
    air = 0.25 * np.pi * 1.225 * chord**2
    ratio = mode(moving, "1st bending")[0] / mode(still, "1st bending")[0]
    assert ratio == pytest.approx(np.sqrt(beam.mass_kg_per_m / (beam.mass_kg_per_m + air)), rel=1e-4)
    frequency, damping = mode(moving, "1st bending")
    expected = drag * chord / (2 * (beam.mass_kg_per_m + air) * 2 * np.pi * frequency)
    assert damping - mode(still, "1st bending")[1] == pytest.approx(expected, rel=0.02)


def test_entrained_air_has_inertia_and_no_weight(hati: Scenario) -> None:
    """A swept wing's air lies aft of its axis: as long as it had weight it tipped the hung aircraft by 7 degrees."""
    airy = with_effect(hati, "entrained-air", mass_fraction=1.0, drag_n_s_per_m3=0.0)
    still, moving = (plans(scenario)[0] for scenario in (hati, airy))
    at_rest = [structure(layout, layout.grid).equilibrium for layout in (still, moving)]
    np.testing.assert_allclose(at_rest[1], at_rest[0], atol=1e-9)
    weighed = [rigid_body(bare_rig(layout)) for layout in (still, moving)]
    assert weighed[1].mass_kg == pytest.approx(weighed[0].mass_kg, abs=1e-12)
    # Lifted as a whole it is heavier by the quarter disc of every chord, of both wings.
    lifted = [structure(layout, layout.grid).mass[2, 2] for layout in (still, moving)]
    wings = [b for b in expanded_beams(hati.airframe) if b.stations.forward_edge_m]
    assert len(wings) == 2
    squares = sum(squared_chord_m3(b) for b in wings)
    assert lifted[1] - lifted[0] == pytest.approx(0.25 * np.pi * 1.225 * squares, rel=2e-4)


@pytest.mark.parametrize("name", ["hati-unsymmetric", "skoll-gvt1"])
def test_a_tapering_wing_carries_the_discs_of_its_own_chords(name: str) -> None:
    """The chord is linear between stations, its square is not: 0.54 % too much air were carried by straight lines."""
    scenario = load_scenario(name)
    airy = made("entrained-air", mass_fraction=1.0).act(scenario, 0).scenario
    assert airy is not None
    for beam, moving in zip(scenario.airframe.beam, airy.airframe.beam, strict=True):
        if not beam.stations.forward_edge_m or beam.parent != "body":
            continue
        air = np.trapezoid(moving.stations.air_kg_per_m, beam_axis(moving).arc_length_m)
        assert air == pytest.approx(0.25 * np.pi * 1.225 * squared_chord_m3(beam), rel=2e-4)
        # Nothing else of the beam has changed: it is as long, as heavy and as soft.
        for column in ("mass_kg_per_m", "pitch_inertia_kg_m", "forward_edge_m", "bending_stiffness_n_m2"):
            of = [np.trapezoid(getattr(b.stations, column), beam_axis(b).arc_length_m) for b in (beam, moving)]
            assert of[1] == pytest.approx(of[0], rel=1e-12)
        assert beam_axis(moving).arc_length_m[-1] == pytest.approx(beam_axis(beam).arc_length_m[-1], rel=1e-12)


def test_a_beam_is_cut_for_its_air_once_however_much_it_carries() -> None:
    """Cutting is most of the work, and a scan asks for hundreds of sizes; a beam of other chords is another beam."""
    scenario = load_scenario("hati-unsymmetric")
    wing = scenario.airframe.beam[0]
    wider = with_columns(wing, aft_edge_m=[2 * c for c in wing.stations.aft_edge_m or ()])
    wide = with_beams(scenario, (wing.name,), lambda _: wider)
    some, more, of_wide = (
        made("entrained-air", mass_fraction=m).act(s, 0).scenario
        for m, s in ((0.5, scenario), (1.0, scenario), (1.0, wide))
    )
    assert some is not None and more is not None and of_wide is not None
    one, other, third = (s.airframe.beam[0].stations for s in (some, more, of_wide))
    assert one.air_kg_per_m and other.air_kg_per_m and third.air_kg_per_m
    assert one.position_m is other.position_m
    np.testing.assert_allclose(other.air_kg_per_m, 2 * np.array(one.air_kg_per_m), rtol=1e-12)
    assert third.air_kg_per_m[0] > 1.5 * other.air_kg_per_m[0]


def squared_chord_m3(beam: Beam) -> float:
    """The integral of c² along a beam: of a chord that is linear between stations, (a² + a b + b²)/3 a length."""
    chord, arc = chord_m(beam.stations), beam_axis(beam).arc_length_m
    inner, outer = chord[:-1], chord[1:]
    return float((np.diff(arc) * (inner**2 + inner * outer + outer**2) / 3).sum())


def test_air_that_is_stated_and_air_that_is_missing_add_up(hati: Scenario) -> None:
    half = with_effect(hati, "entrained-air", mass_fraction=0.5, drag_n_s_per_m3=0.0)
    stated = make_effect("entrained-air", "test", mass_fraction=0.5, drag_n_s_per_m3=0.0).act(hati, 0).scenario
    assert stated is not None
    whole = with_effect(hati, "entrained-air", mass_fraction=1.0, drag_n_s_per_m3=0.0)
    twice = with_effect(stated, "entrained-air", mass_fraction=0.5, drag_n_s_per_m3=0.0)
    of = [
        truth_of(scenario).as_tested[0].band(3.0, 55.0).natural_frequency_hz
        for scenario in (half, stated, whole, twice)
    ]
    np.testing.assert_allclose(of[0], of[1], rtol=1e-12)
    np.testing.assert_allclose(of[2], of[3], rtol=1e-9)
    assert np.abs(of[2] / of[0] - 1).max() > 1e-3


def test_entrained_air_needs_a_chord(hati: Scenario) -> None:
    wing = hati.airframe.beam[0]
    bare = wing.model_copy(
        update={"stations": wing.stations.model_copy(update={"forward_edge_m": None, "aft_edge_m": None})}
    )
    edgeless = hati.model_copy(update={"airframe": hati.airframe.model_copy(update={"beam": (bare,)})})
    with pytest.raises(InputError, match="chord"):
        made("entrained-air", mass_fraction=1.0).act(edgeless, 0)


def test_a_local_dashpot_damps_by_the_square_of_the_shape_and_turns_shapes_complex(hati: Scenario) -> None:
    """Δζ = c φ²/(2 m_r ω) of the plain modes; shapes are no longer in phase."""
    damper, node = 0.3, tips(hati)[0]
    place = {p.dof.node: p.position_m for p in plans(hati)[0].grid}[node]
    rubbed = with_effect(
        hati, "nonproportional-damper", damping_n_s_per_m=damper, x_m=float(place[0]), y_m=float(place[1])
    )
    plain, damped = truth_of(hati).bare.band(3.0, 40.0), truth_of(rubbed).bare.band(3.0, 40.0)
    index = [d.node for d in plain.dofs].index(node)
    omega = 2 * np.pi * plain.natural_frequency_hz
    expected = damper * plain.shapes[:, index].real ** 2 / (2 * plain.modal_mass_kg * omega)
    np.testing.assert_allclose(damped.damping_ratio - plain.damping_ratio, expected, rtol=0.05)
    assert np.abs(damped.shapes.imag).max() > 10 * np.abs(plain.shapes.imag).max()
