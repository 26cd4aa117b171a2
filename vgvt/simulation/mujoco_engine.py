"""The mujoco engine: all runs of the campaign stepped together on a thread pool, Python outside the time loop."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace

import mujoco
import mujoco.batch
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.assembly import Plan, Rig
from vgvt.simulation.compiled_dampers import compiled_dampers
from vgvt.simulation.rig import HAMMER, STINGER, numbered
from vgvt.simulation.seats import MeasurementPoint
from vgvt.simulation.silence import silent
from vgvt.simulation.state_space import exciter_names, mass_above_element_kg

Progress = Callable[[float, str], None]
# Long enough that the loop over chunks costs nothing, short enough for progress and Ctrl-C.
_CHUNK_SAMPLES = 1000
_SIZES = ("nsensordata", "nq", "nv", "na", "nu", "nbody", "njnt", "nsite", "ntendon", "nwrap", "neq", "nM", "nJten")
# No reading of a real test comes near (m/s^2, N, m): beyond it, or at NaN, the integration has blown up.
_DIVERGED = 1e6


def step_runs(
    layouts: list[Plan],
    rigs: list[Rig],
    commands_v: list[NDArray[np.float64]],
    steps_per_sample: int,
    sample_rate_hz: float,
    progress: Progress | None = None,
    threads: int | None = None,
) -> list[NDArray[np.float64]]:
    """Accelerations and forces, (points + forces, samples) a rig, at the sampling instants.

    ``commands_v`` holds each run's inputs at every time step, (inputs, (samples - 1) * steps_per_sample + 1): the
    commands of the shakers, V, or the force of the hammer, N.
    Accelerations are those of the run's points less their value at rest, in
    m/s^2; the last rows are the forces at the transducers' sensing elements, N.
    Raises FloatingPointError where a run diverges.
    """
    # One batch shares the layout of its arrays: runs with as many accelerometers, bodies and springs go together.
    groups: dict[tuple[int, ...], list[int]] = {}
    for run, rig in enumerate(rigs):
        groups.setdefault(tuple(getattr(rig.model, size) for size in _SIZES), []).append(run)
    readings: dict[int, NDArray[np.float64]] = {}
    for k, runs in enumerate(groups.values()):
        models, steps = [rigs[run].model for run in runs], commands_v[runs[0]].shape[-1]
        with silent(), compiled_dampers(models, steps) as stepped:
            kept = _step_together(
                [replace(rigs[run], model=model) for run, model in zip(runs, stepped, strict=True)],
                np.array([commands_v[run] for run in runs]),
                exciter_names(layouts[runs[0]]),
                steps_per_sample,
                sample_rate_hz,
                layouts[runs[0]].scenario.excitation.before_record_s,
                _share(progress, k, len(groups)),
                threads,
            )
        readings |= {run: _readings(layouts[run], rigs[run], run, kept[i]) for i, run in enumerate(runs)}
    return [readings[run] for run in range(len(rigs))]


def _step_together(
    rigs: list[Rig],
    command_v: NDArray[np.float64],
    exciters: tuple[tuple[str, ...], ...],
    steps_per_sample: int,
    sample_rate_hz: float,
    before_record_s: float,
    progress: Progress | None,
    threads: int | None,
) -> NDArray[np.float64]:
    """Sensor readings (rigs, samples, nsensordata) of models with equal sizes."""
    threads = threads or min(len(rigs), os.cpu_count() or 1)
    batch = mujoco.batch.Batch(rigs[0].model, nsim=len(rigs), nthread=threads)
    batch.set_models([rig.model for rig in rigs])
    batch.bind("qpos")[:] = np.array([rig.qpos for rig in rigs])
    # The actuator integrates: its control is the command's rate of change, its activation the command itself.
    rate = np.diff(command_v, append=command_v[..., -1:]) * (steps_per_sample * sample_rate_hz)
    # Effects may have actuators of their own, which start from rest: they are sent 1 while the record runs.
    driving = [(k, rigs[0].model.actuator(name)) for k, names in enumerate(exciters) for name in names]
    inputs = [k for k, _ in driving]
    activation = np.zeros((len(rigs), rigs[0].model.na))
    activation[:, [actuator.actadr[0] for _, actuator in driving]] = command_v[:, inputs, 0]
    batch.bind("act")[:] = activation
    samples = (command_v.shape[2] - 1) // steps_per_sample + 1
    kept = np.empty((len(rigs), samples, rigs[0].model.nsensordata))
    begin, done = round(before_record_s * sample_rate_hz) * steps_per_sample, 0
    while done < samples:
        count = min(_CHUNK_SAMPLES, samples - done)
        start = done * steps_per_sample
        driven = rate[..., start : start + count * steps_per_sample].transpose(0, 2, 1)
        chunk = np.zeros((*driven.shape[:2], rigs[0].model.nu))
        chunk[:, max(begin - start, 0) :] = 1.0
        chunk[..., [actuator.id for _, actuator in driving]] = driven[..., inputs]
        record = batch.rollout(chunk.shape[1], control=chunk, record=("sensordata",))["sensordata"]
        kept[:, done : done + count] = record[:, ::steps_per_sample]
        done += count
        sound = np.abs(kept[:, done - count : done]).max(initial=0.0) < _DIVERGED
        if not sound:
            raise FloatingPointError(
                f"the simulation diverged before {done / sample_rate_hz:.2f} s of the record; the drive is too strong "
                "for this aircraft, or simulation.step_s too long"
            )
        if progress is not None:
            progress(done / samples, f"{done / sample_rate_hz:.0f} s of {samples / sample_rate_hz:.0f} s simulated")
    return kept


def _share(progress: Progress | None, part: int, parts: int) -> Progress | None:
    if progress is None or parts == 1:
        return progress
    return lambda fraction, message: progress((part + fraction) / parts, message)


def _readings(layout: Plan, rig: Rig, run: int, sensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn MuJoCo's sensors (samples, nsensordata) into accelerations along the DOFs and the measured force."""
    model = rig.model

    def acceleration(point: MeasurementPoint) -> NDArray[np.float64]:
        felt = np.zeros(sensors.shape[0])
        for site, weight in point.weighted_sites:
            address = model.sensor(site).adr[0]
            felt += sensors[:, address : address + 3] @ (weight * point.axis)
        return felt

    points = layout.run_points(run)
    rows = [acceleration(p) for p in points]
    if layout.strike is not None:
        hammer = layout.scenario.hammer
        assert hammer is not None, "only a hammer strikes"
        rows.append(hammer.reading * sensors[:, model.sensor(HAMMER).adr[0]])
    for k, drive in enumerate(layout.drives if layout.strike is None else ()):
        push = _stinger_push(layout, rig, sensors, k)
        rows.append(push - mass_above_element_kg(layout) * acceleration(drive))
    readings = np.array(rows)
    return np.asarray(readings - readings[:, :1])


def _stinger_push(layout: Plan, rig: Rig, sensors: NDArray[np.float64], exciter: int) -> NDArray[np.float64]:
    """What a stinger pushes with, N, (samples,), and what its gauge feels of moments."""
    stinger, rod = layout.scenario.stinger, numbered(STINGER, exciter)

    def of(name: str) -> NDArray[np.float64]:
        return np.asarray(sensors[:, rig.model.sensor(name).adr[0]])

    push = -stinger.axial_stiffness_n_per_m * (of(f"{rod}-length") - stinger.length_m)
    push -= stinger.axial_damping_n_s_per_m * of(f"{rod}-rate")
    for name, spring in layout.gauged_springs(exciter):
        moment = -spring.stiffness_n_m_per_rad * of(f"{name}-length") - spring.damping_n_m_s_per_rad * of(
            f"{name}-rate"
        )
        push += spring.gauge_per_m * moment
    return push
