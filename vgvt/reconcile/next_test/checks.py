"""What hand instruments read off the rig without another sweep: a tape, a scale, a level, a thermistor, a calibrator.

The reading of a check is foretold from what effects do to a run, as the simulation is: an installed effect needs no
line of code about it here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Channel, ChannelRole, Direction, Dof, Quantity
from vgvt.effects.action import Action, ChannelFilter
from vgvt.effects.elements import RotationSpring
from vgvt.effects.point_error import seats
from vgvt.effects.protocol import Effect, Family
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.procedures import lab_minutes
from vgvt.reconcile.prediction.grouping import NoStructureError, effects_at, run_actions
from vgvt.reconcile.question.problem import Nuisance, Problem
from vgvt.reconcile.question.uncertain import edited
from vgvt.scenario.mass import rigid_body_properties
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points
from vgvt.scenario.tolerances import Tolerances
from vgvt.simulation.channel_effects import selects

Array = NDArray[np.float64]

# Standard deviations of careful readings: engineering judgement, each about a division of the instrument.
_TAPE_M, _LEVEL_RAD = 0.002, 0.009
# A thermistor keeps to millikelvins over a day; so well does one point of it stand for how the structure has warmed.
_THERMISTOR_K = 0.02
_SCALE_KG, _BALANCE_KG, _SPRING = 0.003, 0.0003, 0.01
# N per N m: half a per cent of the force of a mass 5 cm off the gauge's axis, on one side and on the other.
_MOMENT_PER_M = 0.005 / (2**0.5 * 0.05)
# Relative: a sensor beside another, and one signal split between two channels.
_REFERENCE, _SPLIT = 0.01, 0.002
# Of the sensitivity along: what ISO 16063-31 can tell of that across with an ordinary exciter.
_ACROSS = 0.005
_HIGHEST_HZ = 5000.0
_FREQUENCIES = 10
_STEP = 0.01
_UP = Direction.PLUS_Z


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A run as it is: the scenario that effects have made of the stated one, and what each of them does.

    ``gains`` are the factors that tolerances have made of its responses' sensitivities, by node; 1 where there is none.
    """

    scenario: Scenario
    run: int
    actions: tuple[Action, ...]
    families: tuple[Family, ...]
    gains: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """A reading, in words, its lab time, and ``read(runs) -> (K,)``, known to ``covariance(K) -> (K, K)``.

    ``of_gains`` where it shows what a fit makes of the sensors' gains within their tolerances. It is read after the
    campaign, of a rig and of sensors as the last run left them, unless it ``follows_runs``.
    """

    words: str
    minutes: float
    read: Callable[[Sequence[Seen]], Array]
    covariance: Callable[[int], Array]
    of_gains: bool = False
    follows_runs: bool = False


def seen(scenario: Scenario, effects: Sequence[Effect]) -> tuple[Seen, ...]:
    """Every run of a scenario with effects at work, whichever tables of effects the scenario has itself."""
    per_run = run_actions(scenario, tuple(effects), len(scenario.acquisition.run_nodes))
    families = tuple(e.family for e in effects)
    return tuple(Seen(changed, k, actions, families) for k, (changed, actions) in enumerate(per_run))


