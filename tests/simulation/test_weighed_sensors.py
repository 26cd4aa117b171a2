"""A structure without its sensors' inertia hangs under their weight: with them it is what the simulator calls true."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from vgvt.scenario import Scenario, load_scenario
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
