"""A structure without its sensors' inertia hangs under their weight: with them it is what the simulator calls true."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.optimize
from scipy.spatial.transform import Rotation

from vgvt.effects.beams import with_beams
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.mass import rigid_body_properties
from vgvt.simulation.reduced import Layouts, structure
from vgvt.simulation.truth import truth_of


def heavy(mass_kg: float, runs: tuple[tuple[int, ...], ...]) -> Scenario:
    """The bundled quick aircraft with sensors of a mass, on the points of every run."""
    whole = load_scenario("quick")
    return whole.model_copy(
        update={
            "accelerometers": whole.accelerometers.model_copy(update={"mass_kg": mass_kg}),
            "acquisition": whole.acquisition.model_copy(update={"runs": runs}),
        }
    )


def instrumented_hz(scenario: Scenario, nodes: tuple[int, ...]) -> np.ndarray:
    """Natural frequencies in the band of the structure with the inertia of sensors at ``nodes``."""
    layouts = Layouts.of(scenario)
    layout = layouts.plan(scenario)
    s = structure(layout, layout.grid)
    mass = s.mass.copy()
    for point, moved in zip(layout.grid, s.jacobian, strict=True):
        if point.dof.node in nodes:
            mass += scenario.accelerometers.mass_kg * moved.T @ moved
    n = s.drive.size
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n], system[n:, n:] = (-np.linalg.solve(mass, k) for k in (s.stiffness, s.damping))
    poles = scipy.linalg.eigvals(system)
    return np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)


def true_hz(scenario: Scenario, run: int) -> np.ndarray:
    return np.sort(truth_of(scenario).as_tested[run].natural_frequency_hz)


EVERY = tuple(range(1, 21))


def rigid_hz(scenario: Scenario, sensors: np.ndarray) -> np.ndarray:
    """Frequencies (6,) of a rigid aircraft with point masses at ``sensors`` (P, 3) on its spring, by its energy alone.

    Without the simulator: the potential of weight, spring and yaw spring is minimised, and its curvature held against
    the kinetic energy of mass and inertia.
    """
    hull, g = rigid_body_properties(scenario.airframe), 9.80665
    spring, place = scenario.suspension, np.array(scenario.shaker.position_m)
    points = [(hull.mass_kg, hull.centre_of_gravity_m), (scenario.transducer.mass_kg, place)]
    points += [(scenario.accelerometers.mass_kg, p) for p in sensors]
    masses = np.array([m for m, _ in points])
    mass, centre = masses.sum(), np.average([p for _, p in points], axis=0, weights=masses)
    inertia = np.array(hull.inertia_kg_m2, dtype=float)
    for m, p in points:
        arm = p - centre
        inertia = inertia + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    hook = np.array(spring.hook_m) - centre
    above_m = spring.free_length_m + mass * g / spring.stiffness_n_per_m
    top = np.array(spring.hook_m) + np.array([0.0, 0.0, above_m])

    def energy(q: np.ndarray) -> float:
        turned = Rotation.from_rotvec(q[3:])
        stretch = np.linalg.norm(top - centre - q[:3] - turned.apply(hook)) - spring.free_length_m
        yaw = turned.as_euler("ZYX")[0]
        weight = mass * g * q[2]
        return float(
            weight + 0.5 * spring.stiffness_n_per_m * stretch**2 + 0.5 * spring.yaw_stiffness_n_m_per_rad * yaw**2
        )

    rest = scipy.optimize.minimize(energy, np.zeros(6), method="BFGS", options={"gtol": 1e-9}).x
    step, aside = 1e-3, 1e-3 * np.eye(6)
    curvature = np.array([
        [sum(i * j * energy(rest + i * a + j * b) for i in (1, -1) for j in (1, -1)) for b in aside] for a in aside
    ]) / (4 * step**2)  # fmt: skip
    # How the aircraft, which hangs nose down by some degrees, turns about its own axes as the rotation vector changes.
    (x, y, z), angle = rest[3:], float(np.linalg.norm(rest[3:]))
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) - (1 - np.cos(angle)) / angle**2 * cross + (angle - np.sin(angle)) / angle**3 * cross @ cross
    kinetic = np.zeros((6, 6))
    kinetic[:3, :3] = mass * np.eye(3)
    kinetic[3:, 3:] = turn.T @ inertia @ turn
    return np.sqrt(scipy.linalg.eigh(curvature, kinetic, eigvals_only=True)) / (2 * np.pi)


def test_a_rigid_aircraft_swings_as_its_energy_says() -> None:
    """Against no simulator: 20 sensors of 22 g, whose weight tilts it by 14 degrees and is in every swing."""
    flexible = heavy(0.0224, (EVERY,))
    stiff = with_beams(
        flexible,
        ["wing"],
        lambda b: b.model_copy(update={"stations": b.stations.model_copy(update={
            name: tuple(1e4 * v for v in getattr(b.stations, name))
            for name in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2")
        })}),
    )  # fmt: skip
    scenario = stiff.model_copy(
        update={
            "transducer": stiff.transducer.model_copy(update={"mass_kg": 0.01, "end_mass_kg": 0.01}),
            "stinger": stiff.stinger.model_copy(update={"mass_kg": 1e-9}),
        }
    )
    places = np.array([p.position_m for p in Layouts.of(scenario).plan(scenario).grid if p.dof.node in EVERY])
    assert len(places) == len(EVERY)
    found = np.sort(instrumented_hz(scenario, EVERY))[:6]
    np.testing.assert_allclose(found, rigid_hz(scenario, places), rtol=2e-4)


def test_the_weight_of_sensors_that_stay_is_in_the_structure() -> None:
    """The aircraft's swings too, which are 2 % off without it; the first bending is by 0.15 %."""
    scenario = heavy(0.0112, (EVERY,))
    np.testing.assert_allclose(instrumented_hz(scenario, EVERY)[:12], true_hz(scenario, 0)[:12], rtol=1e-6)


def test_of_sensors_that_rove_the_mean_weight_is() -> None:
    """With every second sensor the first bending is 0.03 % off to either side; without weight, both to one."""
    runs = (EVERY[::2], EVERY[1::2])
    scenario = heavy(0.0112, runs)
    apart = [instrumented_hz(scenario, nodes)[6] / true_hz(scenario, r)[6] - 1 for r, nodes in enumerate(runs)]
    assert abs(np.mean(apart)) < 5e-6
    assert np.abs(apart).max() < 4e-4
