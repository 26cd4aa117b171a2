"""Starting contestants and waiting for them: through a gate that this thread keeps, or each in an interpreter."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import threading
import time
import weakref
from pathlib import Path

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_STARTING_S = 60.0  # for the interpreter and its libraries; the contestant's own alarm counts the identification alone
_TO_TIDY_S = 2.0  # for a gate that is told to end, until it is killed
FORKS = sys.platform.startswith("linux")
"""Whether a process that has loaded numpy may be forked here."""

_here = threading.local()


class OutOfTimeError(Exception):
    """A contestant did not end by itself."""


class GateLostError(Exception):
    """The gate died: nobody knows what became of the contestant."""


def run_contestant(folder: Path, time_s: float) -> int:
    """The exit status of the contestant in a folder, negative for a signal; it works in a process of its own.

    OutOfTimeError when it outlives ``time_s`` and its own alarm: it is killed with all that it started.
    """
    if not FORKS:
        return _interpreter(folder, time_s)
    try:
        return _gate().run(folder, time_s + _STARTING_S)
    except GateLostError:
        return _interpreter(folder, time_s)


class Gate:
    """A ``vgvt.bench.gate`` process and the pipes to it; it ends with this object or this process."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "vgvt.bench.gate"],
            env=_environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            start_new_session=True,  # Ctrl-C is for this process, which then ends the others
        )
        self.close = weakref.finalize(self, _end, self._process)

    def run(self, folder: Path, time_s: float) -> int:
        """Exit status of the contestant in a folder; OutOfTimeError after ``time_s``, GateLostError without a gate."""
        deadline = time.monotonic() + time_s
        asked = json.dumps({"folder": str(folder), "path": [p for p in sys.path if p]})
        contestant = None
        if not self.close.alive:
            raise GateLostError
        try:
            try:
                assert self._process.stdin is not None, "a pipe was asked for"
                self._process.stdin.write(f"{asked}\n".encode())
            except OSError as error:
                raise GateLostError from error
            contestant = self._answer(deadline)
            return self._answer(deadline)
        except BaseException:
            # Whatever broke off, time or Ctrl-C: neither the contestant nor half an answer may be left over.
            if contestant is not None:
                with contextlib.suppress(OSError):
                    os.killpg(contestant, signal.SIGKILL)
            self.close()
            raise

    def _answer(self, deadline: float) -> int:
        answers = self._process.stdout
        assert answers is not None, "a pipe was asked for"
        ready, _, _ = select.select([answers], [], [], max(deadline - time.monotonic(), 0.0))
        if not ready:
            raise OutOfTimeError
        line = answers.readline()
        if not line:
            raise GateLostError
        return int(line)


def _gate() -> Gate:
    """The gate of this thread, made when there is none that works."""
    gate: Gate | None = getattr(_here, "gate", None)
    if gate is None or not gate.close.alive:
        gate = _here.gate = Gate()
    return gate


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(timeout=_TO_TIDY_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            pipe.close()


def _environment() -> dict[str, str]:
    path = os.pathsep.join(p for p in sys.path if p)
    return {**os.environ, **dict.fromkeys(_THREADS, "1"), "PYTHONPATH": path}


def _interpreter(folder: Path, time_s: float) -> int:
    """The same in an interpreter started for it alone."""
    with (folder / "stderr.txt").open("wb") as errors:
        process = subprocess.Popen(
            [sys.executable, "-m", "vgvt.identification.contestant", str(folder)],
            cwd=folder,
            env=_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,
        )
        try:
            return process.wait(timeout=time_s + _STARTING_S)
        except subprocess.TimeoutExpired:
            raise OutOfTimeError from None
        finally:
            if process.poll() is None:
                _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()
