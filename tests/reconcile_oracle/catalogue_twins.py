"""Effects that the catalogue knows, written a second time for the second laboratory from their physics alone.

Each function takes sizes and gives a change of a run's rig; ``TWINS`` draws one at random for a size factor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from finite_element import Array, arc_length, build
from second_laboratory import ELEMENTS, UP, Change, ComplexArray, Coupling, Law, Rig, both_sides

from vgvt.scenario.airframe import Beam


def spring(stiffness: float) -> Law:
    """A constant dynamic stiffness."""
    return lambda omega: np.full(omega.size, stiffness, dtype=complex)


def dashpot(damping: float) -> Law:
    """iωc."""
    return lambda omega: 1j * omega * damping


def lump(mass_kg: float) -> Law:
    """-ω²m."""
    return lambda omega: (-(omega**2) * mass_kg).astype(complex)


def resonator(mass_kg: float, frequency_hz: float, damping_ratio: float) -> Law:
    """A mass on a spring, seen from the spring's foot: -ω²m (k + iωc) / (k + iωc - ω²m)."""
    natural = 2 * np.pi * frequency_hz

    def law(omega: Array) -> ComplexArray:
        link = mass_kg * (natural**2 + 2j * damping_ratio * natural * omega)
        return np.asarray(-(omega**2) * mass_kg * link / (link - omega**2 * mass_kg))

    return law


def local_absorber(mass_kg: float, frequency_hz: float, damping_ratio: float, x_m: float, y_m: float) -> Change:
    """A loose mass on the airframe."""

    def change(rig: Rig, run: int) -> Rig:
        row = UP @ rig.at(x_m, y_m)[:3]
        return rig.coupled(Coupling(row, row, resonator(mass_kg, frequency_hz, damping_ratio)))

    return change


def added_mass(mass_kg: float, x_m: float, y_m: float) -> Change:
    """A mass that nobody weighed."""

    def change(rig: Rig, run: int) -> Rig:
        return rig.coupled(*(Coupling(row, row, lump(mass_kg)) for row in rig.at(x_m, y_m)[:3]))

    return change


def suspension_surge(mass_kg: float, loss_factor: float) -> Change:
    """Waves in the spring: k g cot g at its lower end, g = ω sqrt(m / k), less the k that is there already."""

    def change(rig: Rig, run: int) -> Rig:
        plain = rig.scenario.suspension.stiffness_n_per_m
        row = UP @ rig.model.motion_at(np.array(rig.scenario.suspension.hook_m))[:3]

        def law(omega: Array) -> ComplexArray:
            lossy = plain * (1 + 1j * loss_factor)
            phase = omega * np.sqrt(mass_kg / lossy)
            return np.asarray(lossy * phase / np.tan(phase) - plain)

        return rig.coupled(Coupling(row, row, law))

    return change


def root_compliance(bending: float, torsion: float, sides: tuple[str, ...]) -> Change:
    """Roots that turn under their moment, by a share of what the whole wing turns under it."""

    def softened(beam: Beam) -> Beam:
        if beam.parent != "body" or not any(beam.name.endswith(side) for side in sides):
            return beam
        update = {}
        for key, column, share in (
            ("root_bending_stiffness_n_m_per_rad", "bending_stiffness_n_m2", bending),
            ("root_torsional_stiffness_n_m_per_rad", "torsional_stiffness_n_m2", torsion),
        ):
            fine = np.linspace(0, arc_length(beam)[-1], 2001)
            flexibility = np.trapezoid(1 / np.interp(fine, arc_length(beam), getattr(beam.stations, column)), fine)
            if share > 0:
                update[key] = 1 / (share * float(flexibility))
        return beam.model_copy(update=update)

    def change(rig: Rig, run: int) -> Rig:
        airframe = both_sides(rig.scenario.airframe)
        soft = airframe.model_copy(update={"beam": tuple(softened(b) for b in airframe.beam)})
        return replace(rig, model=build(soft, ELEMENTS))

    return change


def channel_gain(nodes: tuple[int, ...], error: float) -> Change:
    """Some channels read too much by a share."""
    return on_channels(nodes, lambda omega: np.full(omega.size, 1 + error, dtype=complex))


def channel_delay(nodes: tuple[int, ...], delay_s: float) -> Change:
    """Some channels come late."""
    return on_channels(nodes, lambda omega: np.exp(-1j * omega * delay_s))


def loose_sensor_mount(node: int, frequency_hz: float, damping_ratio: float) -> Change:
    """One sensor on a soft mount."""
    natural = 2 * np.pi * frequency_hz

    def law(omega: Array) -> ComplexArray:
        passing = natural**2 + 2j * damping_ratio * natural * omega
        return np.asarray(passing / (passing - omega**2))

    return on_channels((node,), law)


def high_pass_mismatch(corner_hz: float) -> Change:
    """The force channel's AC coupling has another corner than stated, by a second one in series."""
    return lambda rig, run: replace(
        rig, force_filter=(*rig.force_filter, lambda omega: 1j * omega / (1j * omega + 2 * np.pi * corner_hz))
    )


def on_channels(nodes: tuple[int, ...], law: Law) -> Change:
    """A filter on the sensors at some nodes, wherever they come up."""
    return lambda rig, run: replace(rig, filters={**rig.filters, **dict.fromkeys(nodes, law)})


def swapped_sensors(one: int, other: int) -> Change:
    """Two channels of a run carry one another's label."""
    turned = {one: other, other: one}
    return lambda rig, run: replace(rig, labels=tuple(turned.get(n, n) for n in rig.seats))


