"""``vgvt plan``: the test that would identify the modes best within a budget."""

from __future__ import annotations

import math
import os
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, progress, show
from vgvt.cli.document import write_document
from vgvt.cli.hanging import hanging_askew
from vgvt.cli.options import JsonOption, ScenarioArgument
from vgvt.cli.results_folder import checked_folder, telling_what_is_kept

if TYPE_CHECKING:
    from vgvt.planning.planner import Order
    from vgvt.planning.proposal import Proposal
    from vgvt.planning.result import PlanningResult
    from vgvt.scenario.model import Scenario

_LAB = "The lab's own times and limits"
_CONFIRM = "Confirmation"
_FILES = ("plan.toml", "plan.svg", "card.html")
_LEVEL_IT = "level it with a counterweight, and write that into the scenario as an [[airframe.item]]"


def plan(
    scenario: ScenarioArgument,
    minutes: Annotated[float, typer.Option(min=0.1, help="Minutes in the lab, setting up included.")] = 20.0,
    sensors: Annotated[int, typer.Option(min=1, help="Accelerometers that are recorded at once.")] = 20,
    free: Annotated[
        str, typer.Option(metavar="WORDS", help="What may change, of shaker,sensors,band,sweep-time,level,mount.")
    ] = "shaker,sensors,band,sweep-time,level,mount",
    modes: Annotated[
        str | None, typer.Option(metavar="HZ,HZ,...", help="The modes that count, by frequency. Default: all swept.")
    ] = None,
    points: Annotated[
        int | None,
        typer.Option(min=1, help="Points to measure, where sensors are free. Default: as now, or as --sensors."),
    ] = None,
    max_volts: Annotated[
        float | None,
        typer.Option(min=1e-6, help="Largest peak of the command. Default: what it is now.", rich_help_panel=_LAB),
    ] = None,
    max_automac: Annotated[
        float, typer.Option(min=0.01, max=1.0, help="Two shapes may be this alike at the points.", rich_help_panel=_LAB)
    ] = 0.25,
    setup_minutes: Annotated[
        float, typer.Option(min=0, help="To place the accelerometers of one run.", rich_help_panel=_LAB)
    ] = 0.5,
    mount_minutes: Annotated[
        float, typer.Option(min=0, help="To fix the transducer with what must cure.", rich_help_panel=_LAB)
    ] = 5.0,
    clay_minutes: Annotated[
        float, typer.Option(min=0, help="To fix the transducer with clay.", rich_help_panel=_LAB)
    ] = 1.0,
    longest_sweep: Annotated[
        float, typer.Option(min=1, metavar="SECONDS", help="More time goes into repeats.", rich_help_panel=_LAB)
    ] = 300.0,
    seeds: Annotated[
        int, typer.Option(min=0, help="Simulated campaigns of a plan, two or more; 0: none.", rich_help_panel=_CONFIRM)
    ] = 6,
    confirm: Annotated[
        int, typer.Option(min=1, help="How many of the best plans are simulated.", rich_help_panel=_CONFIRM)
    ] = 1,
    identifier: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Who identifies them: a method, or informed: a fit that is told the noise.",
            rich_help_panel=_CONFIRM,
        ),
    ] = "auto",
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Where the plan's files go.")] = Path("plan"),
    as_json: JsonOption = False,
) -> int:
    """Find the test that knows the worst mode best: where to shake, where to measure, how to sweep.

    Candidates are compared by Fisher information, without simulating them; the best is then simulated
    beside the scenario as it is. Writes the plan as a scenario, a drawing and a test card.
    """
    from vgvt.cli.described import described_scenario
    from vgvt.data import InputError
    from vgvt.data.suggestion import choose_one_of, nearest
    from vgvt.identification import available_identifiers, make_identifier
    from vgvt.planning.budget import Budget
    from vgvt.planning.informed import INFORMED
    from vgvt.planning.planner import Order, checked_free, plan_test

    given = {
        "--minutes": minutes, "--setup-minutes": setup_minutes, "--mount-minutes": mount_minutes,
        "--clay-minutes": clay_minutes, "--longest-sweep": longest_sweep, "--max-volts": max_volts or 1.0,
    }  # fmt: skip
    for option, value in given.items():
        if not math.isfinite(value):
            raise InputError(option, f"{value} has no end", "write a number")
    if seeds == 1:
        advice = "write 2 or more, or 0 for none"
        raise InputError("--seeds", "one campaign has no scatter to hold against a prediction", advice)
    described = described_scenario(scenario)
    if identifier not in (known := [*available_identifiers(), INFORMED]) and nearest(identifier, known) == INFORMED:
        raise InputError("--identifier", f"there is none called {identifier!r}", choose_one_of(identifier, known))
    if identifier != INFORMED:
        make_identifier(identifier)  # a misspelt name costs no time
    order = Order(
        budget=Budget(minutes, sensors, setup_minutes, mount_minutes, clay_minutes, longest_sweep),
        free=checked_free([word.strip() for word in free.split(",") if word.strip()]),
        modes_hz=_frequencies(modes),
        points=points,
        largest_peak_v=max_volts,
        largest_mac=max_automac,
        seeds=seeds,
        confirmed=confirm,
        identifier=identifier,
    )
    checked_folder(out, _FILES)
    with telling_what_is_kept(out), progress("plan") as report:
        result = plan_test(described, order, report)
    paths = _written(described, scenario, result, order, out)
    if as_json:
        write_document(
            {"scenario": described.name, "budget": order.budget.as_dict(), "free": sorted(order.free)}
            | result.as_dict()
            | {"scenario_file": None, "drawing": None, "card": None, "hangs_at_roll_pitch_deg": None}
            | paths
            | ({"hangs_at_roll_pitch_deg": _hangs_deg(result.plans[0].scenario)} if paths else {})
        )
    else:
        _show(result, paths)
    return 0


