"""The measuring chain as a factor on A/F: gains, AC coupling, and the filters that effects put on channels."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Channel, ChannelRole, Direction, Dof, PluginError, Quantity
from vgvt.effects.action import Action, ChannelFilter
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import refused
from vgvt.reconcile.question.problem import Problem
from vgvt.simulation.channel_effects import selects

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_UP = Direction.PLUS_Z
# Of the sampling rate: where a corner that nothing could pass any more is taken to be.
_HIGHEST = 0.49


def chain_factor(problem: Problem, scores: Array, actions: list[tuple[Action, ...]] | None) -> ComplexArray:
    """What multiplies the mechanical A/F, (C, L), at scores (nuisances,); ``actions`` of every run or None.

    NoStructureError, with a warning, where a filter of somebody else's effect fails.
    """
    out = _plain(problem, np.asarray(scores, dtype=float).tobytes())
    if actions is None:
        return out
    try:
        return np.asarray(out * _filters(problem, actions))
    except PluginError as error:
        refused(error)
        raise NoStructureError(str(error)) from error


@lru_cache(maxsize=256)
def _plain(problem: Problem, packed: bytes) -> ComplexArray:
    """The factor without effects, (C, L)."""
    measured, scenario, scores = problem.measured, problem.scenario, np.frombuffer(packed)
    gain = _signs(problem)
    corners = {"corner force": scenario.transducer.high_pass_hz, "corner sensors": scenario.accelerometers.high_pass_hz}
    for nuisance, u in zip(problem.nuisances, scores, strict=True):
        with np.errstate(over="ignore"):  # a trial step may go anywhere: it is refused for what it predicts
            factor = float(np.exp(nuisance.power * nuisance.sd * u))
        if nuisance.kind == "gain":
            gain = gain * np.where(nuisance.rows, factor, 1.0)
        else:
            corners[nuisance.kind] *= factor
    frequency, rate = measured.frequency_hz, measured.sample_rate_hz
    shape = high_pass(corners["corner sensors"], frequency, rate) / high_pass(corners["corner force"], frequency, rate)
    return np.asarray(gain[:, None] * shape)


def high_pass(corner_hz: float, frequency_hz: Array, rate_hz: float) -> ComplexArray:
    """First-order AC coupling as the acquisition computes it, (L,)."""
    if corner_hz <= 0:
        return np.ones(frequency_hz.size, dtype=complex)
    # The bilinear transform of s / (s + w), prewarped to its corner; trial steps may lead past half the rate.
    warped = np.tan(np.pi * min(corner_hz / rate_hz, _HIGHEST))
    s = 1j * np.tan(np.pi * frequency_hz / rate_hz)
    return np.asarray(s / (s + warped))


def _signs(problem: Problem) -> Array:
    """-1 where a channel was measured against the direction that the scenario gives its point, (C,)."""
    stated = {p.dof.node: p.dof.direction.sign for p in problem.layouts.first.grid}
    return np.array([float(c.dof.direction.sign * stated[c.dof.node]) for c in problem.measured.channels])


def _filters(problem: Problem, actions: list[tuple[Action, ...]]) -> ComplexArray:
    frequency = problem.measured.frequency_hz
    stated = {p.dof.node: p.dof for p in problem.layouts.first.grid}
    force = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof(problem.scenario.shaker.node, _UP))
    out = np.ones(problem.measured.values.shape, dtype=complex)
    for i, measured in enumerate(problem.measured.channels):
        channel = Channel("response", Quantity.ACCELERATION, ChannelRole.RESPONSE, stated[measured.dof.node])
        for action in actions[measured.run]:
            for change in action.channels:
                if not isinstance(change, ChannelFilter):
                    continue
                if selects(change.channels, channel):
                    out[i] *= change.response(frequency)
                if selects(change.channels, force):
                    out[i] /= change.response(frequency)
    return out
