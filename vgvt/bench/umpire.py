"""The umpire: runs one identifier in a process that holds the campaign only, within limits of time and memory."""

from __future__ import annotations

import json
import shutil
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from vgvt.bench.entry import Entry
from vgvt.bench.rows import OUT_OF_TIME
from vgvt.bench.starting import OutOfTimeError, run_contestant
from vgvt.data import Campaign, ModalModel
from vgvt.files.campaign_file import write_campaign
from vgvt.files.modal_dataset import modal_model
from vgvt.files.netcdf import read_group
from vgvt.identification.contestant import CAMPAIGN, CLAIM, OUTCOME, REQUEST

_OPEN_NOTES = {"dwells", "impacts", "blocks"}


@dataclass(frozen=True, slots=True)
class Limits:
    """What an identification may take: seconds of wall time, MiB of memory beyond what the libraries need."""

    time_s: float = 60.0
    memory_mib: float = 2048.0


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """What came of one identification: a claim, or the reason why there is none."""

    claim: ModalModel | None
    reason: str
    wall_s: float | None = None
    peak_memory_mib: float | None = None


def anonymous(campaign: Campaign) -> Campaign:
    """The campaign without its name and the notes that tell the scenario, the engine and the seed.

    When a sine dwelt where, and how bursts and hits follow each other, is for everybody to know.
    """
    return replace(campaign, name="campaign", notes={k: v for k, v in campaign.notes.items() if k in _OPEN_NOTES})


@contextmanager
def handed_out(campaign: Campaign) -> Iterator[Path]:
    """The anonymous campaign as a file that several contestants are given copies of; it goes when the block ends."""
    with tempfile.TemporaryDirectory(prefix="vgvt-hand-out-") as name:
        path = Path(name) / CAMPAIGN
        # It lives for minutes and on this machine: packing and unpacking noise would cost more than its space.
        write_campaign(path, anonymous(campaign), packed=False)
        yield path


def attempt(
    entry: Entry,
    campaign: Campaign | Path,
    band_hz: tuple[float, float] | None = None,
    limits: Limits | None = None,
) -> Attempt:
    """Let one identifier work on a campaign in a process of its own; never raises for what the method does.

    The process starts in an empty folder with the anonymous campaign: a copy of the file, where ``campaign`` is
    one that ``handed_out`` wrote, for what a contestant does to its own must not reach the next. One that
    crashes, hangs, takes too much or reaches for what it was not given makes an attempt with a reason.
    """
    if isinstance(campaign, Campaign):
        with handed_out(campaign) as file:
            return attempt(entry, file, band_hz, limits)
    limits = limits or Limits()
    with tempfile.TemporaryDirectory(prefix="vgvt-contest-") as name:
        folder = Path(name)
        shutil.copyfile(campaign, folder / CAMPAIGN)
        request = {
            "identifier": entry.identifier,
            "settings": dict(entry.settings),
            "band_hz": band_hz,
            "memory_mib": limits.memory_mib,
            "time_s": limits.time_s,
        }
        (folder / REQUEST).write_text(json.dumps(request), encoding="utf-8")
        stopped = _run(folder, limits.time_s)
        return _read(folder, stopped)


def _run(folder: Path, time_s: float) -> str:
    """Run the contestant; what went wrong, or nothing."""
    try:
        status = run_contestant(folder, time_s)
    except OutOfTimeError:
        return f"{OUT_OF_TIME} {time_s:g} s"
    if hasattr(signal, "SIGALRM") and status == -signal.SIGALRM:
        return f"{OUT_OF_TIME} {time_s:g} s"
    if status < 0:
        return f"killed by {signal.Signals(-status).name}"
    return f"ended with status {status}" if status else ""


def _read(folder: Path, stopped: str) -> Attempt:
    try:
        outcome: dict[str, Any] = json.loads((folder / OUTCOME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        last = _last_line(folder / "stderr.txt")
        return Attempt(None, stopped or f"left no answer{': ' + last if last else ''}")
    claim = None
    if not outcome["reason"] and (folder / CLAIM).is_file():
        claim = modal_model(folder / CLAIM, read_group(folder / CLAIM), "/")
    return Attempt(claim, outcome["reason"] or stopped, outcome.get("wall_s"), outcome.get("peak_memory_mib"))


def _last_line(path: Path) -> str:
    lines = path.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return lines[-1] if lines else ""
