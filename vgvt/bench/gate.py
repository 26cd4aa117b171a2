"""The gate that contestants start from: ``python -m vgvt.bench.gate``, a process that has loaded the libraries once.

Loading numpy, scipy and HDF5 takes longer than many an identification. The gate has done it and forks a
process for every contestant; it never sees a campaign, so that nothing passes from one to the next.

Each line of its input is a contestant in JSON: ``folder`` and ``path``, where modules are found. It answers with
two lines, the process's number when it has started and its exit status when it has ended.
"""

from __future__ import annotations

import importlib
import json
import os
import platform
import signal
import sys
import tempfile
from pathlib import Path
from typing import Any

from vgvt.identification import contestant
from vgvt.identification.isolation import FORBIDDEN

_LIBRARIES = (
    "scipy.linalg",
    "scipy.optimize",
    "scipy.signal",
    "scipy.stats",
    "vgvt.files.modal_dataset",
    "vgvt.identification.registry",
    "vgvt.identification.run",
    "vgvt.identification.watch",
    "vgvt.signals",
)


def load() -> None:
    """Load what contestants need; RuntimeError if that brought in anything that knows the truth.

    Many an import waits for the first call: so a small campaign of the gate's own is written and read, too.
    """
    from vgvt.files.campaign_file import read_campaign, write_campaign
    from vgvt.identification.example import Example

    for name in _LIBRARIES:
        importlib.import_module(name)
    with tempfile.TemporaryDirectory(prefix="vgvt-gate-") as folder:
        path = Path(folder) / contestant.CAMPAIGN
        write_campaign(path, Example(stations=1, duration_s=4.0, sweep_s=3.0).campaign())
        read_campaign(path)
    platform.processor()  # it starts a process the first time, which a contestant must not
    known = [m for m in sys.modules if any(m == f or m.startswith(f + ".") for f in FORBIDDEN)]
    if known:
        raise RuntimeError(f"the gate loaded {', '.join(known)}")


def serve() -> None:
    """Start contestants one after the other until the input ends."""
    for line in sys.stdin:
        asked = json.loads(line)
        process = os.fork()
        if process == 0:
            _become(asked)
        _say(process)
        _, status = os.waitpid(process, 0)
        _say(os.waitstatus_to_exitcode(status))


def _become(asked: dict[str, Any]) -> None:
    """Be the contestant and nothing else: never returns, holds no pipe of the gate's, leads a group of its own."""
    status = 1
    try:
        os.setsid()
        folder = Path(asked["folder"])
        os.chdir(folder)
        nothing = os.open(os.devnull, os.O_RDWR)
        errors = os.open(folder / "stderr.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for mine, standard in ((nothing, 0), (nothing, 1), (errors, 2)):
            os.dup2(mine, standard)
        sys.path[:] = asked["path"]
        sys.argv[:] = ["contestant", str(folder)]
        importlib.invalidate_caches()
        status = contestant.main()
    finally:
        os._exit(status)


def _say(number: int) -> None:
    sys.stdout.write(f"{number}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    # Told to end while it loads, it takes away what it has on disk.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    load()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    serve()