def _frequencies(text: str | None) -> tuple[float, ...]:
    from vgvt.data import InputError

    if text is None:
        return ()
    advice = "write them in Hz, like 8.2,15.8"
    try:
        found = tuple(float(part) for part in text.split(",") if part.strip())
    except ValueError:
        raise InputError("--modes", f"{text!r} are no frequencies", advice) from None
    if not found or not all(0 < hz < math.inf for hz in found):
        raise InputError("--modes", f"{text!r} are no frequencies", advice)
    return found


def _written(described: Scenario, name: str, result: PlanningResult, order: Order, folder: Path) -> dict[str, Path]:
    """Scenario, drawing and card of the best plan; nothing where nothing is gained."""
    from vgvt.files.atomically import replacing
    from vgvt.planning.result import Verdict
    from vgvt.planning.scenario_file import plan_toml
    from vgvt.view.lab_card import card_page
    from vgvt.view.plan_drawing import plan_drawing

    there = [name for name in _FILES if (folder / name).exists()]
    if result.verdict is not Verdict.BETTER:
        if there:
            log(f"{', '.join(there)} in {folder} {'is' if len(there) == 1 else 'are'} of an earlier plan")
        return {}
    best = result.plans[0]
    title = f"{described.name}, planned"
    summary = f"{described.name} as planned: {result.gain:.3g} times better for the mode that is known worst."
    texts = {
        "scenario_file": (
            folder / "plan.toml",
            plan_toml(described, _extends(name, folder), best.scenario, f"{described.name}-planned", summary),
        ),
        "drawing": (folder / "plan.svg", plan_drawing(best.scenario, title)),
        "card": (folder / "card.html", card_page(best.scenario, title, _facts(best, order))),
    }
    planned, text = texts["scenario_file"]
    if planned.exists() and planned.read_bytes() != text.encode():
        # Somebody may have edited it.
        log(f"the earlier {planned.name} is kept as {_kept_aside(planned)}")
    for path, text in texts.values():
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return {key: path for key, (path, _) in texts.items()}


def _kept_aside(path: Path) -> Path:
    """The file under a name that nothing has yet."""
    names = (path.with_name(f"plan-earlier{'' if k == 1 else f'-{k}'}.toml") for k in count(1))
    return path.rename(next(name for name in names if not name.exists()))


def _extends(name: str, folder: Path) -> str:
    """What the plan's file says after extends: a bundled name, or the way from the plan's folder to the file."""
    from vgvt.scenario.library import bundled_scenarios, spoiled_scenarios
    from vgvt.scenario.load import scenario_path

    if name in (*bundled_scenarios(), *spoiled_scenarios()):
        return name
    return Path(os.path.relpath(scenario_path(name), folder)).as_posix()


