"""From a sidecar and the record files that it describes to a campaign in SI."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, Geometry, InputError, Record
from vgvt.files.delimited_text import read_delimited
from vgvt.files.manifest import file_sha256
from vgvt.files.mat import read_mat
from vgvt.files.npz import read_npz
from vgvt.files.sidecar import ChannelRow, RunRow, Sidecar
from vgvt.files.tdms.read import TdmsFile, read_tdms
from vgvt.files.tdms.run_columns import columns_of_run as columns_of_tdms
from vgvt.files.time_axis import check_time_axis, time_of_run
from vgvt.files.uff.read import UniversalFile, read_uff
from vgvt.files.uff.run_columns import columns_of_run as columns_of_uff

Content = dict[str, NDArray[Any]] | UniversalFile | TdmsFile
"""The arrays of a file by their names, or a file that holds its channels one by one and says of each what it is."""


def read_measured(sidecar: Sidecar, folder: Path) -> Campaign:
    """The campaign that a sidecar describes; its files lie in ``folder``.

    Samples come out in SI, aircraft axes. InputError names the file, and the
    run and channel where it can: missing or damaged file, wrong hash, missing variable,
    too few columns, no samples, a time axis that contradicts the sample rate or the number of samples,
    a Universal File or TDMS file that states another quantity, DOF, rate or unit.
    """
    runs: list[Record] = []
    content: Content = {}
    hashes: dict[str, str] = {}
    read = ""
    for run in sidecar.run:
        _check_file(sidecar, run, folder / run.file, hashes)
        if run.file != read:
            content, read = _read_content(sidecar, folder / run.file), run.file
        runs.append(_record(sidecar, run, content, folder / run.file))
    notes = dict(sidecar.notes)
    notes |= {"summary": sidecar.summary} if sidecar.summary else {}
    notes |= {"traps": "\n".join(sidecar.traps)} if sidecar.traps else {}
    return Campaign(
        name=sidecar.name,
        geometry=Geometry(
            nodes=sidecar.nodes.node,
            positions_m=sidecar.axes.to_aircraft_m(sidecar.nodes.table),
            lines=sidecar.nodes.lines,
            outline_m=tuple(np.array(o, dtype=float) for o in sidecar.outline_m),
        ),
        runs=tuple(runs),
        band_hz=sidecar.band_hz,
        notes=notes,
    )


def _check_file(sidecar: Sidecar, run: RunRow, path: Path, hashes: dict[str, str]) -> None:
    """InputError unless the file of a run is there and is the one described; ``hashes`` keeps those of files met."""
    if not path.is_file():
        fetch = f"fetch it with `vgvt data get {sidecar.name}`, or " if sidecar.source else ""
        raise InputError(str(path), f"no such file (run {run.run})", f"{fetch}check records.folder and run.file")
    if run.sha256 is None:
        return
    if run.file not in hashes:
        hashes[run.file] = file_sha256(path)
    if hashes[run.file] != run.sha256:
        raise InputError(
            str(path),
            f"truncated or damaged, or not the file that the sidecar describes: {path.stat().st_size} bytes whose "
            f"SHA-256 is not {run.sha256[:12]}... (run {run.run})",
            "copy or download it again; if you changed it on purpose, leave sha256 out of the sidecar",
        )


def _read_content(sidecar: Sidecar, path: Path) -> Content:
    records = sidecar.records
    if records.format == "tdms":
        return read_tdms(path)
    if records.format == "uff":
        return read_uff(path)
    if records.format == "csv":
        return {"": read_delimited(path, records.delimiter, records.skip_rows)}
    names = dict.fromkeys([c.variable or records.samples for c in sidecar.channel])
    wanted = [*names, records.time_s] if records.time_s else [*names]
    return read_mat(path, wanted) if records.format == "mat" else read_npz(path, wanted)


def _record(sidecar: Sidecar, run: RunRow, content: Content, path: Path) -> Record:
    if isinstance(content, UniversalFile):
        columns = columns_of_uff(sidecar, run, content)
    elif isinstance(content, TdmsFile):
        columns = columns_of_tdms(sidecar, run, content)
    else:
        columns = [_column(sidecar, run, channel, content, path) for channel in sidecar.channel]
    lengths = {c.name: len(x) for c, x in zip(sidecar.channel, columns, strict=True)}
    where = f"{path}, run {run.run}"
    if len(set(lengths.values())) > 1:
        raise InputError(where, f"the channels differ in length: {lengths}", "give channels of one recording")
    if not columns[0].size:
        raise InputError(where, "the record has no samples", "leave this run out, or find its data")
    sample_rate_hz = run.sample_rate_hz or sidecar.records.sample_rate_hz
    if sidecar.records.time_s and isinstance(content, dict):
        time_s = time_of_run(content[sidecar.records.time_s], run.index, where)
        check_time_axis(time_s, columns[0].size, sample_rate_hz, where)
    double = any(x.dtype.itemsize > 4 or x.dtype.kind != "f" for x in columns)
    samples = np.empty((len(columns), columns[0].size), dtype=np.float64 if double else np.float32)
    clipped, notes = [], list(run.notes)
    for row, (channel, column) in enumerate(zip(sidecar.channel, columns, strict=True)):
        np.multiply(column, channel.si_per_sample, out=samples[row], casting="same_kind")
        note = not_finite_note(run.called(channel), column)
        if note:
            notes.append(note)
        reached = channel.range_v is not None and _largest(column) * channel.v_per_sample >= channel.range_v
        if reached or channel.name in run.overloaded:
            clipped.append(run.called(channel))
    return Record(
        run=run.run,
        sample_rate_hz=sample_rate_hz,
        channels=tuple(_channel(sidecar, run, channel) for channel in sidecar.channel),
        samples=samples,
        overloaded=tuple(clipped),
        notes=tuple(notes),
    )


def not_finite_note(name: str, samples: NDArray[Any]) -> str:
    """What a run's notes say of a channel whose ``samples`` (N,) are not all finite; empty where they are."""
    bad = int(np.count_nonzero(~np.isfinite(samples)))
    return f"{name}: {bad} of {samples.size} samples are not finite" if bad else ""


