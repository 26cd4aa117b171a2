"""A sidecar as TOML text, as far as record files say; what they do not say is marked CHECK or MISSING."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable

from vgvt.data import ChannelRole
from vgvt.files.describe.draft import DescribedRun, Draft, ProposedChannel
from vgvt.files.unit_labels import unit_of_label
from vgvt.files.units import QUANTITIES

_LINE = 100
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_COMMENT_AT = 36


def missing(draft: Draft) -> tuple[str, ...]:
    """What has to be written by hand before the sidecar can be read, in words; empty where the files say it all."""
    words = [f"{channel.name}: {word}" for channel in draft.channels for word in _missing_of_channel(channel)]
    if not _known_rates(draft):
        words.insert(0, "the sample rate, which the file does not state")
    if draft.band_hz is None:
        words.insert(0, "the band that was excited")
    without = [str(node) for node in _nodes_without_position(draft)]
    if without:
        words.append(f"positions of nodes {', '.join(without)}")
    elif not draft.positions:
        words.append("positions of the nodes")
    return tuple(words)


def sidecar_text(draft: Draft) -> str:
    """The sidecar as TOML text; it loads where nothing is :func:`missing`."""
    head = ["# Written by `vgvt data describe`. CHECK marks what was guessed, MISSING what is to be written by hand."]
    head += [f"# {_CONTROL.sub(' ', remark)}." for remark in draft.remarks]
    rates = _known_rates(draft)
    lines = [
        *head,
        f"name = {_text(draft.name)}",
        _band(draft),
        "",
        "[records]",
        f"format = {_text(draft.kind.format)}",
        *([f"folder = {_text(draft.folder)}"] if draft.folder else []),
        *([f"samples = {_text(draft.group)}"] if draft.group else []),
        *([f"time_s = {_text(draft.time)}"] if draft.time else []),
        f"sample_rate_hz = {rates[0]!r}" if rates else "# sample_rate_hz =  # MISSING: the file does not state it",
        *([] if draft.columns is None else [_said(f"columns = {draft.columns}", draft.kind.columns)]),
        *_axes(draft),
        *_nodes(draft),
    ]
    for channel in draft.channels:
        lines += _channel(channel)
    for number, run in enumerate(draft.runs, start=1):
        lines += _run(number, run, draft, rates)
    return "\n".join(lines) + "\n"


def _known_rates(draft: Draft) -> list[float]:
    return list(dict.fromkeys(run.sample_rate_hz for run in draft.runs if run.sample_rate_hz is not None))


def _band(draft: Draft) -> str:
    if draft.band_hz is None:
        return "# band_hz = [2.0, 40.0]  # MISSING: the band that was excited"
    band = f"band_hz = [{draft.band_hz[0]!r}, {draft.band_hz[1]!r}]"
    return _said(band, "CHECK: write the band that was excited" if draft.band_is_guessed else "")


def _axes(draft: Draft) -> list[str]:
    axes = draft.axes
    guess = f"CHECK: which axis {draft.kind.axes} points aft, right and up" if draft.axes_are_guessed else ""
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
    known, without = draft.positions, _nodes_without_position(draft)
    lines = ["", "[nodes]"]
    if not known:
        lines += [f"node = {_list(without)}" if without else "# node = [1]  # MISSING"]
        return lines + [f"# {axis} = [0.0]  # MISSING: one entry a node" for axis in "xyz"]
    lines += [f"node = {_list(known)}"]
    lines += [f"{axis} = {_list(position[k] for position in known.values())}" for k, axis in enumerate("xyz")]
    if draft.lines:
        drawn = [list(line) for line in draft.lines if set(line) <= set(known)]
        lines += [f"lines = {_list(drawn)}"]
    if without:
        lines += [f"# MISSING: the file states no position of nodes {_list(without)}; add them to node, x, y and z"]
    return lines


def _channel(channel: ProposedChannel) -> list[str]:
    gaps = _missing_of_channel(channel)
    lines = ["", "[[channel]]", f"name = {_text(channel.name)}"]
    lines += [f"column = {channel.column}"] if channel.column is not None else []
    lines += [f"variable = {_text(channel.variable)}"] if channel.variable else []
    choices = ", ".join(map(_text, QUANTITIES))
    lines += [
        f"quantity = {_text(channel.quantity)}"
        if channel.quantity
        else f"# quantity =  # MISSING: {gaps[0]}; one of {choices}"
    ]
    guess = "" if channel.quantity else 'CHECK: "reference" for a force, "drive" for what went to the amplifier'
    lines += [_said(f"role = {_text(channel.role)}", guess)]
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


def _run(number: int, run: DescribedRun, draft: Draft, rates: list[float]) -> list[str]:
    lines = ["", "[[run]]", f"run = {number}", f"file = {_text(run.file)}"]
    if run.index is not None:
        lines += [_said(f"index = {run.index}", run.words)]
    if run.file in draft.hashes and run.file not in [other.file for other in draft.runs[: number - 1]]:
        lines += [f"sha256 = {_text(draft.hashes[run.file])}"]
    if run.sample_rate_hz is None and rates:
        lines += [_said(f"sample_rate_hz = {rates[0]!r}", "CHECK: the file does not state it")]
    elif run.sample_rate_hz is not None and run.sample_rate_hz != rates[0]:
        lines += [f"sample_rate_hz = {run.sample_rate_hz!r}"]
    measured = [channel for channel in draft.channels if channel.role is not ChannelRole.DRIVE]
    places = [f"{_key(c.name)} = {_node(c, number - 1)}" for c in measured if c.has_places and not c.stays]
    unplaced = [channel for channel in measured if not channel.has_places]
    if places:
        lines += [f"nodes = {{ {', '.join(places)} }}"]
    elif unplaced and len(draft.runs) > 1:
        lines += [
            f"# nodes = {{ {_key(unplaced[0].name)} = 12 }}  # where each channel with a direction was in this run"
        ]
    return lines


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
    return sorted({place.node for place in draft.places} - set(draft.positions))


def _said(line: str, comment: str) -> str:
    return f"{line:{_COMMENT_AT}}# {comment}" if comment else line


def _text(text: str) -> str:
    # What TOML must escape, JSON escapes alike, but for the one control character that it lets stand.
    return json.dumps(str(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _text(name)


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
