"""What the scenario declares as uncertain, as parameters of unit normal prior with edits of the scenario.

Parameter u stands for the factor exp(s u) of a positive quantity, or the shift s u of a signed one, with s the
standard deviation from the scenario's tolerances.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from vgvt.data.shown import headed
from vgvt.effects.beams import plain_name, with_airframe, with_beams, with_columns, written_out
from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.model import Scenario
from vgvt.scenario.recent import Recent

# Shorter beams bend too little for their segments to be told apart: only their common scale varies.
_LONG = 0.5
Edit = Callable[[Scenario, float], Scenario]


# No less than this share of a factor, and no nearer to a bound, in one step.
_LEAST_LEFT, _NEAR_BOUND = 0.1, 0.99


@dataclass(frozen=True, slots=True, eq=False)
class Unknown:
    """One declared uncertainty; ``edit(scenario, amount)`` applies the factor ('log') or the shift ('linear').

    A 'bounded' shift stays within plus and minus 1: it has no meaning beyond.

    ``what`` says it in words; ``nominal`` is the stated value where there is a single one.
    """

    name: str
    what: str
    unit: str
    sd: float
    scale: Literal["log", "linear", "bounded"]
    edit: Edit
    nominal: float | None = None

    def __repr__(self) -> str:
        stated = "" if self.nominal is None else f", {self.nominal:.4g} {self.unit}".rstrip()
        spread = f"{100 * self.sd:.3g} %" if self.scale == "log" else f"{self.sd:.3g} {self.unit}".rstrip()
        return headed(f"Unknown {self.name}: {self.what}{stated} ± {spread}")

    def amount(self, u: float) -> float:
        """The factor or shift that a score u stands for."""
        if self.scale == "bounded":
            return math.tanh(self.sd * u)
        return math.exp(self.sd * u) if self.scale == "log" else self.sd * u

    def rate(self, u: float) -> float:
        """Change of the amount with the score."""
        if self.scale == "bounded":
            return self.sd * (1 - self.amount(u) ** 2)
        return self.sd * (self.amount(u) if self.scale == "log" else 1.0)

    def moved(self, u: float, step: float, origin: float) -> float:
        """The score from u on where the amount changes as a tangent at ``origin`` says for a ``step`` of scores.

        Matrices are linear in amounts, and far from linear in the scores of factors that are far off.
        """
        if self.scale == "linear":
            return u + step
        amount = self.amount(u)
        there = amount + self.rate(origin) * step
        if self.scale == "log":
            return math.log(there) / self.sd if there > _LEAST_LEFT * amount else u + step
        return math.atanh(there) / self.sd if abs(there) < _NEAR_BOUND else u + step

    def change(self, u: float) -> float:
        """The amount's distance from the stated value: factor - 1, or the shift."""
        return self.amount(u) - (1.0 if self.scale == "log" else 0.0)


def unknowns(scenario: Scenario) -> tuple[Unknown, ...]:
    """Every structural quantity that the scenario's tolerances leave open; gains are not among them."""
    airframe = [*_beams(scenario), *_body(scenario), *_items(scenario), *_damping(scenario)]
    return (*(u for u in airframe if u.sd > 0), *unknowns_of_the_rig(scenario))


def unknowns_of_the_rig(scenario: Scenario) -> tuple[Unknown, ...]:
    """Those of them that are no part of the aircraft: suspension, drive point, transducer and sensors."""
    return tuple(u for u in _rig(scenario) if u.sd > 0)


def edited(scenario: Scenario, known: tuple[Unknown, ...], scores: np.ndarray) -> Scenario:
    """The scenario, sides written out, with every unknown at its score, (unknowns,)."""
    changed, stretches = _prepared_recently(scenario), list[tuple[_Stretch, float]]()
    for unknown, u in zip(known, scores, strict=True):
        if u == 0:
            continue
        amount = unknown.amount(float(u))
        # Stations' columns are no other edit's: all at once, where each by itself would copy the whole aircraft.
        if isinstance(unknown.edit, _Stretch):
            stretches.append((unknown.edit, amount))
        else:
            changed = unknown.edit(changed, amount)
    return _stretched(changed, stretches)


