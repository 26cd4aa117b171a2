"""From Universal Files to a sidecar: what they state of a test, written down to be checked by a person."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.files.axes import Axes
from vgvt.files.manifest import file_sha256
from vgvt.files.measured_records import read_measured
from vgvt.files.sidecar import Sidecar
from vgvt.files.strict import load_table
from vgvt.files.uff.geometry import UffGeometry
from vgvt.files.uff.grouping import FoundRun, find_runs
from vgvt.files.uff.proposal import ProposedChannel, propose_channels
from vgvt.files.uff.read import UniversalFile, read_uff
from vgvt.files.uff.sidecar_text import Draft, missing, sidecar_text
from vgvt.files.unit_labels import same_unit
from vgvt.files.units import LENGTHS_M

_USUAL_SHARE = 2.56
"""Sample rate over bandwidth of most analysers."""
_PERIODS = 10


@dataclass(frozen=True, slots=True)
class Description:
    """A sidecar that was written, and what a person should know of it."""

    path: Path
    name: str
    band_hz: tuple[float, float]
    channels: tuple[ProposedChannel, ...]
    runs: tuple[FoundRun, ...]
    missing: tuple[str, ...]
    """What is to be written by hand before it can be read."""
    remarks: tuple[str, ...]


def describe_uff(
    files: Sequence[Path],
    sidecar: Path,
    *,
    band_hz: tuple[float, float] | None = None,
    axes: tuple[str, str, str] | None = None,
    columns: int | None = None,
) -> Description:
    """Write the sidecar of one campaign in Universal Files, each with one run or several.

    ``axes`` are those of the files that point aft, right and up; x, y and z when left out. ``band_hz`` left out is a
    guess: from ten periods in the shortest run to the sample rate over 2.56. Where nothing is missing, the sidecar
    has been read with all its records before it takes its name. InputError when files cannot be read, do not make
    runs, or contradict each other.
    """
    places = [_absolute(path) for path in files]
    twice = [str(path) for path, place in zip(files, places, strict=True) if places.count(place) > 1]
    if twice:
        raise InputError(twice[0], "is given twice, and its runs would count twice", "give it once")
    read = tuple(read_uff(path) for path in files)
    runs = find_runs(read, columns)
    geometry = _one_geometry(read)
    unit, unit_is_guessed = _length_unit(read, geometry)
    table = _checked_axes(unit, *(axes or ("x", "y", "z")))
    channels, remarks = propose_channels(runs, table)
    if not channels:
        raise InputError(str(files[0]), "\n  ".join(["holds nothing that vgvt reads", *remarks]), "give another file")
    folder = Path(os.path.commonpath([place.parent for place in places]))
    relative = Path(os.path.relpath(folder, _absolute(sidecar).parent)).as_posix()
    names = {path: place.relative_to(folder).as_posix() for path, place in zip(files, places, strict=True)}
    draft = Draft(
        name=sidecar.stem,
        band_hz=band_hz or _guessed_band(runs),
        band_is_guessed=band_hz is None,
        folder="" if relative == "." else relative,
        axes=table,
        axes_are_guessed=axes is None,
        unit_is_guessed=unit_is_guessed,
        geometry=geometry,
        channels=channels,
        runs=runs,
        files=tuple(names[run.file.path] for run in runs),
        hashes={name: file_sha256(path) for path, name in names.items()},
        remarks=(),
    )
    draft = replace(draft, remarks=(*_grouping_in_words(draft), *remarks, *_warnings(draft, read)))
    gaps = missing(draft)
    with replacing(sidecar) as temporary:
        temporary.write_text(sidecar_text(draft), encoding="utf-8")
        if not gaps:
            _check_that_it_loads(temporary, sidecar, folder)
    return Description(sidecar, draft.name, draft.band_hz, channels, runs, gaps, draft.remarks)


def _absolute(path: Path) -> Path:
    """The path from the root on; a link in place of the file itself keeps its name."""
    return path.parent.resolve() / path.name


def _check_that_it_loads(temporary: Path, sidecar: Path, folder: Path) -> None:
    """InputError, in the name that the sidecar will have, unless it can be read with all its records."""
    try:
        read_measured(load_table(temporary, Sidecar), folder)
    except InputError as error:
        raise InputError(error.where.replace(str(temporary), str(sidecar)), error.problem, error.advice) from error


def _one_geometry(files: Sequence[UniversalFile]) -> UffGeometry:
    """The places of all files; InputError where two files place a node differently, or a place is in a local system."""
    whole = UffGeometry({}, (), {})
    for file in files:
        geometry = file.geometry()
        displaced = geometry.displaced_positions()
        if displaced:
            raise InputError(
                str(file.path),
                f"positions of nodes {_some(displaced)} are given in a local coordinate system",
                "export the geometry in global coordinates",
            )
        for number, node in geometry.nodes.items():
            if whole.nodes.get(number, node).position != node.position:
                raise InputError(
                    str(file.path),
                    f"node {number} is at another place than in the file before",
                    "describe files of one geometry together, and others by themselves",
                )
        lines = dict.fromkeys((*whole.lines, *geometry.lines))
        whole = UffGeometry(whole.nodes | geometry.nodes, tuple(lines), whole.systems | geometry.systems)
    return whole


def _length_unit(files: Sequence[UniversalFile], geometry: UffGeometry) -> tuple[str, bool]:
    """The unit of positions, and whether it is a guess."""
    stated = {1 / file.units.lengths_a_metre for file in files if file.units is not None}
    if not stated:
        return "m", bool(geometry.nodes)
    names = {next((name for name, metres in LENGTHS_M.items() if same_unit(metres, one)), None) for one in stated}
    name = names.pop() if len(names) == 1 else None
    if name is None:
        raise InputError(
            ", ".join(str(file.path) for file in files),
            f"dataset 164 states units of length of {' and '.join(f'{one:.6g} m' for one in sorted(stated))}",
            f"export in one of {', '.join(LENGTHS_M)}",
        )
    return name, False


def _checked_axes(unit: str, aft: str, right: str, up: str) -> Axes:
    try:
        return Axes.model_validate({"unit": unit, "aft": aft, "right": right, "up": up})
    except ValueError as error:
        raise InputError(
            "--axes",
            f"{aft} {right} {up} are not the axes that point aft, right and up",
            "write each of x, y and z once, with a minus sign where it points the other way: like --axes y -x z",
        ) from error


def _guessed_band(runs: Sequence[FoundRun]) -> tuple[float, float]:
    shortest_s = min(run.histories[0].form.samples / run.sample_rate_hz for run in runs)
    high = min(run.sample_rate_hz for run in runs) / _USUAL_SHARE
    low = _PERIODS / shortest_s if shortest_s > 0 else high
    return float(f"{min(low, high / 10):.3g}"), float(f"{high:.3g}")


def _grouping_in_words(draft: Draft) -> list[str]:
    """How time histories were taken together, file by file."""
    words = []
    size = len(draft.runs[0].histories)
    for file in dict.fromkeys(draft.files):
        count = draft.files.count(file)
        runs = f"{count} runs of {size} time histories each, one behind the other" if count > 1 else "one run"
        words.append(f"{file}: taken as {runs}")
    return words


def _warnings(draft: Draft, files: Sequence[UniversalFile]) -> list[str]:
    words = [f"{file.path.name}: left out {file.other_functions}" for file in files if file.other_functions]
    if not any(channel.role == "reference" for channel in draft.channels):
        words.append("no time history is a force: frequency responses need one")
    turned = draft.geometry.turned_directions(dict.fromkeys(place.node for place in draft.places))
    if turned:
        words.append(
            f"CHECK: directions at nodes {_some(turned)} are along local coordinate systems that are turned, "
            "and are written here as if they were along the global one"
        )
    lost = [line for line in draft.geometry.lines if not set(line) <= set(draft.geometry.nodes)]
    if lost and draft.geometry.nodes:
        words.append(f"left out trace lines through nodes that have no position: {len(lost)}")
    return words


def _some(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers[:8])) + (", …" if len(numbers) > 8 else "")