def _largest(column: NDArray[Any]) -> float:
    """The largest size of a column's numbers; numpy's own abs leaves the lowest whole number of a type negative."""
    return max(float(np.nanmax(column, initial=0)), -float(np.nanmin(column, initial=0)))


def _channel(sidecar: Sidecar, run: RunRow, row: ChannelRow) -> Channel:
    return Channel(
        name=run.called(row),
        quantity=row.kind,
        role=row.role,
        dof=sidecar.dof(row, run),
        sensitivity_v_per_unit=row.v_per_si,
        range_v=float("inf") if row.range_v is None else row.range_v,
    )


def _column(
    sidecar: Sidecar, run: RunRow, channel: ChannelRow, arrays: dict[str, NDArray[Any]], path: Path
) -> NDArray[Any]:
    """One channel (N,) of one run, as it stands in the file."""
    records = sidecar.records
    name = "" if records.format == "csv" else channel.variable or records.samples
    array, where = arrays[name], f"{path}, run {run.run}" + (f", {name!r}" if name else "")
    if run.index is not None:
        if array.ndim < 2 or run.index > array.shape[0]:
            raise InputError(where, f"no run {run.index} in an array of shape {array.shape}", "correct run.index")
        array = array[run.index - 1]
    if array.ndim == 1:
        array = array[:, None]
    elif records.channels_are == "rows":
        array = array.T
    if array.ndim != 2:
        raise InputError(where, f"shape {array.shape} is not samples × channels", "name another variable, or set index")
    count = array.shape[1]
    if records.columns is not None and records.columns != count:
        raise InputError(
            where,
            f"{_channels(count)}, but the sidecar speaks of {records.columns} (records.columns)",
            "if samples run along the rows, set channels_are = 'rows'; otherwise correct columns, or the file",
        )
    if channel.column > count:
        raise InputError(
            where,
            f"{_channels(count)}, but channel {channel.name!r} is said to be column {channel.column}",
            f"write column = 1 to {count} there; if samples run along the rows, set channels_are = 'rows'",
        )
    return np.asarray(array[:, channel.column - 1])


def _channels(count: int) -> str:
    return f"{count} channel{'s' * (count != 1)}"