def prepared(scenario: Scenario) -> Scenario:
    """The same aircraft with both sides written out and stations where segments meet."""
    split = written_out(scenario)
    names = long_beams(split)
    count = scenario.tolerances.stations
    return with_beams(split, names, lambda beam: _with_stations(beam, count)) if count else split


_prepared_recently: Recent[Scenario, Scenario] = Recent(prepared)


def between_stations(scenario: Scenario) -> tuple[Scenario, tuple[Scenario, ...]]:
    """The scenario with stations in between those of its unknowns, and with each quantity a deviation higher at each.

    What a wing's stiffness and mass do between two of the analysis' stations, no unknown says.
    """
    t, split = scenario.tolerances, prepared(scenario)
    if t.stations < 2:
        return split, ()
    names, count = long_beams(split), 2 * t.stations - 1
    base = with_beams(split, names, lambda beam: _with_stations(beam, count))
    columns = (
        ("bending_stiffness_n_m2", t.stiffness_segment),
        ("torsional_stiffness_n_m2", t.stiffness_segment),
        ("mass_kg_per_m", t.mass_segment),
    )
    stretches = [
        (_Stretch((name,), column, (k, count)), sd)
        for name in names for column, sd in columns if sd > 0 for k in range(1, count, 2)
    ]  # fmt: skip
    return base, tuple(stretch(base, 1 + sd) for stretch, sd in stretches)


def long_beams(scenario: Scenario) -> tuple[str, ...]:
    """Names of the beams long enough to have segments of their own."""
    length = {b.name: float(beam_axis(b).arc_length_m[-1]) for b in scenario.airframe.beam}
    return tuple(n for n in length if length[n] >= _LONG * max(length.values()))


def _with_stations(beam: Beam, count: int) -> Beam:
    axis, stations = beam_axis(beam), beam.stations
    arcs = np.union1d(axis.arc_length_m, np.linspace(0.0, axis.arc_length_m[-1], count))
    arcs = arcs[np.concatenate([[True], np.diff(arcs) > 1e-6 * axis.arc_length_m[-1]])]
    columns: dict[str, object] = {}
    for name in type(stations).model_fields:
        values = getattr(stations, name)
        if name == "position_m":
            points = np.stack([np.interp(arcs, axis.arc_length_m, axis.position_m[:, k]) for k in range(3)], axis=1)
            columns[name] = tuple((float(x), float(y), float(z)) for x, y, z in points)
        elif values is not None:
            columns[name] = tuple(float(v) for v in np.interp(arcs, axis.arc_length_m, values))
    return beam.model_copy(update={"stations": stations.model_copy(update=columns)})


