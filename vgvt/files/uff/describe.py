"""From Universal Files to a sidecar: what they state of a test, written down to be checked by a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from vgvt.data import InputError
from vgvt.files.describe.draft import DescribedRun, Description, Draft, Kind
from vgvt.files.describe.guesses import checked_axes, guessed_band_hz
from vgvt.files.describe.record_files import record_files
from vgvt.files.describe.write import write_sidecar
from vgvt.files.uff.geometry import UffGeometry
from vgvt.files.uff.grouping import FoundRun, find_runs
from vgvt.files.uff.proposal import propose_channels
from vgvt.files.uff.read import UniversalFile, read_uff
from vgvt.files.unit_labels import same_unit
from vgvt.files.units import LENGTHS_M

_UFF = Kind("uff", columns="time histories of a run", axes="of the file")


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
    placed = record_files(files, sidecar)
    read = tuple(read_uff(path) for path in files)
    found = find_runs(read, columns)
    geometry = _one_geometry(read)
    unit, unit_is_guessed = _length_unit(read, geometry)
    table = checked_axes(unit, axes)
    channels, remarks = propose_channels(found, table)
    if not channels:
        raise InputError(str(files[0]), "\n  ".join(["holds nothing that vgvt reads", *remarks]), "give another file")
    runs = tuple(_described(run, placed.names[run.file.path]) for run in found)
    draft = Draft(
        kind=_UFF,
        name=sidecar.stem,
        band_hz=band_hz or guessed_band_hz(runs),
        band_is_guessed=band_hz is None,
        folder=placed.relative,
        columns=len(found[0].histories),
        axes=table,
        axes_are_guessed=axes is None,
        unit_is_guessed=unit_is_guessed,
        positions={number: node.position for number, node in geometry.nodes.items()},
        lines=geometry.lines,
        channels=channels,
        runs=runs,
        hashes=placed.hashes(),
        remarks=(),
    )
    words = (*_grouping_in_words(draft), *remarks, *_warnings(draft, geometry, read))
    return write_sidecar(replace(draft, remarks=words), sidecar, placed.folder)


def _described(run: FoundRun, file: str) -> DescribedRun:
    last = run.first + len(run.histories) - 1
    return DescribedRun(
        path=run.file.path,
        file=file,
        index=run.index,
        first=run.first,
        last=last,
        samples=run.histories[0].form.samples,
        sample_rate_hz=run.sample_rate_hz,
        words=f"time histories {run.first} to {last} of the file",
    )


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


def _grouping_in_words(draft: Draft) -> list[str]:
    """How time histories were taken together, file by file."""
    words = []
    files = [run.file for run in draft.runs]
    for file in dict.fromkeys(files):
        count = files.count(file)
        runs = f"{count} runs of {draft.columns} time histories each, one behind the other" if count > 1 else "one run"
        words.append(f"{file}: taken as {runs}")
    return words


def _warnings(draft: Draft, geometry: UffGeometry, files: Sequence[UniversalFile]) -> list[str]:
    words = [f"{file.path.name}: left out {file.other_functions}" for file in files if file.other_functions]
    if not any(channel.role == "reference" for channel in draft.channels):
        words.append("no time history is a force: frequency responses need one")
    turned = geometry.turned_directions(dict.fromkeys(place.node for place in draft.places))
    if turned:
        words.append(
            f"CHECK: directions at nodes {_some(turned)} are along local coordinate systems that are turned, "
            "and are written here as if they were along the global one"
        )
    lost = [line for line in geometry.lines if not set(line) <= set(geometry.nodes)]
    if lost and geometry.nodes:
        words.append(f"left out trace lines through nodes that have no position: {len(lost)}")
    return words


def _some(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers[:8])) + (", …" if len(numbers) > 8 else "")
