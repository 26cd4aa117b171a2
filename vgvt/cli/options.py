"""Options that several commands share, and their checks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from vgvt.scenario.model import Scenario

JsonOption = Annotated[bool, typer.Option("--json", help="Print exactly one JSON object on stdout.")]
BandOption = Annotated[
    tuple[float, float] | None,
    typer.Option("--band", metavar="LOW HIGH", help="Frequency band in Hz; the excited band when left out."),
]
LeaveOutFaultyOption = Annotated[
    bool, typer.Option("--leave-out-faulty", help="Go on without channels that are dead, saturated or hold NaN.")
]
SeedOption = Annotated[int | None, typer.Option(min=0, help="Seed of the noise, instead of the scenario's own.")]
EngineOption = Annotated[
    str | None, typer.Option(metavar="mujoco|linear", help="Engine of the simulation, instead of the scenario's own.")
]
ScenarioArgument = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="Name of a bundled scenario or path of a .toml file.")
]
CampaignArgument = Annotated[
    str,
    typer.Argument(
        metavar="CAMPAIGN", help="A campaign.nc, a run folder, the .toml that describes records, or a data set's name."
    ),
]


def resolved_scenario(name: str, seed: int | None, engine: str | None, *, own_runs: bool = True) -> Scenario:
    """The scenario with the command line's seed and engine put in; ``own_runs`` as in :func:`described_scenario`."""
    from vgvt.cli.described import described_scenario

    return as_chosen(described_scenario(name, own_runs=own_runs), seed, engine)


def as_chosen(scenario: Scenario, seed: int | None, engine: str | None) -> Scenario:
    """A scenario with a seed and an engine, None for its own; InputError for an engine that there is not."""
    from vgvt.data import InputError

    changes: dict[str, Any] = {}
    if seed is not None:
        changes["seed"] = seed
    if engine is not None:
        if engine not in ("mujoco", "linear"):
            raise InputError("--engine", f"there is no engine {engine!r}", "write mujoco or linear")
        changes["simulation"] = scenario.simulation.model_copy(update={"engine": engine})
    return scenario.model_copy(update=changes) if changes else scenario


def settings_by_identifier(pairs: list[str], names: list[str]) -> dict[str, dict[str, str]]:
    """Settings written as key=value, for every identifier, or as NAME.key=value, for the one of that name."""
    from vgvt.data import InputError

    settings: dict[str, dict[str, str]] = {name: {} for name in names}
    for pair in pairs:
        owner, dot, _ = pair.partition("=")[0].rpartition(".")
        if dot and owner not in settings:
            raise InputError("--setting", f"{owner!r} is not used in this run", f"used are {', '.join(names)}")
        rest = pair[len(owner) + 1 :] if dot else pair
        for name in [owner] if dot else names:
            settings[name] |= parsed_settings([rest])
    return settings


def parsed_settings(pairs: list[str]) -> dict[str, str]:
    """Settings written as key=value; the identifier gives the text its type."""
    from vgvt.data import InputError

    settings: dict[str, str] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        key = key.strip().replace("-", "_")
        if not equals or not key.isidentifier():
            raise InputError("--setting", f"{pair!r} is not a setting", "write key=value, like --setting order=12")
        settings[key] = text.strip()
    return settings
