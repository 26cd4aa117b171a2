"""A hung aircraft driven by its shaker at one frequency: stepped by the engine, and as a linear system with laws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from harmonic_balance import Array, Complex, Vibrator
from hung_hati import hung_hati

from vgvt.effects import Effect
from vgvt.effects.conformance import with_effect
from vgvt.scenario import Scenario
from vgvt.simulation.assembly import Plan, bare_rig, driven_rig, plans
from vgvt.simulation.linear import linearise
from vgvt.simulation.mujoco_engine import step_runs
from vgvt.simulation.state_space import StateSpace, state_space
from vgvt.simulation.stepping import substeps

RATE_HZ = 1000.0
ROOTS = ("wing-right-root", "wing-left-root")
TIP, FORCE = 1, -1
"""Rows of the outputs: the accelerometer of the ratio that is judged, and the force."""


@dataclass(frozen=True, eq=False)
class Shaken:
    """The linear aircraft, its plan, and the static angles (J,) of its root joints under the effect."""

    layout: Plan
    model: StateSpace
    rest_rad: Array


def jointed_hati(kind: str, stiffness_n_m_per_rad: float) -> Scenario:
    """Hung Hati with six links a wing and a linear spring at the wing's root."""
    hati = hung_hati()
    field = {"bending": "root_bending_stiffness_n_m_per_rad", "torsion": "root_torsional_stiffness_n_m_per_rad"}[kind]
    wing = hati.airframe.beam[0].model_copy(update={"cells": 6, field: stiffness_n_m_per_rad})
    return hati.model_copy(update={"airframe": hati.airframe.model_copy(update={"beam": (wing,)})})


def shaken(scenario: Scenario, effect: Effect | None, kind: str) -> Shaken:
    """The linear model of the scenario without the effect, and where its joints rest with it."""
    layout = plans(scenario)[0]
    rig = driven_rig(layout, 0)
    resting = rig if effect is None else driven_rig(plans(with_effect(scenario, effect))[0], 0)
    rest = [resting.qpos[resting.model.joint(f"{root}/{kind}").qposadr[0]] for root in ROOTS]
    return Shaken(layout, state_space(layout, rig, layout.run_points(0)), np.array(rest))


def vibrator(aircraft: Shaken, rows: Array) -> Vibrator:
    """The aircraft with generalised forces along ``rows`` (J, nv), which also give the motion they depend on."""
    model = aircraft.model
    inertia = np.linalg.inv(model.linear.mass)
    pushed = inertia @ rows.T
    # The accelerometers feel a force's acceleration at once; roots are too far from the drive for its small inertia.
    drive = aircraft.model.linear.displacement @ pushed
    passed = np.vstack([drive, np.zeros((1, rows.shape[0]))])
    nothing = np.zeros_like(rows)
    return Vibrator(
        state=model.state_matrix,
        command=model.input_matrix,
        entry=np.vstack([np.zeros_like(pushed), pushed]),
        select=np.hstack([rows, nothing]),
        output=model.output_matrix,
        feedthrough=model.feedthrough,
        passed=passed,
    )


def joint_rows(aircraft: Shaken, kind: str) -> Array:
    """Unit rows (2, nv) of the two root joints."""
    model = driven_rig(aircraft.layout, 0).model
    rows = np.zeros((len(ROOTS), aircraft.model.linear.freedoms))
    for k, root in enumerate(ROOTS):
        rows[k, model.joint(f"{root}/{kind}").dofadr[0]] = 1.0
    return rows


def stepped(
    scenario: Scenario,
    effect: Effect | None,
    cases: list[tuple[float, float]],
    seconds: float,
    step_s: float | None = None,
    harmonics: int = 5,
) -> Complex:
    """Fourier coefficients (cases, outputs, harmonics + 1) of the last second that the engine records.

    A case is (Hz, V); the command grows over the first second, in which also the aircraft starts to move.
    """
    whole = scenario if effect is None else with_effect(scenario, effect)
    runs = whole.acquisition.run_nodes * len(cases)
    whole = whole.model_copy(update={"acquisition": whole.acquisition.model_copy(update={"runs": runs})})
    layouts = plans(whole)
    rigs = [driven_rig(layout, run) for run, layout in enumerate(layouts)]
    model = state_space(layouts[0], rigs[0], layouts[0].run_points(0))
    count = substeps(np.linalg.eigvals(model.state_matrix), RATE_HZ, step_s or scenario.simulation.step_s)
    time = np.arange(round(seconds * RATE_HZ) * count + 1) / (RATE_HZ * count)
    grown = np.sin(0.5 * np.pi * np.minimum(time, 1.0)) ** 2
    commands = [(volts * grown * np.cos(2 * np.pi * hz * time))[None] for hz, volts in cases]
    for rig in rigs:
        rig.model.opt.timestep = 1.0 / (RATE_HZ * count)
    records = step_runs(layouts, rigs, commands, count, RATE_HZ)
    return np.array([coefficients(record, hz, harmonics) for record, (hz, _) in zip(records, cases, strict=True)])


def coefficients(record: Array, hz: float, harmonics: int) -> Complex:
    """Least-squares Fourier coefficients (outputs, harmonics + 1), beside a slow drift, of whole cycles at the end."""
    length = round(round(1.5 * hz) / hz * RATE_HZ)
    time = np.arange(record.shape[1])[-length:] / RATE_HZ
    angle = 2 * np.pi * hz * np.outer(time, np.arange(1, harmonics + 1))
    drift = np.vander((time - time.mean()) / np.ptp(time), 4)
    columns = np.hstack([np.cos(angle), -np.sin(angle), drift])
    fitted = np.linalg.lstsq(columns, record[:, -length:].T, rcond=None)[0]
    tones = fitted[:harmonics] + 1j * fitted[harmonics : 2 * harmonics]
    return np.asarray(np.vstack([fitted[-1:] + 0j, tones]).T)


def mode_rows(aircraft: Shaken) -> Array:
    """Rows (modes, nv) that give the mass-normalised coordinates of the bare airframe's exactly damped modes: M φ."""
    rig = bare_rig(aircraft.layout)
    bare = linearise(rig.model, rig.qpos)
    eigenvalues, shapes = scipy.linalg.eigh(bare.stiffness, bare.mass)
    limit = 2 * np.pi * aircraft.layout.scenario.airframe.damping.limit_hz
    chosen = shapes[:, 6:][:, eigenvalues[6:] <= limit**2]
    rows = np.zeros((chosen.shape[1], aircraft.model.linear.freedoms))
    # The bare airframe's coordinates come first in the driven rig; carried masses add none.
    rows[:, : bare.freedoms] = (bare.mass @ chosen).T
    return rows
