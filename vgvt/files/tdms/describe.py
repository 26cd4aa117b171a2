"""From TDMS files to a sidecar: what they state of a test, and gaps for the places that they cannot state."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vgvt.data import ChannelRole
from vgvt.files.describe.draft import DescribedRun, Description, Draft, Kind
from vgvt.files.describe.guesses import checked_axes, guessed_band_hz
from vgvt.files.describe.record_files import record_files
from vgvt.files.describe.write import write_sidecar
from vgvt.files.tdms.grouping import GroupedRun, group_runs
from vgvt.files.tdms.proposal import propose_channels
from vgvt.files.tdms.read import read_tdms
from vgvt.files.tdms.recording import Recording, recording_of

_TDMS = Kind("tdms", columns="channels of the group of a run", axes="of your positions")


def describe_tdms(
    files: Sequence[Path],
    sidecar: Path,
    *,
    band_hz: tuple[float, float] | None = None,
    axes: tuple[str, str, str] | None = None,
    columns: int | None = None,
) -> Description:
    """Write the sidecar of one campaign in TDMS files, each with one run or one a group; ``columns`` channels a run.

    ``axes`` are those of the positions that are still to be written which point aft, right and up; x, y and z when
    left out. ``band_hz`` left out is a guess: from ten periods in the shortest run to the sample rate over 2.56. The
    samples are not read. InputError when files cannot be read, do not make runs, or contradict each other.
    """
    placed = record_files(files, sidecar)
    grouped = [group_runs(read_tdms(path), columns) for path in files]
    recordings = [recording_of(run) for runs in grouped for run in runs]
    proposal = propose_channels(recordings)
    runs = tuple(
        _described(recording, index, placed.names[recording.run.file.path])
        for recording, index in zip(recordings, proposal.indices, strict=True)
    )
    remarks = [word for runs_of_file in grouped for word in _grouping_in_words(runs_of_file, columns)]
    remarks += [f"{recording.run.file.path.name}: {word}" for recording in recordings for word in recording.remarks]
    remarks += proposal.remarks
    if not any(channel.role is ChannelRole.REFERENCE for channel in proposal.channels):
        remarks.append("no channel states a unit of force: frequency responses need one")
    draft = Draft(
        kind=_TDMS,
        name=sidecar.stem,
        band_hz=band_hz or guessed_band_hz(runs),
        band_is_guessed=band_hz is None,
        folder=placed.relative,
        columns=proposal.columns,
        axes=checked_axes("m", axes),
        axes_are_guessed=axes is None,
        unit_is_guessed=False,
        positions={},
        lines=(),
        channels=proposal.channels,
        runs=runs,
        hashes=placed.hashes(),
        remarks=tuple(remarks),
        group=proposal.group,
        time=proposal.time,
    )
    return write_sidecar(draft, sidecar, placed.folder)


def _described(recording: Recording, index: int | None, file: str) -> DescribedRun:
    held = [k for k, channel in enumerate(recording.run.file.channels, start=1) if channel.group in recording.groups]
    return DescribedRun(
        path=recording.run.file.path,
        file=file,
        index=index,
        first=held[0],
        last=held[-1],
        samples=recording.samples,
        sample_rate_hz=recording.sample_rate_hz,
        words=f"group {recording.groups[0]!r}",
    )


def _grouping_in_words(runs: Sequence[GroupedRun], columns: int | None) -> list[str]:
    """How the groups of a file were taken, and how to have them taken otherwise."""
    file = runs[0].file
    name, groups = file.path.name, file.groups
    taken = [group for run in runs for group in run.groups]
    left = [f"{name}: left out group {group!r}" for group in groups if group not in taken]
    if len(groups) == 1:
        return [f"{name}: taken as one run"]
    if not runs[0].one_of_several:
        return [f"{name}: its {len(groups)} groups are taken as one run"]
    words = f"{name}: taken as {len(runs)} run{'s' * (len(runs) > 1)}, one a group"
    if columns is not None:
        return [words, *left]
    return [f"CHECK: {words}; --columns {len(file.channels)} takes all groups as one run", *left]
