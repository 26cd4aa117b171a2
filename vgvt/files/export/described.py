"""The sidecar of a campaign that was written in another format: how to read it, and what has no place in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vgvt.data import Campaign, Channel, ChannelRole, Geometry, Quantity, Record
from vgvt.files.export.form import Form
from vgvt.files.export.matlab import SAMPLES, TIME
from vgvt.files.export.table import HEADING_ROWS
from vgvt.files.measured_records import not_finite_note
from vgvt.files.sidecar import Sidecar
from vgvt.files.units import QUANTITIES

_WORDS = {quantity: word for word, quantity in QUANTITIES.items()}


class UnsayableError(ValueError):
    """No sidecar can say a campaign; the words are why."""


def sidecar_of(campaign: Campaign, form: Form, files: Sequence[Path], hashes: Sequence[str] | None) -> Sidecar:
    """The sidecar that reads a campaign back from its files: one for all runs, or one a run.

    ``hashes`` are theirs. UnsayableError, or pydantic's ValidationError, says why there is none.
    """
    table = _common_channels(campaign.runs)
    if not campaign.band_hz[0] > 0:
        raise UnsayableError("its band begins at 0 Hz")
    together, first = len(files) == 1, campaign.runs[0]
    runs = [
        _said(
            run=int(record.run),
            file=files[0 if together else k].name,
            sha256=hashes[0 if together else k] if hashes else None,
            index=k + 1 if together and len(campaign.runs) > 1 else None,
            sample_rate_hz=None if record.sample_rate_hz == first.sample_rate_hz else float(record.sample_rate_hz),
            nodes=_moved(table, record, campaign.runs),
            names={a.name: b.name for a, b in zip(table, record.channels, strict=True) if a.name != b.name},
            overloaded=[a.name for a, b in zip(table, record.channels, strict=True) if b.name in record.overloaded],
            notes=own_notes(record),
        )
        for k, record in enumerate(campaign.runs)
    ]
    content = _said(
        name=campaign.name,
        band_hz=[float(f) for f in campaign.band_hz],
        notes=dict(campaign.notes),
        records={"format": form.value, "sample_rate_hz": float(first.sample_rate_hz), **_layout(form, campaign.runs)},
        nodes=_nodes(campaign.geometry),
        outline_m=[np.asarray(outline, dtype=float).tolist() for outline in campaign.geometry.outline_m],
        channel=[_row(k, channel, campaign.runs, form) for k, channel in enumerate(table)],
        run=runs,
    )
    return Sidecar.model_validate(content)


def _said(**table: Any) -> dict[str, Any]:
    """A table without the keys that say nothing."""
    return {key: value for key, value in table.items() if value is not None and value != [] and value != {}}


def _layout(form: Form, runs: Sequence[Record]) -> dict[str, Any]:
    channels = len(runs[0].channels)
    if form is Form.MATLAB:
        # One sample has no time axis that a rate could be held against.
        axis = {"time_s": TIME} if all(record.samples.shape[1] > 1 for record in runs) else {}
        return {"samples": SAMPLES, **axis, "columns": channels}
    if form is Form.TEXT:
        return {"skip_rows": HEADING_ROWS, "columns": channels + 1}
    return {"columns": channels}


def _common_channels(runs: Sequence[Record]) -> tuple[Channel, ...]:
    """The channel table of all runs; UnsayableError where one run has another."""
    first = runs[0]
    for record in runs[1:]:
        if [_kind(c) for c in record.channels] != [_kind(c) for c in first.channels]:
            raise UnsayableError(f"run {record.run} has other channels than run {first.run}")
    for channel in first.channels:
        if channel.quantity not in _WORDS:
            raise UnsayableError(f"{channel.name} measures {channel.quantity.name.replace('_', ' ').lower()}")
        if channel.unit != channel.quantity.si_unit:
            raise UnsayableError(f"{channel.name} is in {channel.unit}, and not in SI")
    return first.channels


def _kind(channel: Channel) -> tuple[Quantity, ChannelRole, str, bool]:
    return channel.quantity, channel.role, channel.unit, channel.dof is None


def _nodes(geometry: Geometry) -> dict[str, Any]:
    x, y, z = geometry.positions_m.astype(float).T.tolist()
    lines = [[int(node) for node in line] for line in geometry.lines]
    return _said(node=[int(node) for node in geometry.nodes], x=x, y=y, z=z, lines=lines)


def _row(k: int, channel: Channel, runs: Sequence[Record], form: Form) -> dict[str, Any]:
    row: dict[str, Any] = {
        "name": channel.name,
        "column": k + 1 + (form is Form.TEXT),
        "quantity": _WORDS[channel.quantity],
        "role": channel.role.value,
        "unit": channel.unit,
    }
    if channel.dof is None:
        return row
    stays = all(record.channels[k].dof == channel.dof for record in runs)
    return row | ({"dof": channel.dof.label} if stays else {"direction": channel.dof.direction.label})


def _moved(table: Sequence[Channel], record: Record, runs: Sequence[Record]) -> dict[str, int | str]:
    """Where in a run the sensors sat that move; with the direction where it was turned since the first run."""
    nodes: dict[str, int | str] = {}
    for k, (first, here) in enumerate(zip(table, record.channels, strict=True)):
        if first.dof is None or here.dof is None or all(one.channels[k].dof == first.dof for one in runs):
            continue
        turned = here.dof.direction is not first.dof.direction
        nodes[first.name] = here.dof.label if turned else int(here.dof.node)
    return nodes


def own_notes(record: Record) -> list[str]:
    """The notes of a run without those that reading adds again."""
    told = (
        not_finite_note(channel.name, samples) for channel, samples in zip(record.channels, record.samples, strict=True)
    )
    added = {note for note in told if note}
    return [note for note in record.notes if note not in added]
