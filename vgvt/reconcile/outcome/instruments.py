"""What a calibration says of the instruments, as a scenario can say it: gains as effects, corners where they stand.

A sensitivity is no place for a gain: the records divide by the one that is stated, whatever it is.
"""

from __future__ import annotations

import math

import numpy as np

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.problem import Nuisance
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points

_DIGITS = 6


def with_instruments(scenario: Scenario, fit: Fit) -> Scenario:
    """The scenario with the campaign's runs, and the gains and corners that a fit found; gains after its effects."""
    corners = {"corner force": 1.0, "corner sensors": 1.0}
    for nuisance, factor in _factors(fit):
        if nuisance.kind != "gain":
            corners[nuisance.kind] *= factor
    changes: dict[str, object] = {"effect": (*scenario.effect, *gain_tables(scenario, fit))}
    for name, kind in (("transducer", "corner force"), ("accelerometers", "corner sensors")):
        part = getattr(scenario, name)
        changes[name] = part.model_copy(update={"high_pass_hz": part.high_pass_hz * corners[kind]})
    return with_runs(scenario, fit.problem.measured).model_copy(update=changes)


def gain_tables(scenario: Scenario, fit: Fit) -> tuple[EffectTable, ...]:
    """The gains that a fit found as ``channel-gain``, and steps of ``gain-drift`` where one differs from run to run."""
    tables: list[EffectTable] = []
    own: dict[str, list[tuple[int, float]]] = {}
    for nuisance, factor in _factors(fit):
        choice = nuisance.name.removeprefix("gain ")
        if nuisance.kind != "gain":
            continue
        if choice == "force" or choice.startswith("sensor-"):
            tables += _gain(choice, factor)
        else:
            run, label = _channel(scenario, fit.problem.measured, nuisance)
            own.setdefault(label, []).append((run, factor))
    for label, factors in own.items():
        tables += _by_run(label, factors)
    return tuple(tables)


def _factors(fit: Fit) -> list[tuple[Nuisance, float]]:
    scores = fit.u[len(fit.problem.unknowns) :]
    return [(n, math.exp(n.sd * float(u))) for n, u in zip(fit.problem.nuisances, scores, strict=True)]


def with_runs(scenario: Scenario, measured: Measured) -> Scenario:
    """The scenario with a campaign's runs: what is calibrated belongs to sensors by their place in them."""
    if scenario.acquisition.run_nodes == measured.runs:
        return scenario
    acquisition = scenario.acquisition.with_runs(measured.runs)
    return scenario.model_copy(update={"acquisition": acquisition})


def unwritten(fit: Fit) -> tuple[str, ...]:
    """What of a fit the scenario does not say, in words."""
    problem = fit.problem
    held = [problem.measured.channels[k].label for k in np.flatnonzero(problem.split.held)]
    said = "No fit has seen these channels, and a gain that one of them has for itself is as stated: "
    return (said + "; ".join(held),) if held else ()


def _channel(scenario: Scenario, measured: Measured, nuisance: Nuisance) -> tuple[int, str]:
    """The run, from 0, and the scenario's label of the one channel that a gain belongs to."""
    channel = measured.channels[int(np.flatnonzero(nuisance.rows)[0])]
    labels = {p.dof.node: str(p.dof) for p in sensor_points(scenario)}
    return channel.run, labels[channel.dof.node]


def _by_run(label: str, factors: list[tuple[int, float]]) -> list[EffectTable]:
    """Tables that give a channel a factor in each run that it is in: of its first run in all, then steps."""
    tables: list[EffectTable] = []
    before = 1.0
    for k, (run, factor) in enumerate(sorted(factors)):
        if k == 0:
            tables += _gain(label, factor)
        elif error := round(factor / before - 1, _DIGITS):
            tables.append(_table("gain-drift", drift=error, channels=label, shape="step", from_run=run + 1))
        before = factor
    return tables


def _gain(channels: str, factor: float) -> list[EffectTable]:
    error = round(factor - 1, _DIGITS)
    return [_table("channel-gain", gain_error=error, channels=channels)] if error else []


def _table(name: str, **parameters: object) -> EffectTable:
    return EffectTable.model_validate({"name": name, **parameters})
