"""Seven physical effects that no catalogue may ever hold: the open set. Written here alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from catalogue_twins import dashpot, lump, resonator, spring
from finite_element import Array
from second_laboratory import UP, Change, ComplexArray, Coupling, Rig


def vertical(rig: Rig, node: int) -> Array:
    """Vertical row (N,) of a grid node, whether a sensor sits there or not."""
    return rig.seat(node)


def tip_link(stiffness: float, damping: float) -> Change:
    """A slack line with a damper from wing tip to wing tip: it feels their difference alone."""

    def change(rig: Rig, run: int) -> Rig:
        y = max(rig.scenario.accelerometers.grid.y_m)
        row = UP @ (rig.at(0.9, y)[:3] - rig.at(0.9, -y)[:3])
        return rig.coupled(Coupling(row, row, spring(stiffness)), Coupling(row, row, dashpot(damping)))

    return change


def rotor(spin_n_m_s: float) -> Change:
    """A fan about the vertical spins on the body: roll rate gives a pitch moment and pitch rate a roll moment."""

    def change(rig: Rig, run: int) -> Rig:
        roll, pitch = rig.model.motion_at(rig.model.origin_m)[3:5]
        law = dashpot(spin_n_m_s)
        return rig.coupled(Coupling(roll, pitch, law), Coupling(-pitch, roll, law))

    return change


def slosh(mass_kg: float, first_hz: float, second_hz: float) -> Change:
    """Fuel in a tank below the body: it swings fore and aft at one frequency and sideways at another."""

    def change(rig: Rig, run: int) -> Rig:
        rows = rig.model.motion_at(rig.model.origin_m + np.array([0.1, 0.05, -0.12]))
        return rig.coupled(
            Coupling(rows[0], rows[0], resonator(mass_kg, first_hz, 0.02)),
            Coupling(rows[1], rows[1], resonator(0.6 * mass_kg, second_hz, 0.02)),
        )

    return change


def delayed_feedback(gain_kg: float, delay_s: float, node: int) -> Change:
    """An autopilot left on: a flap pushes in proportion to the body's acceleration some time ago."""

    def change(rig: Rig, run: int) -> Rig:
        felt = UP @ rig.model.motion_at(rig.model.origin_m)[:3]

        def law(omega: Array) -> ComplexArray:
            return np.asarray(-gain_kg * omega**2 * np.exp(-1j * omega * delay_s))

        return rig.coupled(Coupling(vertical(rig, node), felt, law))

    return change


def magnet(stiffness: float, eddy: float, node: int) -> Change:
    """A magnet pulls at a point with negative stiffness, and eddy currents lag behind it."""

    def change(rig: Rig, run: int) -> Rig:
        row = vertical(rig, node)

        def law(omega: Array) -> ComplexArray:
            return np.asarray(-stiffness + 1j * omega * eddy / (1 + 1j * omega * 0.01))

        return rig.coupled(Coupling(row, row, law))

    return change


def cross_talk(share: float, corner_hz: float, run_number: int) -> Change:
    """In one run the first channel leaks into the second through a capacitance, the more the higher."""

    def change(rig: Rig, run: int) -> Rig:
        if run != run_number:
            return rig

        def mixing(values: ComplexArray, omega: Array) -> ComplexArray:
            leak = share * 1j * omega / (1j * omega + 2 * np.pi * corner_hz)
            mixed = values.copy()
            mixed[1] += leak * values[0]
            return mixed

        return replace(rig, mixing=mixing)

    return change


def double_absorber(mass_kg: float, frequency_hz: float, node: int) -> Change:
    """A mass on a spring on a mass on a spring at one point: two resonances of one thing."""

    def change(rig: Rig, run: int) -> Rig:
        row = vertical(rig, node)
        natural = 2 * np.pi * frequency_hz

        def law(omega: Array) -> ComplexArray:
            # The outer resonator loads the inner mass, which hangs on its own spring.
            load = lump(mass_kg)(omega) + resonator(0.5 * mass_kg, 0.8 * frequency_hz, 0.01)(omega)
            link = mass_kg * (natural**2 + 2j * 0.01 * natural * omega)
            return np.asarray(link * load / (link + load))

        return rig.coupled(Coupling(row, row, law))

    return change


Draw = Callable[[np.random.Generator, tuple[int, ...]], tuple[Change, int | None]]


def _log(g: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(g.uniform(np.log(low), np.log(high))))


def _at(g: np.random.Generator, nodes: tuple[int, ...], make: Callable[[int], Change]) -> tuple[Change, int]:
    node = int(g.choice(nodes))
    return make(node), node


UNCATALOGUED: dict[str, Draw] = {
    "tip-link": lambda g, nodes: (tip_link(_log(g, 20, 80), _log(g, 0.5, 3)), None),
    "rotor": lambda g, nodes: (rotor(_log(g, 0.3, 1.5)), None),
    "slosh": lambda g, nodes: (slosh(_log(g, 0.3, 0.8), _log(g, 5, 9), _log(g, 10, 20)), None),
    "delayed-feedback": lambda g, nodes: _at(g, nodes, lambda n: delayed_feedback(_log(g, 0.3, 1), 0.02, n)),
    "magnet": lambda g, nodes: _at(g, nodes, lambda n: magnet(_log(g, 100, 400), _log(g, 1, 5), n)),
    "cross-talk": lambda g, nodes: (cross_talk(_log(g, 0.1, 0.4), 20.0, 1), None),
    "double-absorber": lambda g, nodes: _at(
        g, nodes, lambda n: double_absorber(_log(g, 0.04, 0.15), _log(g, 8, 20), n)
    ),
}
"""Each draws sizes and, where it acts at one point, tells the node."""
