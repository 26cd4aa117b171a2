"""One identification in a process of its own: ``python -m vgvt.identification.contestant REQUEST.json``.

The process is given a folder with the campaign and the request and nothing else. The system ends it
by an alarm when its time is up, whatever it is doing. It writes ``claim.nc`` when the method came to a
claim, and always ``outcome.json``: what happened, the seconds that the identification took, the memory
it needed and what the method reached for without leave.
"""

from __future__ import annotations

import json
import signal
import sys
import time
from pathlib import Path
from typing import Any

CAMPAIGN, CLAIM, OUTCOME, REQUEST = "campaign.nc", "claim.nc", "outcome.json", "request.json"


def compete(folder: Path) -> dict[str, Any]:
    """Do what ``request.json`` in a folder asks: keys identifier, settings, band_hz, memory_mib, time_s.

    All but the first two may be null: the excited band, no limit.
    """
    from vgvt.data import InputError, PluginError
    from vgvt.files.campaign_file import read_campaign
    from vgvt.files.modal_dataset import modal_dataset
    from vgvt.files.netcdf import write_groups
    from vgvt.identification.registry import make_identifier
    from vgvt.identification.run import ContractError, run_identifier
    from vgvt.identification.watch import Watch

    request = json.loads((folder / REQUEST).read_text(encoding="utf-8"))
    watch = Watch((folder,))
    watch.start()
    campaign = read_campaign(folder / CAMPAIGN)
    band = None if request["band_hz"] is None else (float(request["band_hz"][0]), float(request["band_hz"][1]))
    allowed_mib = None if request["memory_mib"] is None else _limit_memory(float(request["memory_mib"]))
    if request["time_s"] is not None:
        _limit_time(float(request["time_s"]))
    start = time.perf_counter()
    outcome: dict[str, Any] = {"reason": ""}
    claim = None
    try:
        identifier = make_identifier(request["identifier"], **request["settings"])
        start = time.perf_counter()  # the plugin's import is not its work
        claim = run_identifier(identifier, campaign, band)
    except MemoryError:
        outcome["reason"] = (
            "needs more memory" if allowed_mib is None else f"needs more than {allowed_mib:.6g} MiB of memory"
        )
    except InputError as error:
        outcome["reason"] = f"refused: {str(error).splitlines()[0]}"
    except ContractError as error:
        outcome["reason"] = f"broke its contract: {error}"
    except Exception as error:  # noqa: BLE001  whatever a method raises is an entry in the table
        met = error.__cause__ if isinstance(error, PluginError) and error.__cause__ else error  # the entry has the name
        outcome["reason"] = f"crashed: {type(met).__name__}: {str(met).splitlines()[0] if str(met) else ''}"
    outcome["wall_s"] = time.perf_counter() - start
    _limit_time(0.0)
    outcome["peak_memory_mib"] = _peak_memory_mib()
    if watch.misdeeds:
        outcome["reason"] = "cheated: " + "; ".join(watch.misdeeds)
        claim = None
    if claim is not None:
        write_groups(folder / CLAIM, {"/": modal_dataset(claim)})
    return outcome


def _limit_memory(limit_mib: float) -> float:
    """Let the process grow by this much from here, in MiB, or as far as it may; without effect where none can be set.

    Returns by how much that is.
    """
    try:
        import resource
    except ImportError:  # Windows
        return limit_mib
    held = 0
    status = Path("/proc/self/statm")
    if status.is_file():
        held = int(status.read_text().split()[0]) * resource.getpagesize()
    limit = held + int(limit_mib * 2**20)
    # Nobody may raise a limit that the shell or a batch system has set.
    for already in resource.getrlimit(resource.RLIMIT_AS):
        if already != resource.RLIM_INFINITY:
            limit = min(limit, already)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    return (limit - held) / 2**20


def _limit_time(seconds: float) -> None:
    """End the process after this long, 0 never; left to the umpire's own clock where there is no alarm."""
    if hasattr(signal, "setitimer"):
        # The default action, not a handler: a method that hangs in C code would never let one run.
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _peak_memory_mib() -> float | None:
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak / (2**20 if sys.platform == "darwin" else 2**10))


def main() -> int:
    """Compete in the folder that the command line names."""
    folder = Path(sys.argv[1])
    try:
        outcome = compete(folder)
    except Exception as error:  # noqa: BLE001
        outcome = {"reason": f"could not start: {type(error).__name__}: {error}"}
    (folder / OUTCOME).write_text(json.dumps(outcome), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