def checks(problem: Problem) -> tuple[Check, ...]:
    """What can be read off the rig of a campaign, with the minutes that it takes."""
    scenario, runs = problem.scenario, len(problem.measured.runs)
    # Where a sensor stays for several runs it is read once.
    points = len({seat for run in problem.measured.runs for seat in enumerate(run)})
    gains = scenario.tolerances
    lowest, highest = problem.measured.frequency_hz[[0, -1]]
    band = np.geomspace(lowest, highest, _FREQUENCIES)
    wide = np.geomspace(lowest, _HIGHEST_HZ, _FREQUENCIES)
    found = [
        Check("measure with a tape where the hook is", 5.0, lambda r: np.array(r[-1].scenario.suspension.hook_m),
              _alike(_TAPE_M)),
        Check("measure with a tape where every sensor sits", float(points), _sensor_places, _alike(_TAPE_M)),
        Check("hold a level to every sensor", float(points), _sensor_leans, _alike(_LEVEL_RAD)),
        Check("shake every accelerometer across its axis, on a calibrator", 10.0 * max(map(len, problem.measured.runs)),
              _cross_sensitivities, _alike(_ACROSS)),
        Check("weigh the aircraft before and after", 30.0,
              lambda r: np.array([_aircraft_kg(r[0]), _aircraft_kg(r[-1])]), _alike(_SCALE_KG), follows_runs=True),
        Check("weigh an accelerometer with what moves of its cable", 10.0,
              lambda r: np.array([r[-1].scenario.accelerometers.mass_kg]), _alike(_BALANCE_KG)),
        Check("split one noise signal between all channels, up to 5 kHz", 15.0,
              lambda r: _inputs(r, wide), _calibrated(_SPLIT, gains)),
        Check("put a reference accelerometer beside every sensor and compare the two in the band", 2.0 * points,
              lambda r: _beside_all(r, band), _beside(_REFERENCE), of_gains=True),
    ]  # fmt: skip
    if runs > 1:
        # Nobody reads afterwards how warm it was: what drifts, or warms, has to do so once more.
        words = "make the runs anew, and log the temperature of the structure with a thermistor"
        minutes = 5.0 + lab_minutes(problem)
        found.append(
            Check(words, minutes, lambda r: np.array([_warming_k(s) for s in r]), _alike(_THERMISTOR_K),
                  follows_runs=True)
        )  # fmt: skip
    if scenario.hammer is None:
        found += [
            Check("measure with a tape where the shaker pushes", 5.0,
                  lambda r: np.array([v for s in r[-1].scenario.shakers for v in s.position_m[:2]]), _alike(_TAPE_M)),
            Check("hold a level to the stinger", 5.0, _push_leans, _alike(_LEVEL_RAD)),
            Check("weigh the force transducer with its mount", 15.0,
                  lambda r: np.array([r[-1].scenario.transducer.end_mass_kg]), _alike(_BALANCE_KG)),
            Check("shake a mass off the force transducer's axis, on all four sides", 30.0,
                  _moments_read, _alike(_MOMENT_PER_M)),
        ]  # fmt: skip
    if scenario.suspension.stiffness_n_per_m > 0:
        found.append(
            Check("hang a known mass on the spring", 10.0,
                  lambda r: np.array([np.log(r[-1].scenario.suspension.stiffness_n_per_m)]), _alike(_SPRING))
        )  # fmt: skip
    return tuple(found)


def foretold(fit: Fit, check: Check) -> tuple[Array, Array] | None:
    """Mean (K,) and covariance (K, K) of a reading by what a fit knows; None where it cannot be read."""
    mean = read_by(fit, fit.scores, check)
    if mean is None:
        return None
    slopes = slopes_of(fit, fit.scores, mean, check)
    return mean, slopes @ fit.covariance @ slopes.T + check.covariance(mean.size)


def slopes_of(fit: Fit, scores: Array, reading: Array, check: Check, moving: Sequence[int] | None = None) -> Array:
    """Derivatives (K, n) of a reading (K,) in the scores (n,) of a fit's problem and hypotheses.

    ``moving`` are the indices of those that move it at all, where that is known.
    """
    slopes = np.zeros((reading.size, scores.size))
    # What other unknowns of the measuring chain say is in the check's own covariance.
    known = len(fit.problem.unknowns)
    gains = [known + k for k, n in enumerate(fit.problem.nuisances) if check.of_gains and _of_sensors(n)]
    every = (*range(known), *gains, *range(fit.u.size, scores.size))
    for k in moving if moving is not None else every:
        aside = scores.copy()
        aside[k] += _STEP
        there = read_by(fit, aside, check)
        if there is not None:
            slopes[:, k] = (there - reading) / _STEP
    return slopes


def log_density(reading: Array, mean: Array, covariance: Array) -> float:
    """Log density, nats, of a reading (K,) under a normal law of mean (K,) and covariance (K, K)."""
    factor = np.linalg.cholesky(covariance)
    white = np.linalg.solve(factor, reading - mean)
    return float(-0.5 * (white @ white) - np.log(np.diag(factor)).sum() - 0.5 * mean.size * np.log(2 * np.pi))


