"""``vgvt list``: what there is to choose from."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from vgvt.cli.console import show
from vgvt.cli.document import write_document
from vgvt.cli.options import JsonOption

_EXPENDABLE = ("sample_rate_hz", "duration_s", "runs")  # left to --json where the terminal is narrow

list_app = typer.Typer(help="List scenarios, identifiers or effects.", no_args_is_help=False)


@list_app.callback(invoke_without_command=True)
def list_what(context: typer.Context) -> None:
    """List scenarios, identifiers or effects."""
    if context.invoked_subcommand is None:
        raise typer.BadParameter("say what to list: scenarios, identifiers or effects", ctx=context)


@list_app.command()
def scenarios(
    spoiled: Annotated[
        bool, typer.Option("--spoiled", help="The small ones instead, each spoiled by one effect.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """List the bundled scenarios."""
    from vgvt.scenario import bundled_scenarios, load_scenario, spoiled_scenarios

    small = spoiled_scenarios()
    items: list[dict[str, Any]] = []
    for name in small if spoiled else bundled_scenarios():
        scenario = load_scenario(name)
        acquisition, excitation = scenario.acquisition, scenario.excitation
        items.append(
            {
                "name": name,
                "summary": scenario.summary,
                "lesson": scenario.lesson,
                "aircraft": scenario.airframe.name,
                "effects": [table.name for table in scenario.effect],
                "runs": len(acquisition.run_nodes),
                "duration_s": excitation.record_s,
                "sample_rate_hz": acquisition.sample_rate_hz,
                "band_hz": list(excitation.recorded_band_hz),
            }
        )
    if spoiled:
        return _list(items, ("name", "summary", "lesson"), as_json)
    columns = ("name", "aircraft", "runs", "duration_s", "sample_rate_hz", "summary")
    status = _list(items, columns, as_json, _EXPENDABLE)
    if small and not as_json:
        show(f"and {len(small)} small ones, each spoiled by one effect: vgvt list scenarios --spoiled")
    return status


@list_app.command()
def identifiers(as_json: JsonOption = False) -> int:
    """List the installed identification methods and their settings."""
    from vgvt.identification import absent_identifiers, available_identifiers, settings_of

    items: list[dict[str, Any]] = []
    for name, cls in available_identifiers().items():
        needs: Any = getattr(cls, "needs", None)
        settings = [
            {"name": s.name, "type": s.type, "default": _number_or_text(s.default), "meaning": s.doc}
            for s in settings_of(cls)
        ]
        items.append(
            {
                "name": name,
                "summary": str(getattr(cls, "summary", "")),
                "needs": [str(need.name).lower() for need in needs or ()],
                "settings": settings,
            }
        )
    rows = [{**item, "setting": ", ".join(f"{s['name']}={s['default']}" for s in item["settings"])} for item in items]
    status = _list(items if as_json else rows, ("name", "summary", "setting"), as_json)
    for name, install in () if as_json else absent_identifiers().items():
        show(f"not listed, as it lacks a library: {name} ({install})")
    return status


@list_app.command()
def effects(as_json: JsonOption = False) -> int:
    """List the installed effects: physics that a scenario can switch on."""
    import dataclasses

    from vgvt.effects import available_effects, parameters_of

    items: list[dict[str, Any]] = []
    for name, cls in available_effects().items():
        effect: Any = cls
        parameters = parameters_of(cls)
        fields = {f.name: f for f in dataclasses.fields(effect)}
        settings = [f for key, f in fields.items() if key not in {p.name for p in parameters}]
        items.append(
            {
                "name": name,
                "summary": effect.summary,
                "family": str(effect.family),
                "linear": effect.linear,
                "signature": effect.signature,
                "confused_with": list(effect.confused_with),
                "separating_test": effect.separating_test,
                "reference": effect.reference,
                "parameters": [
                    {
                        "name": p.name,
                        "unit": p.unit,
                        "default": fields[p.name].default,
                        "neutral": p.neutral,
                        "plausible_range": [p.low, p.high],
                        "scale": p.scale,
                        "meaning": p.doc,
                        "source": p.source,
                    }
                    for p in parameters
                ],
                "settings": [
                    {"name": f.name, "default": f.default, "meaning": f.metadata.get("doc", "")} for f in settings
                ],
                "parameter": ", ".join(fields),
            }
        )
    return _list(items, ("name", "family", "summary", "parameter"), as_json)


def _number_or_text(default: Any) -> Any:
    """A default that is written as a number becomes one."""
    for kind in (int, float):
        try:
            return kind(default) if isinstance(default, str) else default
        except ValueError:
            continue
    return default


def _list(
    items: list[dict[str, Any]], columns: tuple[str, ...], as_json: bool, expendable: tuple[str, ...] = ()
) -> int:
    if as_json:
        write_document({"items": items})
        return 0
    from vgvt.cli.tables import items_table

    show(items_table(items, columns, expendable) if items else "none installed")
    return 0