def roving_sensor_mass(extra_kg: float) -> Change:
    """Every accelerometer weighs more than stated, and moves about."""

    def change(rig: Rig, run: int) -> Rig:
        rows = [rig.seat(node) for node in rig.seats]
        return rig.coupled(*(Coupling(row, row, lump(extra_kg)) for row in rows))

    return change


def run_drift(stiffness: float) -> Change:
    """Stiffness changes in proportion to the number of the run, by ``stiffness`` from the first to the last."""

    def change(rig: Rig, run: int) -> Rig:
        last = max(len(rig.scenario.acquisition.run_nodes) - 1, 1)
        return replace(rig, stiffness_factor=rig.stiffness_factor * (1 + stiffness * run / last))

    return change


def stinger_moment(stiffness: float) -> Change:
    """The drive rod resists roll and pitch of the body."""

    def change(rig: Rig, run: int) -> Rig:
        turn = rig.model.motion_at(rig.drive_m)[3:5]
        return rig.coupled(*(Coupling(row, row, spring(stiffness)) for row in turn))

    return change


def drive_point_offset(x_m: float, y_m: float) -> Change:
    """The shaker stands elsewhere than stated."""
    return lambda rig, run: replace(rig, drive_m=rig.drive_m + np.array([x_m, y_m, 0.0]))


def suspension_stiffness(factor: float) -> Change:
    """Another spring."""

    def change(rig: Rig, run: int) -> Rig:
        table = rig.scenario.suspension
        other = table.model_copy(update={"stiffness_n_per_m": table.stiffness_n_per_m * factor})
        return replace(rig, scenario=rig.scenario.model_copy(update={"suspension": other}))

    return change


class Twin(NamedTuple):
    """A change of the rig, and what the catalogue's effect of that name would call it: settings and sizes."""

    change: Change
    settings: dict[str, Any]


Draw = Callable[[np.random.Generator, tuple[int, ...]], Twin]


def _log(g: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(g.uniform(np.log(low), np.log(high))))


def _side(g: np.random.Generator) -> float:
    return float(g.choice([-1.0, 1.0]))


def _wing_point(g: np.random.Generator) -> tuple[float, float]:
    share = float(g.uniform(0.3, 1.0))
    return 0.47 + 0.52 * share, _side(g) * (0.2 + 1.25 * share)


def _absorber(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    mass, frequency, damping, (x, y) = _log(g, 0.02, 0.2), _log(g, 5, 30), _log(g, 0.005, 0.05), _wing_point(g)
    said = {"mass_kg": mass, "frequency_hz": frequency, "damping_ratio": damping, "x_m": x, "y_m": y}
    return Twin(local_absorber(mass, frequency, damping, x, y), said)


def _mass(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    mass, (x, y) = _log(g, 0.05, 0.2), _wing_point(g)
    return Twin(added_mass(mass, x, y), {"mass_kg": mass, "x_m": x, "y_m": y})


def _surge(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    mass, loss = _log(g, 0.1, 0.9), _log(g, 0.002, 0.02)
    return Twin(suspension_surge(mass, loss), {"mass_kg": mass, "loss_factor": loss})


def _root(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    bending, torsion = _log(g, 0.05, 0.3), _log(g, 0.05, 0.3)
    side = ("both", "right", "left")[int(g.integers(3))]
    sides = ("-right", "-left") if side == "both" else (f"-{side}",)
    return Twin(root_compliance(bending, torsion, sides), {"bending": bending, "torsion": torsion, "side": side})


def _gain(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    node = int(g.choice(nodes))
    error = _side(g) * _log(g, 0.08, 0.3)
    return Twin(channel_gain((node,), error), {"channels": f"{node}+Z", "gain_error": error})


def _delay(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    node = int(g.choice(nodes))
    delay = _log(g, 5e-5, 2e-3)
    return Twin(channel_delay((node,), delay), {"channels": f"{node}+Z", "delay_s": delay})


def _loose(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    node = int(g.choice(nodes))
    frequency, damping = _log(g, 40, 200), 0.05
    said = {"node": node, "period_s": 1 / frequency, "damping_ratio": damping}
    return Twin(loose_sensor_mount(node, frequency, damping), said)


def _high_pass(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    corner = _log(g, 0.2, 2)
    return Twin(high_pass_mismatch(corner), {"channels": "force", "corner_hz": corner})


def _swapped(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    one, other = (int(n) for n in g.permutation(nodes[:4])[:2])
    return Twin(swapped_sensors(one, other), {"node": one, "other_node": other})


def _heavier(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    extra = _log(g, 0.003, 0.02)
    return Twin(roving_sensor_mass(extra), {"mass_kg": extra})


def _drift(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    drift = _side(g) * _log(g, 0.01, 0.05)
    return Twin(run_drift(drift), {"shape": "linear", "drift": drift})


def _moment(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    stiffness = _log(g, 5, 30)
    return Twin(stinger_moment(stiffness), {"rotational_stiffness_n_m_per_rad": stiffness})


def _offset(g: np.random.Generator, nodes: tuple[int, ...]) -> Twin:
    x, y = _side(g) * _log(g, 0.02, 0.05), _side(g) * 0.02
    return Twin(drive_point_offset(x, y), {"dx_m": x, "dy_m": y})


TWINS: dict[str, Draw] = {
    "local-absorber": _absorber, "added-mass": _mass, "suspension-surge": _surge, "root-compliance": _root,
    "channel-gain": _gain, "channel-delay": _delay, "loose-sensor-mount": _loose, "high-pass-mismatch": _high_pass,
    "swapped-sensors": _swapped, "roving-sensor-mass": _heavier, "run-drift": _drift, "stinger-moment": _moment,
    "drive-point-offset": _offset,
}  # fmt: skip
