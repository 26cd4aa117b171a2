"""Every variant of every installed effect that a campaign could show: choices enumerated, places laid out in a grid.

Settings are enumerated by their type and, for the catalogue's common words, by name: ``node``, ``channels``,
``sensors``, ``side``, ``from_run``, ``item``, and places ``x_m``, ``y_m``, with ``other_x_m``, ``other_y_m`` for what
ties two together. Others keep their defaults.
"""

from __future__ import annotations

import dataclasses
import itertools
import typing
import warnings
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from vgvt.data import InputError, PluginError
from vgvt.data.plugin import is_bundled
from vgvt.effects.acting import action_of
from vgvt.effects.action import ChannelFilter
from vgvt.effects.beams import plain_name
from vgvt.effects.parameter import parameters_of
from vgvt.effects.registry import EffectPluginWarning, available_effects
from vgvt.reconcile.evidence.free_places import on_centre_line
from vgvt.reconcile.evidence.plausible import reach
from vgvt.reconcile.question.arguments import check_effects
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.placement import aircraft_box_m
from vgvt.scenario.planform import edge_lines_m

# Runs at which a change is tried at first, evenly spread where there are more; those between come as other courses of
# what did best (:mod:`vgvt.reconcile.search.courses`).
_FROM_RUNS = 11
_STATIONS = 6
_TIED = ("x_m", "y_m", "other_x_m", "other_y_m")
# A campaign of a dozen runs of 34 sensors asks whether each of these changed its gain, from each run on.
_MOST = 1024
# Stated or not they can be there once more, as factors are: a reconciled scenario states what was calibrated.
_AGAIN = {"channel-gain", "gain-drift"}
# Shares of what is plausible at which a scenario is asked whether it can have an effect; halfway many are nothing.
_ASKED_AT = (0.25, 0.75)


def candidates(problem: Problem, effects: Mapping[str, type] | None = None) -> tuple[Hypothesis, ...]:
    """All variants, each with its share of its effect's prior; ``effects`` by name (default: all installed ones).

    Places (``x_m``, ``y_m``) are settings here: a fit may free them. They reach as far as the aircraft does, if that is
    larger than those that the catalogue has in mind. Of an effect with more than a thousand variants as many are taken,
    spread evenly over all. Those of somebody else's effect that fail are left out, and a warning says so. Effects that
    the scenario :func:`cannot_have` are no candidates. InputError for ``effects`` under other names than their own.
    """
    found: list[Hypothesis] = []
    box, numbers = aircraft_box_m(problem.scenario.airframe), problem.measured.run_numbers
    declared = {table.name for table in problem.scenario.effect} - _AGAIN
    for name, cls in _known(effects).items():
        if name in declared:
            continue
        variants = _that_act(problem, cls, _spread(list(_variants(problem, cls))))
        if _refusal(problem, cls, variants) is not None:
            continue
        spans = reach(parameters_of(cls), box)
        count = len({tuple(v.get(name) for name in _TIED) for v in variants})
        share = 1.0 / max(_of_all_runs(problem, variants), 1.0)
        found += [Hypothesis(cls, chosen, share, spans, count, numbers) for chosen in variants]
    return tuple(found)


def some_candidates(problem: Problem, effects: Mapping[str, type] | None = None) -> tuple[Hypothesis, ...]:
    """:func:`candidates`; InputError where there are effects to choose from and no variant of any.

    That nothing explains the data is no answer where nothing was asked.
    """
    found, known = candidates(problem, effects), _known(effects)
    if known and not found:
        why = "".join(f"; {name}: {error.problem}" for name, error in sorted(cannot_have(problem, effects).items()))
        raise InputError(
            "the effects to choose from",
            f"leave nothing to try: no variant of {', '.join(sorted(known))} could show in this campaign{why}",
            "choose another effect",
        )
    return found


def cannot_have(problem: Problem, effects: Mapping[str, type] | None = None) -> dict[str, InputError]:
    """Why the aircraft, or its rig, can have no variant of some ``effects`` (default: all installed ones), by name.

    Wings on a mount have no centre section that twists, a shaker on a wing puts no moment on the body.
    """
    known = _known(effects)
    asked = {name: _refusal(problem, cls, _spread(list(_variants(problem, cls)))) for name, cls in known.items()}
    return {name: error for name, error in asked.items() if error is not None}


def _known(effects: Mapping[str, type] | None) -> Mapping[str, type]:
    """Effects by name, all installed ones for None."""
    if effects is None:
        return available_effects()
    check_effects(effects)
    return effects


