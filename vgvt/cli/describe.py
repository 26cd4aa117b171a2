"""``vgvt data describe``: a sidecar for Universal Files or TDMS files, as far as they describe themselves."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import show
from vgvt.cli.document import write_document
from vgvt.cli.new_folders import none_left_empty
from vgvt.cli.options import JsonOption

if TYPE_CHECKING:
    from vgvt.files.describe.draft import Description


def describe(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Universal Files or TDMS files of one campaign.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.toml",
            help="The sidecar. Default: beside the file, under its name; of several, under their folder's.",
        ),
    ] = None,
    band: Annotated[
        tuple[float, float] | None, typer.Option(metavar="LOW HIGH", help="The excited band in Hz. Default: a guess.")
    ] = None,
    axes: Annotated[
        tuple[str, str, str] | None,
        typer.Option(
            metavar="AFT RIGHT UP", help="The axes of the places that point there, like y -x z. Default: x y z."
        ),
    ] = None,
    columns: Annotated[
        int | None,
        typer.Option(min=1, help="Channels of a run. Default: the most in which no DOF (TDMS: no name) comes twice."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a sidecar that is there already.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Write a sidecar for Universal Files (UFF) or TDMS files: places, channels, units and runs, as far as they say.

    The band, when left out, is a guess: from ten periods in the shortest run to the sample rate over 2.56.
    Guesses are marked CHECK in the sidecar, gaps MISSING; without a gap it has been read once with its records.
    TDMS files state no places: there these are always a gap.
    """
    from vgvt.data import InputError

    # What is given before what is written: a wrong file is wrong wherever its sidecar would go.
    describer = _describer(files)
    path = _default(files) if out is None else out
    if path.is_dir():
        raise InputError(str(path), "is a folder", f"name the sidecar in it, like --out {path / 'my-test.toml'}")
    if path.suffix != ".toml":
        raise InputError(str(path), "a sidecar is a .toml file", f"write --out {path.with_suffix('.toml')}")
    if os.path.lexists(path) and not force:
        raise InputError(str(path), "is there already", "keep both with --out OTHER.toml, or replace it with --force")
    if band is not None and not 0 < band[0] < band[1] < float("inf"):
        raise InputError("--band", f"{band[0]:g} {band[1]:g} is no band", "write the lowest and the highest, in Hz")
    with none_left_empty(path.parent):
        description = describer(files, path, band_hz=band, axes=axes, columns=columns)
    if as_json:
        write_document(_document(description))
    else:
        _say(description)
    return 0


def _describer(files: list[Path]) -> Callable[..., Description]:
    """What describes some files, by their endings; InputError where they are of two kinds, or one is not of its own."""
    from vgvt.data import InputError
    from vgvt.files.tdms.describe import describe_tdms
    from vgvt.files.tdms.segments import check_segments
    from vgvt.files.uff.cut import check_start
    from vgvt.files.uff.describe import describe_uff

    for file in files:
        if file.is_dir():
            raise InputError(str(file), "is a folder", "name the Universal Files or TDMS files in it")
    # The index beside a TDMS file is told by its reader.
    tdms = [file for file in files if file.suffix.lower().startswith(".tdms")]
    others = [str(file) for file in files if file not in tdms]
    if tdms and others:
        raise InputError(
            others[0],
            f"is not of the kind of {tdms[0]}, and a sidecar is of one kind of file",
            "describe TDMS files by themselves, and Universal Files by themselves",
        )
    for file in files:
        (check_segments if tdms else check_start)(file)
    return describe_tdms if tdms else describe_uff


def _default(files: list[Path]) -> Path:
    if len(files) == 1:
        return files[0].with_suffix(".toml")
    folder = Path(os.path.commonpath([file.parent.resolve() for file in files]))
    return Path(os.path.relpath(folder / f"{folder.name or 'campaign'}.toml"))


def _say(description: Description) -> None:
    for remark in description.remarks:
        show(remark)
    show(
        f"{description.path} describes {_counted(len(description.runs), 'run')} "
        f"of {_counted(len(description.channels), 'channel')}"
    )
    for words in description.missing:
        show(f"still to be written in it: {words}")
    if description.missing:
        show("each place is marked MISSING; what was guessed is marked CHECK")
    else:
        show(f"see what is marked CHECK in it, then: vgvt inspect {description.path}")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _document(description: Description) -> dict[str, Any]:
    return {
        "sidecar": description.path,
        "name": description.name,
        "band_hz": description.band_hz,
        "channels": [
            {
                "name": channel.name,
                "role": channel.role,
                "quantity": channel.quantity or None,
                "unit": channel.unit or None,
                "column": channel.column,
                "variable": channel.variable or None,
                "dofs": list(channel.places),
            }
            for channel in description.channels
        ],
        "runs": [
            {
                "run": number,
                "file": run.path,
                "index": run.index,
                "first": run.first,
                "last": run.last,
                "samples": run.samples,
                "sample_rate_hz": run.sample_rate_hz,
            }
            for number, run in enumerate(description.runs, start=1)
        ],
        "missing": description.missing,
        "remarks": description.remarks,
    }