def read_by(fit: Fit, scores: Array, check: Check) -> Array | None:
    """The reading (K,) at other scores (n,) of a fit's hypotheses; None where there is no such aircraft."""
    problem, u, e = fit.problem, scores[: fit.u.size], scores[fit.u.size :]
    try:
        made = effects_at(problem, fit.hypotheses, e)
        if made is None:
            return None
        known = len(problem.unknowns)
        base = edited(problem.scenario, problem.unknowns, u[:known])
        found = seen(base if check.follows_runs else _as_left(base), made)
        if check.of_gains:
            gains = _gains(problem, u[known:])
            found = tuple(replace(one, gains=gains[one.run]) for one in found)
        return check.read(found)
    except (NoStructureError, ValueError):
        return None


def _as_left(scenario: Scenario) -> Scenario:
    """The scenario after its runs: whatever changes from run to run is in each as far as in the last."""
    runs = len(scenario.acquisition.run_nodes)
    return scenario.model_copy(update={"acquisition": scenario.acquisition.counted_as((runs,) * runs)})


def _of_sensors(nuisance: Nuisance) -> bool:
    """Whether it is a gain of responses: no accelerometer beside them shows that of the force."""
    return nuisance.kind == "gain" and nuisance.name != "gain force"


def _gains(problem: Problem, scores: Array) -> list[dict[int, float]]:
    """What scores of the nuisances (n,) make of the sensitivity of every run's responses, by node."""
    channels = problem.measured.channels
    log = np.zeros(len(channels))
    for nuisance, u in zip(problem.nuisances, scores, strict=True):
        if _of_sensors(nuisance):
            log += nuisance.sd * u * nuisance.rows
    found: list[dict[int, float]] = [{} for _ in problem.measured.runs]
    for channel, gain in zip(channels, np.exp(log), strict=True):
        found[channel.run][channel.dof.node] = float(gain)
    return found


def _alike(sd: float) -> Callable[[int], Array]:
    return lambda count: sd**2 * np.eye(count)