def _refusal(problem: Problem, cls: type, variants: list[dict[str, Any]]) -> InputError | None:
    """Why a scenario can have none of some variants; None where it can have one, or there are none to ask."""
    found = None
    for hypothesis in (Hypothesis(cls, settings) for settings in variants):
        for share in _ASKED_AT:
            try:
                effect = hypothesis.made({p.name: p.at(share) for p in hypothesis.parameters})
                if effect is not None:
                    action_of(effect, problem.scenario, 0)
                    return None
            except InputError as error:
                found = error
            except PluginError:
                return None
    return found


def _spread(variants: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """No more than the most, evenly: a cut at the end would leave out the last sensors, always the same."""
    if len(variants) <= _MOST:
        return variants
    return [variants[k] for k in np.linspace(0, len(variants) - 1, _MOST).round().astype(int)]


def _that_act(problem: Problem, cls: type, variants: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Variants of an effect without those that fail in the middle of what is plausible; bundled ones are not asked."""
    if is_bundled(cls.__module__):
        return variants
    kept, faults = [], []
    for settings in variants:
        try:
            with suppress(InputError):  # a variant that a scenario cannot have is refused where it is tried
                _act_once(problem, Hypothesis(cls, settings))
        except PluginError as error:
            faults.append(str(error))
        else:
            kept.append(settings)
    if faults:
        count = f"{len(faults)} of {len(variants)} variants left out"
        warnings.warn(f"{faults[0]}; {count}", EffectPluginWarning, stacklevel=1)
    return kept


def _of_all_runs(problem: Problem, variants: list[dict[str, Any]]) -> float:
    """How many variants there are with those that begin at the runs between: each of these may be fitted, too."""
    begun = {v["from_run"] for v in variants if "from_run" in v}
    each = (len(problem.measured.runs) - 1) / len(begun) if len(begun) > 1 else 1.0
    return sum(each if "from_run" in v else 1.0 for v in variants)


def _act_once(problem: Problem, hypothesis: Hypothesis) -> None:
    """Ask an effect what it does in every run, the aircraft as stated, and its filters at the campaign's lines."""
    effect = hypothesis.made({p.name: p.at(0.5) for p in hypothesis.parameters})
    if effect is not None:
        for run in range(len(problem.measured.runs)):
            for change in action_of(effect, problem.scenario, run).channels:
                if isinstance(change, ChannelFilter):
                    change.response(problem.measured.frequency_hz)


def freed(hypothesis: Hypothesis) -> Hypothesis:
    """The same variant with its place, if it has one, free to be fitted; a size that was left out stays out.

    It stands for the variants at all places then: the prior of a place that is fitted pays for where it is, once.
    """
    placed = {p.name for p in parameters_of(hypothesis.cls) if p.neutral is None}
    kept = {k: v for k, v in hypothesis.settings.items() if k not in placed}
    if len(kept) == len(hypothesis.settings):
        return hypothesis
    return dataclasses.replace(hypothesis, settings=kept, share=hypothesis.share * hypothesis.places, places=1)


def places(problem: Problem) -> tuple[tuple[float, float], ...]:
    """Points (x, y) over the aircraft: the drive point, along the centre line, and along each beam at its middle."""
    driven = problem.scenario.shaker.position_m
    # What sits on the drive point is told from what hangs below the gauge by little: it must be offered there.
    points = [(float(driven[0]), float(driven[1])), *on_centre_line(problem)]
    points += [point for beam in _on_beams(problem) for point in beam]
    return tuple(dict.fromkeys((round(a, 4), round(b, 4)) for a, b in points))


def _on_beams(problem: Problem) -> list[list[tuple[float, float]]]:
    """Points (x, y) of each beam at its middle, from root to tip."""
    beams: list[list[tuple[float, float]]] = []
    for beam in expanded_beams(problem.scenario.airframe):
        forward, aft = edge_lines_m(beam)
        middle = (forward + aft) / 2
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(middle, axis=0), axis=1))])
        arc /= arc[-1]
        shares = [min(float(share), 0.97) for share in (np.arange(_STATIONS) + 0.75) / _STATIONS]
        beams.append([(float(np.interp(v, arc, middle[:, 0])), float(np.interp(v, arc, middle[:, 1]))) for v in shares])
    return beams


