"""Who finds what in the measured campaign: every identifier on the raw records, all runs together and run by run.

All runs together go through the bench's umpire, in a process of their own for each method; the single runs of a
method share one process. What is there already is not done again:

    python docs/studies/hati_identified.py [METHOD ...]

Without names all installed identifiers. Results lie under docs/_build/hati-identified and are derived from records
under the MIT licence (PAAW/mAEWing1). ``--again`` does the named methods anew, ``--page`` only writes page and figure.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from virtual_lab import PAGES

from vgvt.bench.entry import Entry
from vgvt.bench.umpire import Limits, attempt
from vgvt.data import Campaign, ModalModel
from vgvt.files import open_campaign
from vgvt.identification.registry import available_identifiers, make_identifier
from vgvt.identification.run import run_identifier

RAW, COPY = "hati-2015-09-24", "hati-2015-09-24-200hz"
FOLDER = PAGES.parent / "_build" / "hati-identified"
LIMITS = Limits(time_s=900.0, memory_mib=4096.0)


@dataclass(frozen=True, slots=True)
class Finding:
    """What one method found in a set of runs: modes in order of frequency, or the reason why there are none."""

    method: str
    part: str
    reason: str
    outcome: str
    advice: tuple[str, ...]
    frequency_hz: tuple[float, ...]
    frequency_std_hz: tuple[float | None, ...]
    damping_ratio: tuple[float, ...]
    damping_ratio_std: tuple[float | None, ...]
    flags: tuple[tuple[str, ...], ...]
    wall_s: float | None
    processor_s: float
    peak_memory_mib: float | None
    load: float


def file_of(method: str, part: str) -> Path:
    """Where a finding is kept."""
    return FOLDER / f"{method}-{part}.json"


def stored(method: str, part: str) -> Finding | None:
    """A finding that is there already."""
    path = file_of(method, part)
    if not path.is_file():
        return None
    values = json.loads(path.read_text(encoding="utf-8"))
    for key, value in values.items():
        if isinstance(value, list):
            values[key] = tuple(tuple(v) if isinstance(v, list) else v for v in value)
    return Finding(**values)


def parts_of(campaign: Campaign) -> dict[str, Campaign]:
    """All runs together, and each alone."""
    alone = {f"run-{r.run}": replace(campaign, runs=(r,)) for r in campaign.runs}
    return {"all": campaign, **alone}


def find(method: str, campaign: Campaign) -> Finding:
    """One attempt on all runs, in a process of its own; whatever goes wrong is a finding too."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    tried = attempt(Entry(method), campaign, campaign.band_hz, LIMITS)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return _kept(method, "all", tried.claim, tried.reason, tried.wall_s, used, tried.peak_memory_mib)


def find_alone(method: str, campaign: Campaign) -> None:
    """The single runs that are missing, one after another in this process."""
    identifier = make_identifier(method)
    for part, one in parts_of(campaign).items():
        if part == "all" or stored(method, part) is not None:
            continue
        wall, own, claim, reason = time.perf_counter(), time.process_time(), None, ""
        try:
            claim = run_identifier(identifier, one)
        except Exception as error:  # noqa: BLE001  whatever a method raises is an entry in the table
            reason = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"
        _kept(method, part, claim, reason, time.perf_counter() - wall, time.process_time() - own, None)


def _kept(
    method: str,
    part: str,
    claim: ModalModel | None,
    reason: str,
    wall_s: float | None,
    used: float,
    memory: float | None,
) -> Finding:
    modes = 0 if claim is None else len(claim)
    found = Finding(
        method, part, reason,
        "" if claim is None else claim.outcome.value,
        () if claim is None else claim.advice,
        () if claim is None else tuple(map(float, claim.natural_frequency_hz)),
        _stated(claim, "natural_frequency_std_hz", modes),
        () if claim is None else tuple(map(float, claim.damping_ratio)),
        _stated(claim, "damping_ratio_std", modes),
        () if claim is None else (claim.flags or ((),) * modes),
        wall_s, used, memory, os.getloadavg()[0],
    )  # fmt: skip
    FOLDER.mkdir(parents=True, exist_ok=True)
    values: dict[str, Any] = {name: getattr(found, name) for name in Finding.__dataclass_fields__}
    file_of(method, part).write_text(json.dumps(values, indent=1), encoding="utf-8")
    return found


def _stated(claim: ModalModel | None, name: str, modes: int) -> tuple[float | None, ...]:
    values = None if claim is None else getattr(claim, name)
    if values is None:
        return (None,) * modes
    return tuple(float(v) if v == v else None for v in values)


# The peak of the process from its own account: getrusage hands the parent's peak on to a child.
_TIMED = """
import os, re, sys, time
def peak_mib():
    return int(re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1]) / 1024
from vgvt.files import open_campaign
from vgvt.identification.registry import make_identifier
from vgvt.identification.run import run_identifier
campaign, method = open_campaign(sys.argv[1]), make_identifier(sys.argv[2])
idle = peak_mib()
wall, own = time.perf_counter(), time.process_time()
modes = len(run_identifier(method, campaign))
wall, own = time.perf_counter() - wall, time.process_time() - own
peak = peak_mib()
print(modes, wall, own, idle, peak, os.getloadavg()[0])
"""


def timed(method: str) -> tuple[float, ...] | None:
    """Modes, wall and processor seconds, memory before and at most (MiB) and load, on the copy at 200 Hz; kept."""
    path = FOLDER / f"timed-{method}.json"
    if path.is_file():
        return tuple(json.loads(path.read_text(encoding="utf-8")))
    one = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _TIMED, COPY, method],
        capture_output=True, text=True, env={**os.environ, **one}, timeout=600, check=False,
    )  # fmt: skip
    if done.returncode:
        return None
    FOLDER.mkdir(parents=True, exist_ok=True)
    values = tuple(float(v) for v in done.stdout.split())
    path.write_text(json.dumps(values), encoding="utf-8")
    return values


def main(arguments: list[str]) -> None:
    """Attempt what is missing, then write the page's tables and figure."""
    methods = [a for a in arguments if not a.startswith("--")] or sorted(available_identifiers())
    if "--again" in arguments:
        for method in methods:
            for path in (
                *FOLDER.glob(f"{method}-all.json"),
                *FOLDER.glob(f"{method}-run-*.json"),
                *FOLDER.glob(f"timed-{method}.json"),
            ):
                path.unlink()
    if "--worker" in arguments:
        find_alone(methods[0], open_campaign(RAW))
        return
    if "--page" not in arguments:
        for method in methods:
            if any(stored(method, f"run-{k}") is None for k in range(1, 11)):
                subprocess.run([sys.executable, "-W", "ignore", __file__, "--worker", method], check=False)
                print(f"{method}: single runs done", flush=True)  # noqa: T201
        campaign = open_campaign(RAW) if any(stored(m, "all") is None for m in methods) else None
        for method in methods:
            if campaign is not None and stored(method, "all") is None:
                found = find(method, campaign)
                said = found.reason or f"{len(found.frequency_hz)} modes"
                print(f"all runs, {method}: {said}", flush=True)  # noqa: T201
        for method in methods:
            timed(method)
    import hati_identified_page

    hati_identified_page.write(sorted({p.stem.removesuffix("-all") for p in FOLDER.glob("*-all.json")}))


if __name__ == "__main__":
    main(sys.argv[1:])
