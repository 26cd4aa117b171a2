"""A rehearsal: a campaign of a scenario in which nothing is missing, taken through the whole loop.

Whatever is named is a false alarm; what is left, and what the best candidate would have gained, is what a limit has to
stay above.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from vgvt.data import Campaign, InputError
from vgvt.reconcile.decision.kinds import Kind
from vgvt.reconcile.loop import reconcile
from vgvt.reconcile.placebo import Placebo
from vgvt.reconcile.question.drawn import drawn_gains, drawn_lab
from vgvt.reconcile.question.suitable import banded, check_excitation
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream
from vgvt.simulation import simulated_campaign

Progress = Callable[[float, str], None]
# Aircraft that find no rest are drawn anew.
_DRAWS = 5
_SIMULATED = 0.2


@dataclass(frozen=True, slots=True)
class Rehearsal:
    """What one campaign without any missing effect came to: its verdict, the effects it named, and its figures."""

    number: int
    kind: Kind
    named: tuple[str, ...]
    placebo: Placebo


def rehearsed(
    scenario: Scenario,
    number: int,
    *,
    effects: Mapping[str, type] | None = None,
    thresholds: Thresholds | None = None,
    lines: int = 500,
    band_hz: tuple[float, float] | None = None,
    progress: Progress | None = None,
) -> Rehearsal:
    """Draw a lab within the scenario's tolerances, simulate its campaign, and reconcile it with the scenario as stated.

    ``number`` counts from 1: each is another lab, the same for the same scenario and seed. The engine is the linear
    one, with the noise of the scenario's instruments. ``effects``, ``thresholds`` and ``lines`` as in
    :func:`vgvt.reconcile.reconcile`. InputError for what no reconciliation takes, and for tolerances that hold hardly
    any aircraft that hangs.
    """
    tell = progress or (lambda _fraction, _message: None)
    check_excitation(scenario)
    campaign = banded(placebo_campaign(scenario, number, lambda f, m: tell(_SIMULATED * f, m)), band_hz)
    verdict = reconcile(
        campaign, scenario, effects=effects, thresholds=thresholds, lines=lines, with_tests=False,
        progress=lambda f, m, _: tell(_SIMULATED + (1 - _SIMULATED) * f, m),
    )  # fmt: skip
    return Rehearsal(number, verdict.kind, tuple(e.name for e in verdict.effects), Placebo.of(verdict))


def placebo_campaign(scenario: Scenario, number: int, progress: Progress | None = None) -> Campaign:
    """The campaign of a lab that differs from a scenario as its tolerances allow, and in nothing else.

    ``number`` as in :func:`rehearsed`; InputError where none of some labs has an aircraft that hangs.
    """
    problem = ""
    for draw in range(_DRAWS):
        stream = named_stream(scenario.seed, "placebo", number, draw)
        lab = drawn_lab(scenario, stream).model_copy(update={"seed": int(stream.integers(2**31))})
        try:
            campaign = simulated_campaign(lab, engine="linear", progress=progress)
        except (InputError, RuntimeError) as error:
            problem = error.problem if isinstance(error, InputError) else str(error)
            continue
        return replace(drawn_gains(campaign, scenario.tolerances, stream), name=f"placebo-{number}", notes={})
    raise InputError(
        f"scenario {scenario.name}: tolerances",
        f"of {_DRAWS} labs drawn within them none has an aircraft that can be simulated ({problem})",
        "make [tolerances] smaller",
    )
