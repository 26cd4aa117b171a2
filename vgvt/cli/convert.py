"""``vgvt convert``: a campaign, or its frequency responses, in the format of another program."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, show
from vgvt.cli.document import write_document
from vgvt.cli.new_folders import none_left_empty
from vgvt.cli.options import CampaignArgument, JsonOption

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vgvt.data import Campaign
    from vgvt.files.export.campaign import Exported


def convert(
    campaign: CampaignArgument,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="What to write, by its ending: .uff, .unv, .ufb or .bunv (Universal File), .mat, .csv or .nc.",
        ),
    ],
    frf: Annotated[
        bool, typer.Option("--frf", help="Write frequency responses and coherence in place of time histories.")
    ] = False,
    band: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="LOW HIGH", help="Band of the frequency responses in Hz. Default: the excited band."),
    ] = None,
    text: Annotated[
        bool, typer.Option("--text", help="Numbers of a Universal File as text (58) in place of binary (58b).")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there already.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Write a campaign in the format of another program: Universal File, MAT, CSV, or campaign.nc.

    A Universal File holds all runs; of several runs MAT and CSV have one file each, FILE-run1 and so on. Beside them a
    sidecar of the same name (.toml) keeps what the format has no place for: every command takes it as the campaign.
    Where that name is the sidecar of other records, this one is FILE.toml.
    """
    from vgvt.data import InputError
    from vgvt.files import open_campaign
    from vgvt.files.export.campaign import planned_files
    from vgvt.files.export.form import Form, form_of
    from vgvt.files.open import files_of

    form = form_of(file)
    if text and form is not Form.UNIVERSAL:
        raise InputError("--text", f"{file.name} is no Universal File", "leave it out, or give a .uff")
    if band is not None and not frf:
        raise InputError("--band", "only frequency responses have one", "leave it out, or add --frf")
    opened = open_campaign(campaign)
    _refuse_to_replace((file,) if frf else planned_files(opened, file), files_of(campaign), force)
    with none_left_empty(file.parent):
        exported = _responses(opened, file, band, text) if frf else _campaign(opened, file, text, campaign)
    if as_json:
        write_document(_document(opened, exported))
    else:
        _say(exported)
    return 0


def _refuse_to_replace(files: Sequence[Path], read: Sequence[Path], force: bool) -> None:
    from vgvt.data import InputError
    from vgvt.files.open import is_scenario

    for path in files:
        if path.exists() and any(path.samefile(one) for one in read):
            raise InputError(str(path), "is what is read, and would be replaced", "give FILE another name")
        if path.suffix == ".toml" and is_scenario(path):
            raise InputError(str(path), "is a scenario, and a sidecar would replace it", "give FILE another name")
        if os.path.lexists(path) and not force:
            raise InputError(str(path), "is there already", "give FILE another name, or replace it with --force")


def _campaign(campaign: Campaign, file: Path, text: bool, source: str) -> Exported:
    from vgvt.files.export.campaign import export_campaign

    return export_campaign(campaign, file, text=text, manifest=_made(source) | {"converted_from": Path(source).name})


def _made(source: str) -> dict[str, Any]:
    """How a campaign file came to be, like scenario and seed; nothing of measured records."""
    from vgvt.files.campaign_file import ADDED_FACTS, read_manifest
    from vgvt.files.open import files_of

    first = files_of(source)[0]
    if first.suffix == ".toml":
        return {}
    return {key: value for key, value in read_manifest(first).items() if key not in ADDED_FACTS}


def _responses(campaign: Campaign, file: Path, band: tuple[float, float] | None, text: bool) -> Exported:
    from vgvt.files.export.campaign import Exported
    from vgvt.files.export.responses import export_responses
    from vgvt.signals import estimate_frf

    frf = estimate_frf(campaign, "auto", band_hz=campaign.band_hz if band is None else band)
    form = export_responses(frf, file, campaign.name, campaign.geometry, text=text)
    return Exported(form, (file,), None, frf.remarks)


def _say(exported: Exported) -> None:
    for remark in exported.remarks:
        log(remark)
    show(f"wrote {', '.join(map(str, exported.files))}")
    if exported.sidecar is not None:
        show(f"{exported.sidecar} reads it back: vgvt inspect {exported.sidecar}")


def _document(campaign: Campaign, exported: Exported) -> dict[str, Any]:
    return {
        "campaign": campaign.name,
        "format": exported.form,
        "files": exported.files,
        "sidecar": exported.sidecar,
        "runs": [record.run for record in campaign.runs],
        "remarks": exported.remarks,
    }
