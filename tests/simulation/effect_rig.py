"""A small rig to try effects on, and what the linear model says of it: FRFs, modes, entries of shapes."""

from __future__ import annotations

from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray
from small_rig import revised

from vgvt.data import ModalModel
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import Rig, driven_rig, plans
from vgvt.simulation.reduced import Structure
from vgvt.simulation.state_space import state_space

Complex = NDArray[np.complex128]
FREQUENCY_HZ = np.linspace(4.0, 34.0, 121)
FORE, AFT, BESIDE, OFFSET, WING, TIP = 201, 202, 203, 204, 1, 10
DRIVE = 100
SHIFT_M = (0.02, -0.015)


@lru_cache(maxsize=1)
def effect_rig() -> Scenario:
    """Hati with six links a wing; sensors at the drive point, on the body, and on the wing; clean instruments."""
    whole = load_scenario("hati-unsymmetric")
    x, y, z = whole.shaker.position_m
    grid = whole.accelerometers.grid
    wing, tip = grid.node.index(WING), grid.node.index(TIP)
    places = {
        WING: (grid.x_m[wing], grid.y_m[wing], 0.0, f"wing-{_side(grid.y_m[wing])}"),
        TIP: (grid.x_m[tip], grid.y_m[tip], 0.0, f"wing-{_side(grid.y_m[tip])}"),
        FORE: (0.45, 0.0, z, "body"),
        AFT: (0.70, 0.0, z, "body"),
        BESIDE: (0.45, 0.15, z, "body"),
        OFFSET: (x + SHIFT_M[0], y + SHIFT_M[1], z, "body"),
    }
    columns = {
        "node": tuple(places),
        "direction": None,
        **{name: tuple(p[k] for p in places.values()) for k, name in enumerate(("x_m", "y_m", "z_m", "attached_to"))},
    }
    beam = whole.airframe.beam[0].model_copy(update={"cells": 6})
    clean: dict[str, object] = {"noise": None, "high_pass_hz": 0.0}
    return revised(
        whole,
        airframe={"beam": (beam,)},
        accelerometers={**clean, "mass_kg": 0.0, "grid": grid.model_copy(update=columns)},
        transducer=clean,
        acquisition={"runs": ((WING, TIP, FORE, AFT),), "sample_rate_hz": 500.0, "bits": 32, "noise_v_per_rthz": 0.0},
        excitation={
            "start_hz": 2.0,
            "stop_hz": 36.0,
            "duration_s": 6.0,
            "amplitude_v": 0.05,
            "taper_s": 0.5,
            "ring_down_s": 18.0,
        },
    )


def _side(y_m: float) -> str:
    return "right" if y_m > 0 else "left"


def having(scenario: Scenario, effect: str, **parameters: object) -> Scenario:
    """The scenario with one effect."""
    return scenario.model_copy(update={"effect": (EffectTable(name=effect, **parameters),)})


def responses(scenario: Scenario) -> tuple[Complex, Complex]:
    """Accelerance of the first run's sensors and, last, of the drive point (sensors + 1, lines), and force per volt."""
    layout = plans(scenario)[0]
    model = state_space(layout, driven_rig(layout, 0), (*layout.run_points(0), layout.drive))
    identity = np.eye(model.input_matrix.size)
    states = [np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.input_matrix) for f in FREQUENCY_HZ]
    outputs = np.array(states) @ model.output_matrix.T + model.feedthrough
    return (outputs[:, :-1] / outputs[:, -1:]).T, outputs[:, -1]


def accelerance(s: Structure) -> Complex:
    """What weightless sensors read per force, (sensors, lines), by direct solution."""
    omega = 2 * np.pi * FREQUENCY_HZ[:, None, None]
    motion = np.linalg.solve(s.stiffness + 1j * omega * s.damping - omega**2 * s.mass, s.drive[None, :, None])
    return np.asarray(((s.tilt - omega**2 * s.axis) @ motion)[..., 0].T)


def elastic(scenario: Scenario) -> ModalModel:
    """The true modes of the first run between 5 and 40 Hz."""
    return truth_of(scenario).as_tested[0].band(5.0, 40.0)


def largest_error(got: Complex, wanted: Complex) -> float:
    """Largest difference, relative to the channel's typical size."""
    return float((np.abs(got - wanted) / np.median(np.abs(wanted), axis=-1, keepdims=True)).max())


def clear_error(got: Complex, wanted: Complex) -> float:
    """Largest relative difference away from antiresonances."""
    clear = np.abs(wanted) > 0.2 * np.median(np.abs(wanted), axis=-1, keepdims=True)
    return float(np.abs(got / wanted - 1)[clear].max())


def entry(modes: ModalModel, node: int) -> NDArray[np.float64]:
    """The real shapes at a node, (modes,), with unit modal mass."""
    row = [dof.node for dof in modes.dofs].index(node)
    assert modes.modal_mass_kg is not None
    return np.real(modes.shapes[:, row]) / np.sqrt(modes.modal_mass_kg)


def at_rest(rig: Rig) -> mujoco.MjData:
    """The state of a rig at its equilibrium."""
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    mujoco.mj_forward(rig.model, data)
    return data
