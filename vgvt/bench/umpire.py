"""The umpire: runs one identifier in a process that holds the campaign only, within limits of time and memory."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from vgvt.bench.entry import Entry
from vgvt.data import Campaign, ModalModel
from vgvt.files.campaign_file import write_campaign
from vgvt.files.modal_dataset import modal_model
from vgvt.files.netcdf import read_group
from vgvt.identification.contestant import CAMPAIGN, CLAIM, OUTCOME, REQUEST

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_OPEN_NOTES = {"dwells", "impacts", "blocks"}
_STARTING_S = 60.0  # for the interpreter and its libraries; the contestant's own alarm counts the identification alone


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


def attempt(
    entry: Entry,
    campaign: Campaign,
    band_hz: tuple[float, float] | None = None,
    limits: Limits | None = None,
) -> Attempt:
    """Let one identifier work on a campaign in a process of its own; never raises for what the method does.

    The process starts in an empty folder and is handed the anonymous campaign as a file. One that
    crashes, hangs, takes too much or reaches for what it was not given makes an attempt with a reason.
    """
    limits = limits or Limits()
    with tempfile.TemporaryDirectory(prefix="vgvt-contest-") as name:
        folder = Path(name)
        write_campaign(folder / CAMPAIGN, anonymous(campaign))
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
    """Run the contestant; what went wrong, or nothing. A child that outlives its time goes with all it started."""
    environment = {
        **os.environ,
        **dict.fromkeys(_THREADS, "1"),
        "PYTHONPATH": os.pathsep.join(p for p in sys.path if p),
    }
    command = [sys.executable, "-m", "vgvt.identification.contestant", str(folder)]
    with (folder / "stderr.txt").open("wb") as errors:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,
        )
        try:
            status = process.wait(timeout=time_s + _STARTING_S)
        except subprocess.TimeoutExpired:
            return f"took more than {time_s:g} s"
        finally:
            if process.poll() is None:
                _kill(process)
    if hasattr(signal, "SIGALRM") and status == -signal.SIGALRM:
        return f"took more than {time_s:g} s"
    if status < 0:
        return f"killed by {signal.Signals(-status).name}"
    return f"ended with status {status}" if status else ""


def _kill(process: subprocess.Popen[bytes]) -> None:
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()


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
