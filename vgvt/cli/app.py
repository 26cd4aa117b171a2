"""The application: every command under its name."""

from __future__ import annotations

from typing import Annotated

import typer

from vgvt import __version__
from vgvt.cli.bench import bench
from vgvt.cli.cite import cite
from vgvt.cli.convert import convert
from vgvt.cli.data import data_app
from vgvt.cli.doctor import doctor
from vgvt.cli.identify import identify
from vgvt.cli.inspect import inspect
from vgvt.cli.listing import list_app
from vgvt.cli.plan import plan
from vgvt.cli.reconcile import reconcile
from vgvt.cli.run import run
from vgvt.cli.schema import schema
from vgvt.cli.score import score
from vgvt.cli.show import show_scenario
from vgvt.cli.simulate import simulate
from vgvt.cli.sweep import sweep

app = typer.Typer(
    name="vgvt",
    help="Virtual ground vibration test: from the shaker's coil to the scored mode shape.",
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def entry(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Virtual ground vibration test: from the shaker's coil to the scored mode shape."""
    if version:
        typer.echo(f"vgvt {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


_TEST, _LOOK, _HELP = "The test", "Look around", "Set up"

app.command(rich_help_panel=_TEST)(run)
app.command(rich_help_panel=_TEST)(simulate)
app.command(rich_help_panel=_TEST)(identify)
app.command(rich_help_panel=_TEST)(score)
app.command(rich_help_panel=_TEST)(bench)
app.command(rich_help_panel=_TEST)(reconcile)
app.command(rich_help_panel=_TEST)(sweep)
app.command(rich_help_panel=_TEST)(plan)
app.add_typer(list_app, name="list", rich_help_panel=_LOOK)
app.command("show", rich_help_panel=_LOOK)(show_scenario)
app.command(rich_help_panel=_LOOK)(inspect)
app.command(rich_help_panel=_LOOK)(convert)
app.command(rich_help_panel=_LOOK)(schema)
app.command(rich_help_panel=_LOOK)(cite)
app.add_typer(data_app, name="data", rich_help_panel=_HELP)
app.command(rich_help_panel=_HELP)(doctor)