def _facts(best: Proposal, order: Order) -> Any:
    from vgvt.simulation.command import peak_command_v
    from vgvt.view.lab_card import CardFacts, ExpectedMode

    budget, expected = order.budget, best.prediction
    return CardFacts(
        mount=best.mount.words,
        mount_minutes=budget.mount_minutes if best.mount.cures else budget.clay_minutes,
        setup_minutes=budget.setup_minutes,
        minutes=best.minutes,
        modes=tuple(
            ExpectedMode(m.label, m.frequency_hz, m.frequency_std_hz, 100 * m.damping_ratio, m.relative_damping_std)
            for m in best.modes
        ),
        peak_command_v=peak_command_v(best.scenario),
        peak_force_n=expected.peak_force_n,
        peak_acceleration_m_per_s2=expected.peak_acceleration_m_per_s2,
        peak_drive_mm=expected.peak_drive_mm,
        hangs_deg=_hangs_deg(best.scenario),
    )


def _hangs_deg(planned: Scenario) -> tuple[tuple[float, float], ...]:
    """Roll and pitch at rest with each group of sensors, which a card and a plan count as its runs."""
    from vgvt.simulation.attitude import attitudes_deg

    return attitudes_deg(planned)[:: planned.acquisition.repeats]


def _show(result: PlanningResult, paths: dict[str, Path]) -> None:
    from rich.table import Table

    from vgvt.planning.result import LEAST_GAIN, Verdict

    plans = [result.as_described, *filter(None, [result.with_budget]), *result.plans]
    table = Table(title="std(ζ)/ζ of the target modes, per cent: from noise alone")
    for heading in ("plan", "min", "shaker x, y m", "mount", "sweep", "runs"):
        table.add_column(heading)
    for mode in result.as_described.modes:
        table.add_column(f"{mode.frequency_hz:.2f} Hz", justify="right")
    for plan in plans:
        table.add_row(*_words(plan), *(f"{100 * m.relative_damping_std:.2g}" for m in plan.modes))
        seen = result.confirmed.get(plan.name)
        if seen is not None:
            shares = 100 * seen.damping_ratio_std / [m.damping_ratio for m in plan.modes]
            note = f"  simulated, {seen.seeds} seeds (± {100 * seen.own_error:.0f} % of each)"
            table.add_row(note, *[""] * 5, *(f"{share:.2g}" for share in shares))
    show(table)
    for plan in plans:
        for words in plan.overloads:
            log(f"{plan.name}: {words}; turn the level down")
    if result.verdict is Verdict.NOTHING_TO_GAIN:
        better = f"the best plan found is {result.gain:.3g} times as good"
        if result.gain < LEAST_GAIN:
            show(f"Nothing to gain: {better}; {LEAST_GAIN:g} would count.")
        else:
            show(f"Nothing to gain: {better} by prediction, and {_not_borne_out(result)}.")
        return
    show(f"The worst mode: {result.gain:.3g} times better than as described" + _more(result))
    best = result.plans[0]
    askew = hanging_askew(_hangs_deg(best.scenario))
    if askew is not None:
        log(f"{best.name} {askew}; {_LEVEL_IT}")
    for key, path in paths.items():
        log(f"{key.replace('_', ' ')}: {path}")


def _not_borne_out(result: PlanningResult) -> str:
    """What simulated campaigns say against a plan."""
    seen, error = result.confirmed_gain or math.nan, 100 * (result.confirmed_gain_relative_error or 0.0)
    if seen > 0 and math.isfinite(seen):
        return f"{seen:.3g} ± {error:.0f} % times in simulated campaigns"
    return "simulated campaigns miss a mode more often than not"


def _more(result: PlanningResult) -> str:
    parts = []
    if result.confirmed_gain is not None:
        error = 100 * (result.confirmed_gain_relative_error or 0.0)
        parts.append(f"{result.confirmed_gain:.3g} ± {error:.0f} % in simulation")
    if result.gain_at_equal_means is not None:
        parts.append(f"{result.gain_at_equal_means:.3g} against the same shaker, points and band with this budget")
    return f" ({'; '.join(parts)})." if parts else "."


def _words(plan: Proposal) -> tuple[str, ...]:
    from vgvt.scenario.rig import RANDOM_KINDS

    scenario, e = plan.scenario, plan.scenario.excitation
    x, y, _ = scenario.shaker.position_m
    repeats = f"{scenario.acquisition.repeats} × " if scenario.acquisition.repeats > 1 else ""
    return (
        plan.name,
        f"{plan.minutes:.1f}",
        f"{x:.3f}, {y:.3f} on {scenario.shaker.attached_to}",
        plan.mount.name,
        f"{repeats}{e.kind} {e.start_hz:g}-{e.stop_hz:g} Hz in {e.duration_s:g} s, {e.amplitude_v:g} V"
        + (" rms" if e.kind in RANDOM_KINDS else ""),
        str(len(scenario.acquisition.runs)),
    )
