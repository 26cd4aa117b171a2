"""The channels of one run, found among the time histories of a Universal File."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, InputError
from vgvt.files.sidecar import ChannelRow, RunRow, Sidecar
from vgvt.files.uff.agreement import check_channel, check_rate, check_starts, in_aircraft_axes
from vgvt.files.uff.read import UniversalFile, require_histories
from vgvt.files.uff.time_history import TimeHistory
from vgvt.files.uff.units import QUANTITY_OF_CODE


def columns_of_run(sidecar: Sidecar, run: RunRow, file: UniversalFile) -> list[NDArray[Any]]:
    """The channels (N,) of one run as they stand in the file, in the order of the sidecar.

    InputError names the time history and the channel: one that is not there or not to be told from another, that
    is not real or not over time, or whose rate, start, quantity, DOF or unit is not what the sidecar says.
    """
    where = f"{file.path}, run {run.run}"
    require_histories(file)
    histories = _histories_of_run(sidecar, run, file, where)
    picked = [_picked(sidecar, run, channel, histories, where) for channel in sidecar.channel]
    _check_told_apart(sidecar, picked, where)
    rate_hz, believed = run.sample_rate_hz or sidecar.records.sample_rate_hz, bool(sidecar.records.overrides)
    for channel, history in zip(sidecar.channel, picked, strict=True):
        dof = sidecar.dof(channel, run)
        check_channel(history, channel, dof, sidecar.axes, file.units, run.run)
        check_rate(history, rate_hz, believed, f"{history.where} (run {run.run}, channel {channel.name!r})")
    if not believed:
        check_starts(picked, rate_hz, where)
    return [np.asarray(history.samples()) for history in picked]


def _histories_of_run(sidecar: Sidecar, run: RunRow, file: UniversalFile, where: str) -> tuple[TimeHistory, ...]:
    """All of the file, or those of the run where it holds several, one behind the other."""
    columns, count = sidecar.records.columns, len(file.histories)
    if columns is None or (run.index is None and count == columns):
        return file.histories
    if run.index is None:
        several = f"; of {count // columns} runs in one file give each its index" if count % columns == 0 else ""
        raise InputError(
            where,
            f"{_histories(count)}, but the sidecar speaks of {columns} (records.columns)",
            f"correct columns, or the file{several}",
        )
    if count % columns:
        raise InputError(
            where,
            f"{_histories(count)}, which do not make runs of {columns} each (records.columns)",
            "correct columns; put runs with other numbers of channels into files and sidecars of their own",
        )
    if run.index * columns > count:
        runs = count // columns
        raise InputError(where, f"no run {run.index} in a file of {runs} runs", f"write index = 1 to {runs}")
    return file.histories[(run.index - 1) * columns : run.index * columns]


def _picked(
    sidecar: Sidecar, run: RunRow, channel: ChannelRow, histories: Sequence[TimeHistory], where: str
) -> TimeHistory:
    """The time history of a channel: by its column, by the DOF that the file states, or by the channel's own."""
    if channel.has_column:
        if channel.column <= len(histories):
            return histories[channel.column - 1]
        raise InputError(
            where,
            f"{_histories(len(histories))}, but channel {channel.name!r} is said to be column {channel.column}",
            f"write column = 1 to {len(histories)} there",
        )
    if channel.variable:
        dof: Dof | None = Dof.from_label(channel.variable)
        places = [history.response for history in histories]
    else:
        dof = sidecar.dof(channel, run)
        places = [in_aircraft_axes(history, sidecar.axes) for history in histories]
    found = [k for k, place in enumerate(places) if place is not None and place == dof]
    alike = [k for k in found if QUANTITY_OF_CODE.get(histories[k].quantity_code) is channel.kind]
    found = alike if len(alike) == 1 else found
    if len(found) == 1:
        return histories[found[0]]
    if not found:
        there = ", ".join(dict.fromkeys(str(place) for place in places if place is not None)) or "none at all"
        raise InputError(
            where,
            f"no time history at {dof} for channel {channel.name!r}; the DOFs of the file are {there}",
            "correct the DOF, or give the channel's column",
        )
    listed = ", ".join(str(k + 1) for k in found)
    raise InputError(
        where,
        f"{len(found)} time histories at {dof} (columns {listed}), and channel {channel.name!r} is one of them",
        "give its column; where the file holds several runs, write columns in [records], and the index of each run",
    )


def _check_told_apart(sidecar: Sidecar, picked: Sequence[TimeHistory], where: str) -> None:
    taken: dict[str, str] = {}
    for channel, history in zip(sidecar.channel, picked, strict=True):
        other = taken.setdefault(history.where, channel.name)
        if other != channel.name:
            raise InputError(
                where, f"channels {other!r} and {channel.name!r} are both {history.where}", "give the column of each"
            )


def _histories(count: int) -> str:
    return f"{count} time histor{'y' if count == 1 else 'ies'}"
