"""``vgvt data``: measured campaigns: fetched, found, and described."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from vgvt.cli.boundary import CommandError
from vgvt.cli.console import log, progress, show
from vgvt.cli.describe import describe
from vgvt.cli.document import write_document
from vgvt.cli.options import JsonOption

_DEFAULT = "hati-2015-09-24"

data_app = typer.Typer(help="Fetch, find and describe measured campaigns.")
data_app.command()(describe)


@data_app.callback(invoke_without_command=True)
def data_what(context: typer.Context) -> None:
    """Fetch, find and describe measured campaigns."""
    if context.invoked_subcommand is None:
        raise typer.BadParameter("say what to do: get, list, where or describe", ctx=context)


@data_app.command()
def get(
    name: Annotated[str, typer.Argument(metavar="NAME", help="See: vgvt data list.")] = _DEFAULT,
    to: Annotated[
        Path | None, typer.Option("--to", metavar="FOLDER", help="Where to; see: vgvt data where, when left out.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Fetch the records of a measured campaign and check their hashes.

    What is there already is kept, so a broken download goes on where it stopped.
    """
    from vgvt.files.fetch import DownloadError, fetch_measured

    try:
        with progress(f"get {name}") as report:
            folder = fetch_measured(name, to, report)
    except DownloadError as error:
        raise CommandError(str(error), "check the network and give the command again; it keeps what it has") from None
    except KeyboardInterrupt:
        log("the files that came whole are kept; give the command again to go on")
        raise
    if as_json:
        write_document({"name": name, "folder": folder})
    else:
        show(f"{name} is in {folder}")
    return 0


@data_app.command("list")
def list_data(as_json: JsonOption = False) -> int:
    """List the measured campaigns that vgvt can read, and which are on this machine."""
    items = data_sets()
    if as_json:
        write_document({"items": items})
        return 0
    from vgvt.cli.tables import items_table

    rows = [{**item, "on this machine": item["folder"] or "no"} for item in items]
    show(items_table(rows, ("name", "summary", "on this machine")))
    return 0


@data_app.command()
def where(as_json: JsonOption = False) -> int:
    """Say where measured campaigns are looked for, and where get puts them."""
    from vgvt.files.locate import DATA_VARIABLE, data_folders, default_data_folder

    fetched_into = default_data_folder()
    searched = [{"folder": folder, "exists": folder.is_dir()} for folder in data_folders()]
    if as_json:
        write_document({"searched": searched, "fetched_into": fetched_into, "variable": DATA_VARIABLE})
        return 0
    for place in searched:
        show(f"looked for in {place['folder']}" + ("" if place["exists"] else " (does not exist)"))
    show(f"fetched into {fetched_into}")
    show(f"{DATA_VARIABLE} names another folder")
    return 0


def data_sets() -> list[dict[str, Any]]:
    """Every measured campaign that vgvt ships a description of: name, summary, folder (None where absent)."""
    from vgvt.files.open import measured_names, shipped_sidecar
    from vgvt.files.sidecar import Sidecar
    from vgvt.files.strict import load_table

    items: list[dict[str, Any]] = []
    for name in measured_names():
        sidecar = load_table(shipped_sidecar(name), Sidecar)
        folder = _folder_of(sidecar)
        items.append(
            {
                "name": name,
                "summary": sidecar.summary,
                "runs": len(sidecar.run),
                "band_hz": list(sidecar.band_hz),
                "can_be_fetched": sidecar.source is not None,
                "found": folder is not None,
                "folder": folder,
                "traps": list(sidecar.traps),
            }
        )
    return items


def _folder_of(sidecar: Any) -> Path | None:
    from vgvt.data import InputError
    from vgvt.files.locate import find_dataset

    records = sidecar.records
    try:
        return find_dataset(records.dataset or sidecar.name, (Path(records.folder) / sidecar.run[0].file).as_posix())
    except InputError:
        return None
