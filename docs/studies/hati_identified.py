"""Who finds what in the measured campaign: every identifier on the raw records, all runs together and run by run.

All runs together go through the bench's umpire, in a process of their own for each method; the single runs of a
method share one process. What is there already is not done again:

    python docs/studies/hati_identified.py [METHOD ...]

Without names all installed identifiers. Results lie under docs/_build/hati-identified and are derived from records
under the MIT licence (PAAW/mAEWing1).
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from command_line import identifier_named, parser_of, raise_if_asked, worked_off
from kept_documents import cut_off, keep, read_kept
from virtual_lab import PAGES

from vgvt.bench.entry import Entry
from vgvt.bench.umpire import Limits, attempt
from vgvt.cli.boundary import INTERRUPTED
from vgvt.data import Campaign, InputError, ModalModel
from vgvt.files import open_campaign
from vgvt.identification.registry import available_identifiers, make_identifier
from vgvt.identification.run import run_identifier

RAW, COPY = "hati-2015-09-24", "hati-2015-09-24-200hz"
FOLDER = PAGES.parent / "_build" / "hati-identified"
RUNS = range(1, 11)
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
    """A finding that is there already; InputError where its file is cut off."""
    path = file_of(method, part)
    if not path.is_file():
        return None
    values = read_kept(path, _advice(method))
    if not isinstance(values, dict) or values.keys() != set(Finding.__dataclass_fields__):
        raise cut_off(path, _advice(method))
    for key, value in values.items():
        if isinstance(value, list):
            values[key] = tuple(tuple(v) if isinstance(v, list) else v for v in value)
    return Finding(**values)


def _advice(method: str) -> str:
    return f"remove it, and the script does it again; or all of that method: --again {method}"


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
    values: dict[str, Any] = {name: getattr(found, name) for name in Finding.__dataclass_fields__}
    keep(file_of(method, part), values)
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


def _file_of_times(method: str) -> Path:
    return FOLDER / f"timed-{method}.json"


def timed(method: str) -> tuple[float, ...] | None:
    """Modes, wall and processor seconds, memory before and at most (MiB) and load, on the copy at 200 Hz; kept."""
    path = _file_of_times(method)
    if path.is_file():
        known = read_kept(path, _advice(method))
        if not isinstance(known, list) or len(known) != 6:
            raise cut_off(path, _advice(method))
        return tuple(known)
    one = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _TIMED, COPY, method],
        capture_output=True, text=True, env={**os.environ, **one}, timeout=600, check=False,
    )  # fmt: skip
    if done.returncode:
        return None
    values = tuple(float(v) for v in done.stdout.split())
    keep(path, values, indent=None)
    return values


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = parser_of(__doc__)
    said = "an installed identifier (all of them if nothing is said)"
    parser.add_argument("methods", nargs="*", type=identifier_named, metavar="METHOD", help=said)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--again", action="store_true", help="do the named methods anew")
    how.add_argument("--page", action="store_true", help="only write page and figure")
    # What the script starts for the single runs of one method.
    how.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_intermixed_args(words)
    if given.page and given.methods:
        parser.error("--page writes the page of all that is kept: name no METHOD beside it")
    given.methods = given.methods or sorted(available_identifiers())
    return given


def go_on(methods: Sequence[str], again: bool) -> None:
    """Attempt what is missing, or all of it again, then write the page's tables and figure."""
    parts = ("all", *(f"run-{k}" for k in RUNS))
    # Before any work, and before anything is done away with: what is cut off, or records that are not there.
    if again or None in [stored(m, part) for m in methods for part in parts]:
        open_campaign(RAW)
    if again:
        for path in (p for m in methods for p in (*(file_of(m, part) for part in parts), _file_of_times(m))):
            path.unlink(missing_ok=True)
    for method in methods:
        if any(stored(method, part) is None for part in parts[1:]):
            _single_runs(method)
    campaign = open_campaign(RAW) if any(stored(m, "all") is None for m in methods) else None
    for method in methods:
        if campaign is not None and stored(method, "all") is None:
            found = find(method, campaign)
            said = found.reason or f"{len(found.frequency_hz)} modes"
            print(f"all runs, {method}: {said}", flush=True)  # noqa: T201
            raise_if_asked()
    for method in methods:
        timed(method)
    write_page()


def _single_runs(method: str) -> None:
    """The single runs of a method that are missing, in a process of their own."""
    worker = [sys.executable, "-W", "ignore", __file__, "--worker", method]
    status = subprocess.run(worker, check=False).returncode
    if status == INTERRUPTED:
        raise KeyboardInterrupt
    said = "done" if status == 0 else f"broken off with status {status}"
    print(f"{method}: single runs {said}", flush=True)  # noqa: T201


def write_page() -> None:
    """Page, table and figure of all that is kept; InputError where nothing is."""
    import hati_identified_page

    methods = sorted({p.stem.removesuffix("-all") for p in FOLDER.glob("*-all.json")})
    if not methods:
        raise InputError("--page", f"{FOLDER} keeps nothing", "run the study first: the same without --page")
    hati_identified_page.write(methods)


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    if given.worker:
        # Interrupted it says nothing: who started it does.
        return worked_off(lambda: find_alone(given.methods[0], open_campaign(RAW)), "")
    kept = f"every finding that is done is kept in {FOLDER}; the same command goes on from there, less --again"
    return worked_off(write_page if given.page else lambda: go_on(given.methods, given.again), kept)


if __name__ == "__main__":
    sys.exit(main())
