"""A lab that differs from its scenario as far as the tolerances allow, and no further: what a placebo is made of.

Its parametrisation is not the analysis': piecewise-linear factors along each side of every beam, at one station more
than the unknowns of the whole band have, and so at other ones, and many more cells, as no aircraft has any.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, ChannelRole
from vgvt.effects.beams import plain_name, with_airframe, written_out
from vgvt.reconcile.question.stretches import with_stretches
from vgvt.scenario.airframe import Beam, Body, Damping, Item
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.model import Scenario
from vgvt.scenario.tolerances import Tolerances

# Five times as many as the analysis has as far as that is many; twice as many where it has many itself.
_FINER, _MANY, _AT_LEAST = 5, 60, 2


def drawn_lab(scenario: Scenario, generator: np.random.Generator, cells: int | None = None) -> Scenario:
    """An aircraft and a rig that the scenario's tolerances allow, with instruments as stated.

    ``cells`` of every beam; when left out up to five times as many as stated. Effects of the scenario stay as they are.
    Whether such an aircraft hangs, whoever simulates it finds out.
    """
    t, g = scenario.tolerances, generator
    split = written_out(scenario)
    whole = {"bending_stiffness_n_m2": t.stiffness_scale, "torsional_stiffness_n_m2": t.stiffness_scale}
    whole["pitch_inertia_kg_m"] = t.inertia
    # Both sides alike, and each beam by itself.
    common = {
        beam: {column: _factor(g, sd) for column, sd in whole.items()}
        for beam in dict.fromkeys(plain_name(b.name) for b in split.airframe.beam)
    }
    along = {"bending_stiffness_n_m2": t.stiffness_segment, "torsional_stiffness_n_m2": t.stiffness_segment}
    along["mass_kg_per_m"] = t.mass_segment
    count = with_stretches(scenario, math.ceil(scenario.excitation.band_hz[1])).tolerances.stations
    # Where nothing varies along a beam, nothing does.
    stations, along = count + 1, along if count else {}
    beams = tuple(
        _with_cells(_scattered(b, common[plain_name(b.name)], along, stations, g), cells) for b in split.airframe.beam
    )
    items = _items(split.airframe.item, t, g)
    body = _body(split.airframe.body, t, g)
    damping = _damping(split.airframe.damping, t, g)
    return _rig(with_airframe(split, beam=beams, item=items, body=body, damping=damping), g)


def drawn_gains(campaign: Campaign, tolerances: Tolerances, generator: np.random.Generator) -> Campaign:
    """The records as instruments read them whose sensitivities are within their tolerances.

    The force gauge and each accelerometer, by its place among a run's, keep theirs; each channel of each run scatters
    around it.
    """
    t, g = tolerances, generator
    force = _factor(g, t.gain)
    instruments = np.exp(t.gain * g.standard_normal(max(len(run.channels) for run in campaign.runs)))
    runs = []
    for run in campaign.runs:
        samples, responses = np.array(run.samples, dtype=float), 0
        for k, channel in enumerate(run.channels):
            if channel.role is ChannelRole.REFERENCE:
                samples[k] *= force
            elif channel.role is ChannelRole.RESPONSE:
                samples[k] *= instruments[responses] * _factor(g, t.channel_gain)
                responses += 1
        runs.append(replace(run, samples=samples))
    return replace(campaign, runs=tuple(runs))


def _factor(g: np.random.Generator, sd: float) -> float:
    return float(np.exp(sd * g.standard_normal()))


def _with_cells(beam: Beam, cells: int | None) -> Beam:
    fine = max(_AT_LEAST * beam.cells, min(_FINER * beam.cells, _MANY))
    return beam.model_copy(update={"cells": fine if cells is None else cells})


def _scattered(
    beam: Beam, common: dict[str, float], scatter: dict[str, float], stations: int, g: np.random.Generator
) -> Beam:
    """A side with its stiffness and mass scattered along it, at so many stations, around a common factor."""
    axis = beam_axis(beam)
    knots = np.linspace(0, axis.arc_length_m[-1], stations)
    arcs = np.union1d(axis.arc_length_m, knots)
    arcs = arcs[np.concatenate([[True], np.diff(arcs) > 1e-6])]
    columns: dict[str, object] = {}
    for name in type(beam.stations).model_fields:
        values = getattr(beam.stations, name)
        if name == "position_m":
            points = [np.interp(arcs, axis.arc_length_m, axis.position_m[:, k]) for k in range(3)]
            columns[name] = tuple(tuple(float(v) for v in p) for p in np.array(points).T)
        elif values is not None:
            here = np.interp(arcs, axis.arc_length_m, values) * common.get(name, 1.0)
            if name in scatter:
                here *= np.interp(arcs, knots, np.exp(scatter[name] * g.standard_normal(stations)))
            columns[name] = tuple(float(v) for v in here)
    return beam.model_copy(update={"stations": beam.stations.model_copy(update=columns)})


def _items(items: tuple[Item, ...], t: Tolerances, g: np.random.Generator) -> tuple[Item, ...]:
    """Lumped items; what is mirrored weighs the same on both sides."""
    found, known = [], dict[str, float]()
    for item in items:
        share = known.setdefault(item.name.removesuffix("-right").removesuffix("-left"), _factor(g, t.item_mass))
        found.append(item.model_copy(update={"mass_kg": item.mass_kg * share}))
    return tuple(found)


def _body(body: Body, t: Tolerances, g: np.random.Generator) -> Body:
    x, y, z = body.centre_of_gravity_m
    stated_roll, stated_pitch, stated_yaw = body.inertia_kg_m2
    roll, pitch, _ = (v * _factor(g, t.inertia) for v in body.inertia_kg_m2)
    # A flat body stays one, and any body one that there can be; the yaw's own number keeps the order of all others.
    yaw = max(stated_yaw * (roll + pitch) / (stated_roll + stated_pitch), abs(roll - pitch))
    return body.model_copy(
        update={
            "mass_kg": body.mass_kg * _factor(g, t.body_mass),
            "centre_of_gravity_m": (x + t.body_centre_of_gravity_m * g.standard_normal(), y, z),
            "inertia_kg_m2": (roll, pitch, yaw),
        }
    )


def _damping(damping: Damping, t: Tolerances, g: np.random.Generator) -> Damping:
    return damping.model_copy(
        update={
            "damping_ratio": damping.damping_ratio * _factor(g, t.damping),
            "modal": tuple(ratio * _factor(g, t.damping) for ratio in damping.modal),
        }
    )


def _rig(scenario: Scenario, g: np.random.Generator) -> Scenario:
    """The rig within its tolerances."""
    t = scenario.tolerances

    def scaled(table: str, sd: float, *keys: str) -> dict[str, float]:
        share = _factor(g, sd)
        return {key: getattr(getattr(scenario, table), key) * share for key in keys}

    spring = scaled("suspension", t.suspension_stiffness, "stiffness_n_per_m")
    dampers = ("damping_n_s_per_m", "rotation_damping_n_m_s_per_rad", "pendulum_damping_n_s_per_m")
    spring |= scaled("suspension", t.suspension_damping, *dampers)
    hook = {"hook_m": tuple(np.array(scenario.suspension.hook_m) + t.hook_m * g.standard_normal(3))}
    drive = np.array(scenario.shaker.position_m) + t.drive_point_m * np.array([*g.standard_normal(2), 0.0])
    sensors = scaled("accelerometers", t.sensor_mass, "mass_kg") | scaled("accelerometers", t.high_pass, "high_pass_hz")
    gauge = scaled("transducer", t.transducer_end_mass, "end_mass_kg") | scaled(
        "transducer", t.high_pass, "high_pass_hz"
    )
    changes = {"suspension": spring | hook, "shaker": {"position_m": tuple(drive)}, "accelerometers": sensors}
    changes["transducer"] = gauge
    return scenario.model_copy(update={k: getattr(scenario, k).model_copy(update=v) for k, v in changes.items()})