def tied_places(problem: Problem) -> tuple[tuple[float, float, float, float], ...]:
    """Points (x, y, other x, other y) for what ties two places together: of beams to the body, and to each other.

    An end on the body does not move against it: a fit that begins there finds no way off it.
    """
    beams, (_, middle, _) = _on_beams(problem), on_centre_line(problem)
    pairs = [(point, middle) for beam in beams for point in beam]
    # The ends of a tie are free to move where it is fitted: two of each beam will do.
    pairs += itertools.combinations([point for beam in beams for point in beam[2::3]], 2)
    rounded = ((round(a, 4), round(b, 4), round(c, 4), round(d, 4)) for (a, b), (c, d) in pairs)
    # From above a fin is a point.
    return tuple(dict.fromkeys(tie for tie in rounded if tie[:2] != tie[2:]))


def _variants(problem: Problem, cls: type) -> typing.Iterator[dict[str, Any]]:
    """Settings of every variant of an effect."""
    hints = typing.get_type_hints(cls)
    numbers = {p.name for p in parameters_of(cls)}
    choices: dict[str, tuple[Any, ...]] = {}
    for f in dataclasses.fields(cls):
        if f.name in numbers:
            continue
        options = _options(problem, f.name, hints[f.name])
        if options is not None:
            choices[f.name] = options
    at: tuple[dict[str, float], ...] = ({},)
    for names, points in ((_TIED, tied_places), (_TIED[:2], places)):
        if set(names) <= numbers:
            at = tuple(dict(zip(names, point, strict=True)) for point in points(problem))
            break
    pairs, courses = _pairs(problem, choices), _courses(problem, choices)
    for pair in pairs:
        for values in itertools.product(*choices.values()):
            for course, place in itertools.product(courses, at):
                yield pair | dict(zip(choices, values, strict=True)) | course | place


def _pairs(problem: Problem, choices: dict[str, tuple[Any, ...]]) -> list[dict[str, Any]]:
    """Two nodes that may have been taken for one another, out of ``choices``; one empty choice where there are none."""
    if not {"node", "other_node"} <= set(choices):
        return [{}]
    nodes = choices.pop("node")
    choices.pop("other_node")
    return [{"node": a, "other_node": b} for a, b in itertools.combinations(nodes, 2) if _near(problem, a, b)]


def _courses(problem: Problem, choices: dict[str, tuple[Any, ...]]) -> list[dict[str, Any]]:
    """What a change between runs may go like, out of ``choices``: the run counts for a step alone.

    Channels that are left in ``choices`` are those that could change.
    """
    if not {"shape", "from_run"} <= set(choices):
        return [{}]
    if "channels" in choices:
        choices["channels"] = tuple(c for c in choices["channels"] if _in_more_runs_than_one(problem, c))
    runs = choices.pop("from_run")
    shapes: list[dict[str, Any]] = [{"shape": s} for s in choices.pop("shape") if s != "step"]
    return [*shapes, *({"shape": "step", "from_run": run} for run in runs)]


def _options(problem: Problem, name: str, hint: Any) -> tuple[Any, ...] | None:
    """What a setting can be in this campaign; None keeps its default."""
    runs = problem.measured.runs
    literal = typing.get_args(hint) if typing.get_origin(hint) is typing.Literal else None
    if literal is not None:
        return tuple(literal)
    if name in ("node", "other_node"):
        return tuple(dict.fromkeys(n for run in runs for n in run))
    if name == "from_run":
        count = len(runs)
        steps = np.unique(np.linspace(2, max(count, 2), min(_FROM_RUNS, max(count - 1, 1))).round().astype(int))
        return tuple(int(k) for k in steps)
    if name in ("channels", "sensors"):
        instruments = [f"sensor-{k + 1}" for k in range(max(len(r) for r in runs))] if len(runs) > 1 else []
        labels = [str(p.dof) for p in problem.layouts.first.grid if any(p.dof.node in r for r in runs)]
        force = ["force"] if name == "channels" else []
        return ("response", *force, *(instruments or ["odd", "even"]), *labels)
    if name == "item":
        held = dict.fromkeys(plain_name(i.name) for i in problem.scenario.airframe.item if i.attached_to != "body")
        return tuple(held) or None
    return None


def _in_more_runs_than_one(problem: Problem, channels: str) -> bool:
    """Whether channels could change between runs at all: what a point shows in its only run has always been so."""
    nodes = {str(p.dof): p.dof.node for p in problem.layouts.first.grid}
    return channels not in nodes or sum(nodes[channels] in run for run in problem.measured.runs) > 1


def _near(problem: Problem, one: int, other: int) -> bool:
    """Whether two sensors are likely to be taken for one another: in one run, or mirror images."""
    if any(one in run and other in run for run in problem.measured.runs):
        return True
    grid = {p.dof.node: p.position_m for p in problem.layouts.first.grid}
    a, b = grid[one], grid[other]
    return bool(np.hypot(a[0] - b[0], a[1] + b[1]) < 0.02)