def _beams(scenario: Scenario) -> list[Unknown]:
    t = scenario.tolerances
    split = prepared(scenario)
    long = long_beams(split)
    found: list[Unknown] = []
    for plain in dict.fromkeys(plain_name(b.name) for b in split.airframe.beam):
        names = tuple(b.name for b in split.airframe.beam if plain_name(b.name) == plain)
        for column, what in (("bending_stiffness_n_m2", "EI"), ("torsional_stiffness_n_m2", "GJ")):
            words = f"{what} of the {plain}"
            found.append(_log(f"{what} {plain}", words, t.stiffness_scale, _Stretch(names, column, None)))
        words = f"pitch inertia of the {plain}"
        found.append(_log(f"inertia {plain}", words, t.inertia, _Stretch(names, "pitch_inertia_kg_m", None)))
    for name in long:
        for column, what, sd in (
            ("bending_stiffness_n_m2", "EI", t.stiffness_segment),
            ("torsional_stiffness_n_m2", "GJ", t.stiffness_segment),
            ("mass_kg_per_m", "mass", t.mass_segment),
        ):
            for k in range(t.stations):
                words = f"{what} of the {name}, around station {k + 1} of {t.stations} from the root"
                edit = _Stretch((name,), column, (k, t.stations))
                found.append(_log(f"{what} {name} {k + 1}", words, sd, edit))
    return found


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Scales a ``column`` of some beams by a factor everywhere, or around station k of n with a tent between those."""

    names: tuple[str, ...]
    column: str
    station: tuple[int, int] | None

    def __call__(self, scenario: Scenario, factor: float) -> Scenario:
        return _stretched(scenario, [(self, factor)])

    def share(self, beam: Beam) -> np.ndarray | float:
        """How much of the factor each station (N,) of a beam gets."""
        return 1.0 if self.station is None else _tent(beam_axis(beam).arc_length_m.tobytes(), *self.station)


@lru_cache(maxsize=256)
def _tent(arc: bytes, k: int, count: int) -> np.ndarray:
    """One at knot k of ``count``, none at the others, linear between: at arc lengths (N,), to be read only."""
    arc_m = np.frombuffer(arc)
    if count == 1:
        return np.ones(arc_m.size)
    return np.asarray(np.interp(arc_m, np.linspace(0.0, arc_m[-1], count), np.eye(count)[k]))


def _stretched(scenario: Scenario, stretches: Sequence[tuple[_Stretch, float]]) -> Scenario:
    """The scenario after some stretches by their factors."""

    def change(beam: Beam) -> Beam:
        columns: dict[str, np.ndarray] = {}
        for stretch, factor in stretches:
            if beam.name in stretch.names:
                before = columns.get(stretch.column)
                before = np.array(getattr(beam.stations, stretch.column)) if before is None else before
                columns[stretch.column] = before * (1 + stretch.share(beam) * (factor - 1))
        return with_columns(beam, **columns) if columns else beam

    return with_beams(scenario, {n for s, _ in stretches for n in s.names}, change) if stretches else scenario


def _body(scenario: Scenario) -> list[Unknown]:
    t, body = scenario.tolerances, scenario.airframe.body

    def with_body(s: Scenario, **values: object) -> Scenario:
        return with_airframe(s, body=s.airframe.body.model_copy(update=values))

    def inertia(axis: int) -> Edit:
        def edit(s: Scenario, factor: float) -> Scenario:
            values = list(s.airframe.body.inertia_kg_m2)
            # Mass further out in the plane of a flat body raises Izz as much.
            values[2] += values[axis] * (factor - 1)
            values[axis] *= factor
            return with_body(s, inertia_kg_m2=tuple(values))

        return edit

    def shifted(s: Scenario, shift: float) -> Scenario:
        x, y, z = s.airframe.body.centre_of_gravity_m
        return with_body(s, centre_of_gravity_m=(x + shift, y, z))

    return [
        _log("mass body", "mass of the centre body", t.body_mass,
             lambda s, f: with_body(s, mass_kg=s.airframe.body.mass_kg * f), "kg", body.mass_kg),
        _log("Ixx body", "roll inertia of the centre body", t.inertia, inertia(0), "kg m^2", body.inertia_kg_m2[0]),
        _log("Iyy body", "pitch inertia of the centre body", t.inertia, inertia(1), "kg m^2", body.inertia_kg_m2[1]),
        Unknown("cg body", "centre of gravity of the centre body, aft", "m", t.body_centre_of_gravity_m, "linear",
                shifted, body.centre_of_gravity_m[0]),
    ]  # fmt: skip


def _items(scenario: Scenario) -> list[Unknown]:
    def scaled(plain: str) -> Edit:
        def edit(s: Scenario, factor: float) -> Scenario:
            items = tuple(
                i.model_copy(update={"mass_kg": i.mass_kg * factor}) if plain_name(i.name) == plain else i
                for i in s.airframe.item
            )
            return with_airframe(s, item=items)

        return edit

    names = dict.fromkeys(plain_name(i.name) for i in scenario.airframe.item)
    sd = scenario.tolerances.item_mass
    return [_log(f"mass {name}", f"mass of the {name}", sd, scaled(name)) for name in names]


def _damping(scenario: Scenario) -> list[Unknown]:
    def with_damping(s: Scenario, **values: object) -> Scenario:
        return with_airframe(s, damping=s.airframe.damping.model_copy(update=values))

    def rest(s: Scenario, factor: float) -> Scenario:
        return with_damping(s, damping_ratio=s.airframe.damping.damping_ratio * factor)

    def mode(k: int) -> Edit:
        def edit(s: Scenario, factor: float) -> Scenario:
            ratios = list(s.airframe.damping.modal)
            ratios[k] *= factor
            return with_damping(s, modal=tuple(ratios))

        return edit

    sd, damping = scenario.tolerances.damping, scenario.airframe.damping
    found = [_log("damping rest", "damping ratio of the modes not listed", sd, rest, "", damping.damping_ratio)]
    for k, ratio in enumerate(damping.modal):
        found.append(_log(f"damping {k + 1}", f"damping ratio of elastic mode {k + 1}", sd, mode(k), "", ratio))
    return found


def _rig(scenario: Scenario) -> list[Unknown]:
    t = scenario.tolerances

    def table(name: str, key: str) -> Edit:
        def edit(s: Scenario, factor: float) -> Scenario:
            part = getattr(s, name)
            return s.model_copy(update={name: part.model_copy(update={key: getattr(part, key) * factor})})

        return edit

    def place(name: str, key: str, axis: int) -> Edit:
        def edit(s: Scenario, shift: float) -> Scenario:
            part = getattr(s, name)
            values = list(getattr(part, key))
            values[axis] += shift
            return s.model_copy(update={name: part.model_copy(update={key: tuple(values)})})

        return edit

    def dampers(s: Scenario, factor: float) -> Scenario:
        keys = ("damping_n_s_per_m", "rotation_damping_n_m_s_per_rad", "pendulum_damping_n_s_per_m")
        update = {key: getattr(s.suspension, key) * factor for key in keys}
        return s.model_copy(update={"suspension": s.suspension.model_copy(update=update)})

    found = [
        _log("spring", "stiffness of the suspension", t.suspension_stiffness, table("suspension", "stiffness_n_per_m"),
             "N/m", scenario.suspension.stiffness_n_per_m),
        _log("suspension dampers", "all dampers of the suspension", t.suspension_damping, dampers),
    ]  # fmt: skip
    for axis, letter in enumerate("xyz"):
        edit = place("suspension", "hook_m", axis)
        words = f"hook, {letter}"
        found.append(Unknown(f"hook {letter}", words, "m", t.hook_m, "linear", edit, scenario.suspension.hook_m[axis]))
    for axis, letter in enumerate("xy"):
        edit = place("shaker", "position_m", axis)
        at = scenario.shaker.position_m[axis]
        found.append(Unknown(f"drive {letter}", f"drive point, {letter}", "m", t.drive_point_m, "linear", edit, at))
    if scenario.transducer.end_mass_kg > 0:
        edit, kg = table("transducer", "end_mass_kg"), scenario.transducer.end_mass_kg
        words = "transducer's mass below the sensing element"
        found.append(_log("transducer end mass", words, t.transducer_end_mass, edit, "kg", kg))
    if scenario.accelerometers.mass_kg > 0:
        edit, kg = table("accelerometers", "mass_kg"), scenario.accelerometers.mass_kg
        found.append(_log("sensor mass", "mass of every accelerometer", t.sensor_mass, edit, "kg", kg))
    return found


def _log(name: str, what: str, sd: float, edit: Edit, unit: str = "", nominal: float | None = None) -> Unknown:
    return Unknown(name, what, unit, sd, "log", edit, nominal)
