"""A campaign in another format, with the sidecar that reads it back, whole or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from vgvt.data import Campaign, Record
from vgvt.files.atomically import check_space, replacing
from vgvt.files.campaign_file import write_campaign
from vgvt.files.export import matlab, table, universal
from vgvt.files.export.described import UnsayableError, own_notes, sidecar_of
from vgvt.files.export.form import Form, check_room, form_of
from vgvt.files.export.sidecar_place import sidecar_place
from vgvt.files.manifest import file_sha256
from vgvt.files.measured_records import read_measured
from vgvt.files.storable import check_samples, check_texts
from vgvt.files.toml_text import toml_text

_HEAD = "# Written by `vgvt convert`: how to read the records beside it.\n"
_TEXT_BYTES = 25  # of a number, at most, with what stands beside it
_SAME = 1e-8  # relative; text of single precision has nine digits


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written, and what a person should know of it."""

    form: Form
    files: tuple[Path, ...]
    sidecar: Path | None
    """None where the format needs none, or where it cannot be described; then a remark says why."""
    remarks: tuple[str, ...]


def planned_files(campaign: Campaign, path: Path) -> tuple[Path, ...]:
    """The files that :func:`export_campaign` writes, a sidecar last, by a name that no other records' sidecar has.

    InputError where the ending says no format.
    """
    form = form_of(path)
    if form is Form.CAMPAIGN:
        return (path,)
    apart = form in (Form.MATLAB, Form.TEXT) and len(campaign.runs) > 1
    files = [path.with_name(f"{path.stem}-run{r.run}{path.suffix}") for r in campaign.runs] if apart else [path]
    return (*files, sidecar_place(path, files))


def export_campaign(
    campaign: Campaign, path: Path, *, text: bool = False, manifest: dict[str, Any] | None = None
) -> Exported:
    """Write a campaign as its name's ending says: a Universal File for all runs, a MAT or CSV file a run, or a .nc.

    Samples are in SI: (N, channels) in MAT and CSV, one function a channel in a Universal File, as ``text`` (13 digits)
    or as they are. Beside all but a .nc a sidecar holds what the format has no place for; it has been read once with
    its records, which are the campaign's. InputError for an unknown ending, a place that cannot be written, or what
    format or sidecar cannot hold: records too long for it, texts, numbers of nodes, samples that 64 bits would change;
    OSError (ENOSPC) beforehand where the disk has no room.
    """
    form = form_of(path)
    if form is Form.CAMPAIGN:
        write_campaign(path, campaign, manifest)
        return Exported(form, (path,), None, ())
    check_texts(campaign, path)
    check_samples(campaign, path)
    check_room(campaign.geometry, form, path)
    *files, sidecar = planned_files(campaign, path)
    check_space(path.parent, sum(_bytes(record, form, text) for record in campaign.runs))
    unsaid = _why_no_sidecar(campaign, form, files)
    with ExitStack() as stack:
        # Left last, so that the sidecar appears when its records are there.
        described = None if unsaid else stack.enter_context(replacing(sidecar))
        written = [stack.enter_context(replacing(file)) for file in files]
        _write(campaign, form, written, files, text)
        if described is not None:
            _describe(campaign, form, written, files, described)
    if unsaid:
        return Exported(form, tuple(files), None, (f"no sidecar was written, since none can say it: {unsaid}",))
    return Exported(form, tuple(files), sidecar, tuple(_lost(campaign)))


def _write(campaign: Campaign, form: Form, written: Sequence[Path], files: Sequence[Path], text: bool) -> None:
    if form is Form.UNIVERSAL:
        with written[0].open("wb") as stream:
            stream.writelines(universal.campaign_datasets(campaign, text))
        return
    for record, temporary, final in zip(campaign.runs, written, files, strict=True):
        if form is Form.MATLAB:
            matlab.write_mat(temporary, matlab.run_variables(campaign, record), final)
        else:
            table.write_run(temporary, record)


def _describe(campaign: Campaign, form: Form, written: Sequence[Path], files: Sequence[Path], to: Path) -> None:
    """Write the sidecar of files that are still under their temporary names; RuntimeError where they read otherwise."""
    hashes = [file_sha256(file) for file in written]
    read = read_measured(sidecar_of(campaign, form, written, hashes), written[0].parent)
    other = _difference(campaign, read)
    if other:
        raise RuntimeError(f"{files[0]}: {other} reads back otherwise than it was written")
    sidecar = sidecar_of(campaign, form, files, hashes)
    to.write_text(_HEAD + toml_text(sidecar.model_dump(exclude_unset=True)), encoding="utf-8")


def _why_no_sidecar(campaign: Campaign, form: Form, files: Sequence[Path]) -> str:
    """In words, empty where there can be one."""
    try:
        sidecar_of(campaign, form, files, None)
    except ValidationError as error:
        return str(error.errors()[0]["msg"]).removeprefix("Value error, ").partition("; ")[0]
    except UnsayableError as error:
        return str(error)
    return ""


def _difference(campaign: Campaign, read: Campaign) -> str:
    """What of a campaign was read otherwise, beyond rounding; empty where nothing was."""
    if (read.name, read.band_hz, read.notes) != (campaign.name, campaign.band_hz, campaign.notes):
        return "its name, band or notes"
    geometry, other = campaign.geometry, read.geometry
    if geometry.nodes != other.nodes or not np.array_equal(geometry.positions_m, other.positions_m):
        return "its geometry"
    for one, again in zip(campaign.runs, read.runs, strict=True):
        if _facts(one) != _facts(again):
            return f"the description of run {one.run}"
        if one.samples.shape != again.samples.shape:
            return f"the length of run {one.run}"
        if not np.allclose(one.samples, again.samples, rtol=_SAME, atol=0.0, equal_nan=True):
            return f"a sample of run {one.run}"
    return ""


def _facts(record: Record) -> tuple[object, ...]:
    channels = [(c.name, c.quantity, c.role, c.dof, c.unit) for c in record.channels]
    return record.run, record.sample_rate_hz, sorted(record.overloaded), sorted(own_notes(record)), channels


def _lost(campaign: Campaign) -> list[str]:
    """What neither the format nor the sidecar says."""
    scaled = {
        channel.name
        for record in campaign.runs
        for channel in record.channels
        if channel.sensitivity_v_per_unit != 1.0 or np.isfinite(channel.range_v)
    }
    if not scaled:
        return []
    return [f"samples are in SI: sensitivities and full scales do not come back ({', '.join(sorted(scaled))})"]


def _bytes(record: Record, form: Form, text: bool) -> int:
    numbers = int(record.samples.size + record.samples.shape[1])
    return numbers * (_TEXT_BYTES if text or form is Form.TEXT else 8)
