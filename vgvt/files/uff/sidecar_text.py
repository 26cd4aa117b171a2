"""A sidecar as TOML text, as far as Universal Files say; what they do not say is marked CHECK or MISSING."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

from vgvt.data import ChannelRole, Dof
from vgvt.files.axes import Axes
from vgvt.files.uff.geometry import UffGeometry
from vgvt.files.uff.grouping import FoundRun
from vgvt.files.uff.proposal import ProposedChannel
from vgvt.files.unit_labels import unit_of_label

_LINE = 100
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_COMMENT_AT = 36


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """Everything that a sidecar is written from."""

    name: str
    band_hz: tuple[float, float]
    band_is_guessed: bool
    folder: str
    """Of the files, relative to the sidecar; empty where it is the same."""
    axes: Axes
    axes_are_guessed: bool
    unit_is_guessed: bool
    geometry: UffGeometry
    channels: tuple[ProposedChannel, ...]
    runs: tuple[FoundRun, ...]
    files: tuple[str, ...]
    """Of each run, relative to the folder."""
    hashes: dict[str, str]
    remarks: tuple[str, ...]

    @property
    def places(self) -> tuple[Dof, ...]:
        """Every DOF that the channels state, in order of appearance."""
        return tuple(dict.fromkeys(place for c in self.channels for place in c.places if place is not None))


def missing(draft: Draft) -> tuple[str, ...]:
    """What has to be written by hand before the sidecar can be read, in words; empty where the files say it all."""
    words = [f"{channel.name}: {word}" for channel in draft.channels for word in _missing_of_channel(channel)]
    without = [str(node) for node in _nodes_without_position(draft)]
    return (*words, *([f"positions of nodes {', '.join(without)}"] if without else []))


def sidecar_text(draft: Draft) -> str:
    """The sidecar as TOML text; it loads where nothing is :func:`missing`."""
    head = ["# Written by `vgvt data describe`. CHECK marks what was guessed, MISSING what is to be written by hand."]
    head += [f"# {_CONTROL.sub(' ', remark)}." for remark in draft.remarks]
    band = f"[{draft.band_hz[0]!r}, {draft.band_hz[1]!r}]"
    rates = dict.fromkeys(run.sample_rate_hz for run in draft.runs)
    first_rate = next(iter(rates))
    lines = [
        *head,
        f"name = {_text(draft.name)}",
        _said(f"band_hz = {band}", "CHECK: write the band that was excited" if draft.band_is_guessed else ""),
        "",
        "[records]",
        'format = "uff"',
        *([f"folder = {_text(draft.folder)}"] if draft.folder else []),
        f"sample_rate_hz = {first_rate!r}",
        _said(f"columns = {len(draft.runs[0].histories)}", "time histories of a run"),
        *_axes(draft),
        *_nodes(draft),
    ]
    for channel in draft.channels:
        lines += _channel(channel)
    for number, (run, file) in enumerate(zip(draft.runs, draft.files, strict=True), start=1):
        lines += _run(number, run, file, draft, first_rate)
    return "\n".join(lines) + "\n"


def _axes(draft: Draft) -> list[str]:
    axes = draft.axes
    guess = "CHECK: which axis of the file points aft, right and up" if draft.axes_are_guessed else ""
    return [
        "",
        "[axes]",
        _said(f"unit = {_text(axes.unit)}", "CHECK: the file does not say (dataset 164)" * draft.unit_is_guessed),
        _said(f"aft = {_text(axes.aft)}", guess),
        f"right = {_text(axes.right)}",
        f"up = {_text(axes.up)}",
        *([] if any(axes.nose) else ["# nose = [0.0, 0.0, 0.0]  where the nose is, where it is not the origin"]),
    ]


def _nodes(draft: Draft) -> list[str]:
    known, without = draft.geometry.nodes, _nodes_without_position(draft)
    lines = ["", "[nodes]"]
    if not known:
        lines += [f"node = {_list(without)}" if without else "# node = [1]  # MISSING"]
        return lines + [f"# {axis} = [0.0]  # MISSING: one entry a node" for axis in "xyz"]
    lines += [f"node = {_list(known)}"]
    lines += [f"{axis} = {_list(node.position[k] for node in known.values())}" for k, axis in enumerate("xyz")]
    if draft.geometry.lines:
        drawn = [list(line) for line in draft.geometry.lines if set(line) <= set(known)]
        lines += [f"lines = {_list(drawn)}"]
    if without:
        lines += [f"# MISSING: the file states no position of nodes {_list(without)}; add them to node, x, y and z"]
    return lines


def _channel(channel: ProposedChannel) -> list[str]:
    gaps = _missing_of_channel(channel)
    lines = ["", "[[channel]]", f"name = {_text(channel.name)}"]
    lines += [f"column = {channel.column}"] if channel.column is not None else []
    lines += [f"quantity = {_text(channel.quantity)}" if channel.quantity else f"# quantity =  # MISSING: {gaps[0]}"]
    lines += [f"role = {_text(channel.role)}"]
    if channel.unit:
        lines += [f"unit = {_text(channel.unit)}"]
    else:
        key = "sensitivity" if _holds_volts(channel) else "unit"
        lines += [f"# {key} =  # MISSING: {next(gap for gap in gaps if key in gap)}"]
    if channel.role is ChannelRole.DRIVE:
        return lines
    if not channel.has_places:
        return [*lines, '# dof =  # MISSING: the file states no node; write dof = "12+Z", or direction = "+Z"']
    place = channel.places[0]
    if place is None or channel.stays:
        return [*lines, f"dof = {_text(str(place))}"]
    return [*lines, f"direction = {_text(place.direction.label)}"]


def _run(number: int, run: FoundRun, file: str, draft: Draft, first_rate: float) -> list[str]:
    last = run.first + len(run.histories) - 1
    lines = ["", "[[run]]", f"run = {number}", f"file = {_text(file)}"]
    if run.index is not None:
        lines += [_said(f"index = {run.index}", f"time histories {run.first} to {last} of the file")]
    if file in draft.hashes and file not in draft.files[: number - 1]:
        lines += [f"sha256 = {_text(draft.hashes[file])}"]
    if run.sample_rate_hz != first_rate:
        lines += [f"sample_rate_hz = {run.sample_rate_hz!r}"]
    places = [
        f"{channel.name} = {_node(channel, number - 1)}"
        for channel in draft.channels
        if channel.role is not ChannelRole.DRIVE and channel.has_places and not channel.stays
    ]
    return lines + ([f"nodes = {{ {', '.join(places)} }}"] if places else [])


def _node(channel: ProposedChannel, run: int) -> str:
    """Node of a sensor that moves; with its direction where it was turned since the first run."""
    first, here = channel.places[0], channel.places[run]
    if first is None or here is None or first.direction is here.direction:
        return "0" if here is None else str(here.node)
    return _text(str(here))


def _missing_of_channel(channel: ProposedChannel) -> list[str]:
    words = []
    if not channel.quantity:
        words.append("its quantity, which the file does not state")
    if not channel.unit:
        if _holds_volts(channel):
            words.append("its sensitivity, since the file holds volts")
        else:
            stated = f"the file says {channel.label!r}" if channel.label else "the file does not state it"
            words.append(f"its unit ({stated})")
    if channel.role is not ChannelRole.DRIVE and not channel.has_places:
        words.append("its DOF, which the file does not state")
    return words


def _holds_volts(channel: ProposedChannel) -> bool:
    labelled = unit_of_label(channel.label)
    return labelled is not None and labelled[1] == "V" and not channel.unit


def _nodes_without_position(draft: Draft) -> list[int]:
    return sorted({place.node for place in draft.places} - set(draft.geometry.nodes))


def _said(line: str, comment: str) -> str:
    return f"{line:{_COMMENT_AT}}# {comment}" if comment else line


def _text(text: str) -> str:
    # What TOML must escape, JSON escapes alike, but for the one control character that it lets stand.
    return json.dumps(str(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def _list(values: Iterable[object]) -> str:
    entries = [repr(value) for value in values]
    rows: list[str] = []
    for entry in entries:
        if rows and len(rows[-1]) + len(entry) < _LINE:
            rows[-1] += f", {entry}"
        else:
            rows.append(entry)
    if len(rows) <= 1:
        return f"[{', '.join(rows)}]"
    return "[\n" + "".join(f"  {row},\n" for row in rows) + "]"
