"""A root on one side alone that has play or friction, against the whole aircraft stepped from event to event.

The other root stays as it is: one joint works against both wings, and what is symmetric drives what is not.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray
from reconciled_case import small_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.mechanics.ending import Ending
from vgvt.reconcile.mechanics.joints import joint_laws
from vgvt.reconcile.mechanics.law import Law
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.simulation import simulated_campaign
from vgvt.simulation.reduced import Structure
from vgvt.simulation.rig import GRAVITY_M_PER_S2

Array = NDArray[np.float64]
NOTHING = np.zeros(0)
# Steps a sample of the record, and how often each is halved where something happens within it.
FINER, HALVED = 16, 8
SIZES = {"root-freeplay": {"gap_rad": 2e-3}, "root-friction": {"friction_n_m": 0.3}}
# Newton, so that play opens, and friction sticks and slips.
FORCE_N = {"root-freeplay": 20.0, "root-friction": 1.5}


def on_one_side(name: str, side: str = "left") -> Hypothesis:
    size = {**SIZES[name], "root_stiffness_n_m_per_rad": 2000.0}
    return Hypothesis(available_effects()[name], {**size, "kind": "bending", "side": side})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A short sweep of a small aircraft over its first two bending modes, four sensors on it."""
    scenario = without_instrument_noise(small_scenario())
    sweep = scenario.excitation.model_copy(update={"stop_hz": 19.0, "duration_s": 8.0})
    once = scenario.acquisition.model_copy(update={"runs": ((1, 5, 9, 13),)})
    scenario = scenario.model_copy(update={"excitation": sweep, "acquisition": once})
    campaign = simulated_campaign(scenario, engine="linear")
    return make_problem(campaign, scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


def force(case: Problem, time: Array) -> Array:
    """A sweep over the band that leaves the record's last second to what rings on, for one newton."""
    low, high = (float(case.measured.frequency_hz[k]) for k in (0, -1))
    length = case.measured.pushed.shape[1] / case.measured.sample_rate_hz - 1.0
    ends = np.sin(np.pi / 2 * np.clip(np.minimum(time, length - time) / 0.3, 0, 1)) ** 2
    return np.asarray(np.sin(2 * np.pi * (low * time + 0.5 * (high - low) / length * time**2)) * ends)


class Stepped:
    """The aircraft with all its coordinates: linear between the events at which the joint's law changes its ways.

    Its states are displacements and rates (n, n), one, and the force with its rate. A ``way`` is beyond which end of
    the play the joint is, or which way it slips: 0 is within, or stuck.
    """

    def __init__(self, s: Structure, mass: Array, index: int, law: Law, step_s: float) -> None:
        self.s, self.law, self.at, self.step_s = s, law, index, step_s
        n = s.drive.size
        inverse = np.linalg.inv(mass)
        self.row = np.eye(n)[index]
        self.inertia = float(1 / inverse[index, index])
        # Accelerations (n, 2n + 3) of a state without the joint's reaction beyond the linear one.
        free = np.zeros((n, 2 * n + 3))
        free[:, :n], free[:, n : 2 * n] = -inverse @ s.stiffness, -inverse @ s.damping
        free[:, 2 * n + 1] = inverse @ s.drive
        self.held = self.inertia * free[index]
        self.reached = inverse[:, index]
        self.accelerations, self.steps = {}, {}
        for way in (-1, 0, 1):
            self.accelerations[way] = free - np.outer(self.reached, self.reaction(way))
            system = np.zeros((2 * n + 3, 2 * n + 3))
            system[:n, n : 2 * n], system[n : 2 * n] = np.eye(n), self.accelerations[way]
            system[2 * n + 1, 2 * n + 2] = 1.0
            self.steps[way] = [scipy.linalg.expm(system * (step_s / 2**k)) for k in range(HALVED + 1)]

    def reaction(self, way: int) -> Array:
        """The joint's reaction (2n + 3,) of a state beyond that of the linear structure."""
        law, out = self.law, np.zeros(self.held.size)
        if law.friction:
            if not way:
                return self.held
            out[-3] = way * law.friction
        else:
            slope = law.stiffness if way else 0.0
            out[self.at], out[-3] = slope - law.modelled, slope * (law.rest - way * law.play) - law.load
        return out

    def now(self, y: Array, way: int) -> int:
        """The way that the law goes on in, where it is in one."""
        if not self.law.friction:
            x = self.law.rest + y[self.at]
            return int(np.sign(x)) * int(abs(x) > self.law.play)
        if way and way * y[self.s.drive.size + self.at] > 0:
            return way
        # Stopped, or stuck: it stays where less than the friction will do.
        needed = float(self.held @ y)
        return int(np.sign(needed)) if abs(needed) > self.law.friction else 0

    def recorded(self, force: Array, rows: Array, tilt: Array) -> tuple[Array, int]:
        """Readings (C, N) of rows (C, n) under a force (N,), straight in each step, and how often the way changed."""
        n = self.s.drive.size
        y = np.zeros(2 * n + 3)
        y[2 * n] = 1.0
        way, events, out = self.now(y, 0), 0, np.empty((rows.shape[0], force.size))
        rising = np.diff(force, append=force[-1:])
        for k, (here, rise) in enumerate(zip(force, rising, strict=True)):
            y[2 * n + 1], y[2 * n + 2] = here, rise / self.step_s
            out[:, k] = rows @ (self.accelerations[way] @ y) + tilt @ y[:n]
            gone, halved = 0, 0
            while gone < 2**HALVED:
                there = self.steps[way][halved] @ y
                after = self.now(there, way)
                if after != way and halved < HALVED:
                    halved += 1
                    continue
                y, gone = there, gone + 2 ** (HALVED - halved)
                if after != way:
                    if self.law.friction and way:
                        y[n : 2 * n] -= self.reached * y[n + self.at] * self.inertia
                    way, events = self.now(y, way if not self.law.friction else 0), events + 1
                while halved and gone % 2 ** (HALVED - halved + 1) == 0:
                    halved -= 1
        return out, events


def pushed(case: Problem, newton: float) -> Problem:
    """The case as if it had been pushed so, its record tapered where it ends ringing."""
    measured = case.measured
    rate, count = measured.sample_rate_hz, measured.pushed.shape[1]
    samples = newton * force(case, np.arange(count) / rate)
    tapered = round(rate)
    window = np.ones(count)
    window[count - tapered :] = 0.5 * (1 + np.cos(np.pi * (np.arange(tapered) + 0.5) / tapered))
    ending = Ending.of(samples, rate, tapered, measured.frequency_hz, np.fft.rfft(samples * window)[measured.lines])
    return replace(case, measured=replace(measured, pushed=samples[None], endings=(ending,)))


def read(case: Problem, hypothesis: Hypothesis, newton: float) -> tuple[NDArray[np.complex128], int]:
    """What tapered spectra of all coordinates' motion have as A/F (C, L), and how often the joint changed its ways."""
    there = pushed(case, newton)
    (group,) = anchor(there, truth(case), (hypothesis,), NOTHING, slopes=False).assembled
    s = group.structure
    laws = joint_laws(group.plan, s)
    assert [s.joints[k] for k in laws] == ["wing-left-root/bending"]
    ((index, law),) = laws.items()
    moved = s.jacobian[group.rows]
    mass = s.mass + np.einsum("c,cki,ckj->ij", group.masses_kg, moved, moved)
    # It rests under what hangs on it: weight acts as heaving inertia does.
    assert law.load == pytest.approx(-GRAVITY_M_PER_S2 * mass[index, s.joints.index("slide-z")], rel=2e-3)
    rate, count = FINER * case.measured.sample_rate_hz, FINER * case.measured.pushed.shape[1]
    time = np.arange(count) / rate
    acting = newton * force(case, time)
    stepped = Stepped(s, mass, index, law, 1 / rate)
    found, events = stepped.recorded(acting, s.axis[group.rows], s.tilt[group.rows])
    weight = there.measured.endings[0].weight(time)
    spectra = [np.fft.rfft(x * weight)[..., case.measured.lines] for x in (found, acting)]
    return spectra[0] / spectra[1], events


def truth(case: Problem) -> Array:
    """Scores of the scenario as stated, cells included."""
    scores = np.zeros(case.size)
    # A bounded amount comes to its end slowly.
    scores[case.unknowns.index(CELLS)] = -10 / CELLS.sd
    return scores


def foretold(case: Problem, hypothesis: Hypothesis, newton: float) -> NDArray[np.complex128]:
    there, u = pushed(case, newton), truth(case)
    return anchor(there, u, (hypothesis,), NOTHING, slopes=False).mechanical(u, NOTHING)


def off(case: Problem, found: NDArray[np.complex128], wanted: NDArray[np.complex128]) -> float:
    """By how much the largest is missed where the taper does not touch the force."""
    clear = case.measured.frequency_hz < 0.93 * case.measured.frequency_hz[-1]
    return float(np.abs(found - wanted)[:, clear].max() / np.abs(wanted[:, clear]).max())


@pytest.mark.parametrize("name", SIZES)
def test_a_joint_on_one_side_is_foretold(case: Problem, name: str) -> None:
    """To the end of its record, at which it rings; nothing else would do: not quiet, loud, both sides or the other."""
    newton, left = FORCE_N[name], on_one_side(name)
    wanted, events = read(case, left, newton)
    assert events > 50, "it has to open, or to stick and to slip"
    assert off(case, foretold(case, left, newton), wanted) < 1.5e-3
    for level in (1e-4, 1e4):
        assert off(case, foretold(case, left, level * newton), wanted) > 0.1
    for side in ("both", "right"):
        assert off(case, foretold(case, on_one_side(name, side), newton), wanted) > 0.1


def test_what_it_is_held_against_has_converged(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps half as long come to the same, to a tenth of what a march may be off by."""
    for name, newton in FORCE_N.items():
        coarse, _ = read(case, on_one_side(name), newton)
        with monkeypatch.context() as finer:
            finer.setattr(sys.modules[__name__], "FINER", 2 * FINER)
            assert off(case, coarse, read(case, on_one_side(name), newton)[0]) < 1.5e-4