def _calibrated(relative: float, gains: Tolerances) -> Callable[[int], Array]:
    """Of real, then imaginary parts at the frequencies of a channel: every channel's gain is its own besides."""
    one = np.concatenate([np.ones(_FREQUENCIES), np.zeros(_FREQUENCIES)])
    block = relative**2 * np.eye(one.size) + (gains.gain**2 + gains.channel_gain**2) * np.outer(one, one)
    return lambda count: np.asarray(np.kron(np.eye(count // one.size), block), dtype=np.float64)


def _beside(relative: float) -> Callable[[int], Array]:
    """Of real, then imaginary parts at the frequencies of a channel: read to that, by one reference known as well."""

    def covariance(count: int) -> Array:
        real = np.tile(np.repeat([1.0, 0.0], _FREQUENCIES), count // (2 * _FREQUENCIES))
        return relative**2 * (np.eye(count) + np.outer(real, real))

    return covariance


def _inputs(runs: Sequence[Seen], frequency_hz: Array) -> Array:
    """What acquisition does to the force's input, then to that of each sensor, over one, as real numbers.

    One measurement, however many runs an input was used in: the mean over these.
    """
    found = [_filters(one, frequency_hz, (Family.ACQUISITION,), force=True) for one in runs]
    each = range(max(len(rows) for rows in found))
    return np.concatenate([np.mean([rows[k] for rows in found if k < len(rows)], axis=0) for k in each])


def _seats(runs: Sequence[Seen]) -> dict[tuple[int, int], Seen]:
    """The last run of every sensor at each of its points, by its place among the sensors and the point's node."""
    return {(k, node): one for one in runs for k, node in enumerate(one.scenario.acquisition.run_nodes[one.run])}


def _beside_all(runs: Sequence[Seen], frequency_hz: Array) -> Array:
    """What all filters do to the response of every sensor at each of its points, over one, as real numbers.

    No accelerometer shows what the force gauge says.
    """
    by_run = {one.run: _filters(one, frequency_hz, tuple(Family), force=False) for one in runs}
    return np.concatenate([by_run[one.run][place] for (place, _), one in _seats(runs).items()])


def _filters(one: Seen, frequency_hz: Array, families: tuple[Family, ...], *, force: bool) -> Array:
    """What filters of some families do to every response of a run, (C, 2 F): real, then imaginary parts.

    With ``force`` to that channel too, first.
    """
    found = []
    points = {p.dof.node: p for p in sensor_points(one.scenario)}
    gauge = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof(0, _UP))
    responses = [
        Channel("response", Quantity.ACCELERATION, ChannelRole.RESPONSE, points[node].dof)
        for node in one.scenario.acquisition.run_nodes[one.run]
    ]
    for channel in (gauge, *responses) if force else responses:
        gain = 1.0 if channel is gauge or channel.dof is None else one.gains.get(channel.dof.node, 1.0)
        factor = np.full(frequency_hz.size, gain, dtype=complex)
        for action, family in zip(one.actions, one.families, strict=True):
            for change in action.channels if family in families else ():
                if isinstance(change, ChannelFilter) and selects(change.channels, channel):
                    factor = factor * change.response(frequency_hz)
        found.append(np.concatenate([factor.real, factor.imag]))
    return np.array(found)


def _sensor_places(runs: Sequence[Seen]) -> Array:
    """Where every sensor sits at each of its points, aft and right, m."""
    found = []
    for (_, node), one in _seats(runs).items():
        places = {p.dof.node: np.array(p.position_m) for p in sensor_points(one.scenario)}
        at = seats(a.points for a in one.actions).get(node, node)
        errors = [p for a in one.actions for p in a.points if p.node == node]
        found.append((places[at] + sum((np.array(p.shift_m) for p in errors), np.zeros(3)))[:2])
    return np.concatenate(found)


def _sensor_leans(runs: Sequence[Seen]) -> Array:
    """How every sensor leans at each of its points, as unit vectors' changes in aircraft axes."""
    return np.concatenate([_lean(one, node) for (_, node), one in _seats(runs).items()])


def _cross_sensitivities(runs: Sequence[Seen]) -> Array:
    """What every accelerometer feels across its axis by itself, of what it feels along, as the mean over its runs."""
    found: list[list[Array]] = [
        [] for _ in range(max(len(one.scenario.acquisition.run_nodes[one.run]) for one in runs))
    ]
    for one in runs:
        for sensor, node in enumerate(one.scenario.acquisition.run_nodes[one.run]):
            felt = [np.array(p.cross_sensitivity) for a in one.actions for p in a.points if p.node == node]
            found[sensor].append(np.sum([np.zeros(3), *felt], axis=0))
    return np.concatenate([np.mean(of_one, axis=0) for of_one in found])


def _push_leans(runs: Sequence[Seen]) -> Array:
    return np.concatenate([_lean(runs[-1], shaker.node) for shaker in runs[-1].scenario.shakers])


def _moments_read(runs: Sequence[Seen]) -> Array:
    """What the force gauge of every shaker reads of a moment about either axis across it, N per N m."""
    springs = [e for a in runs[-1].actions for e in a.elements if isinstance(e, RotationSpring)]
    return np.array([
        sum(e.gauge_per_m for e in springs if (e.exciter, e.axis) == (k, axis))
        for k in range(len(runs[-1].scenario.shakers)) for axis in ("roll", "pitch")
    ], dtype=np.float64)  # fmt: skip


def _lean(one: Seen, node: int) -> Array:
    return np.asarray(sum((np.array(p.lean) for a in one.actions for p in a.points if p.node == node), np.zeros(3)))


def _warming_k(one: Seen) -> float:
    return float(sum(a.warming_k for a in one.actions))


def _aircraft_kg(one: Seen) -> float:
    """The airframe with what effects put on it, kg; the air that it moves has no weight."""
    hung = sum(getattr(e, "mass_kg", 0.0) for a in one.actions for e in a.elements if e.owner == "airframe")
    return float(rigid_body_properties(one.scenario.airframe).mass_kg + hung)
