"""Where cells are worked off: in a pool of processes, or on a Dask cluster."""

from __future__ import annotations

import atexit
import os
import secrets
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from multiprocessing import get_context
from pathlib import Path
from threading import Thread
from types import FrameType
from typing import Any

from vgvt.data import InputError


class _Worker:
    """What a worker knows of itself: plain values, as a handler of signals may come while an event's lock is held."""

    leaving = terminated = at_work = False


MakeExecutor = Callable[[], AbstractContextManager[Executor]]

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_CTRL_C, _MASKS = {signal.SIGINT}, hasattr(signal, "pthread_sigmask")  # Windows has no masks
_LOOK_S = 1.0  # between two looks for the parent
_TO_TIDY_S = 5.0  # for a worker without a parent or a pool to take away what it has on disk
_AGAIN_S = 0.1  # between two tries to remove what somebody still writes into
ATTEMPTS = 3
"""How often a cell is begun whose worker died under it."""


def process_pool(workers: int) -> MakeExecutor:
    """A pool of fresh processes with one BLAS thread each.

    What workers have on disk lies in one folder, which is this process's: it takes it away when they have ended. A
    worker may end at any moment, a folder of its own half made or half removed.
    """

    @contextmanager
    def make() -> Iterator[Executor]:
        # Named before it is made: no moment is left at which it would be there and nobody's.
        folder = Path(tempfile.gettempdir()) / f"vgvt-pool-{secrets.token_hex(6)}"
        # Spawned, and the variables set before: BLAS reads them once, when numpy is loaded.
        before = {name: os.environ.get(name) for name in _THREADS}
        mask: set[signal.Signals | int] | None = None
        try:
            os.environ.update(dict.fromkeys(_THREADS, "1"))
            pool = ProcessPoolExecutor(
                workers, mp_context=get_context("spawn"), initializer=leave_with_parent, initargs=(os.getpid(), folder)
            )
            if _MASKS and threading.current_thread() is not threading.main_thread():
                # Until a worker has its handlers Ctrl-C would be a traceback of whatever it imports. Not in the main
                # thread, which alone hears it; and only now: the tracker of what the pool shares opens the mask again.
                mask = signal.pthread_sigmask(signal.SIG_BLOCK, _CTRL_C)
            # In a thread: whoever goes on with an error need not wait for cells under way.
            closing = Thread(target=_closed, args=(pool, folder), name="close the pool")
            try:
                folder.mkdir(mode=0o700)
                yield pool
            except BaseException:
                # A kill reaches this process alone, and nobody takes what the cells under way would come to.
                for worker in dict(getattr(pool, "_processes", None) or {}).values():
                    worker.terminate()
                closing.start()
                raise
            closing.start()
            closing.join()
        finally:
            if mask is not None:
                signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value

    return make


def _closed(pool: Executor, folder: Path) -> None:
    """Wait for the workers, and take away what they had on disk."""
    pool.shutdown(wait=True, cancel_futures=True)
    _gone(folder)


def _gone(folder: Path) -> None:
    """Remove a folder, into which what a worker had started may write for a moment longer."""
    until = time.monotonic() + _TO_TIDY_S
    shutil.rmtree(folder, ignore_errors=True)
    while folder.exists() and time.monotonic() < until:
        time.sleep(_AGAIN_S)
        shutil.rmtree(folder, ignore_errors=True)


def leave_with_parent(parent: int, folder: Path | None = None) -> None:
    """Let this process end with that of its parent, whatever it is at work on: killed, a parent can tell nobody.

    And on Ctrl-C without a word: the parent says what there is to say. What it has on disk it takes away; temporary
    files lie in ``folder``, which is the parent's, and of its workers where there is no parent any more.
    """
    signal.signal(signal.SIGINT, _leave)
    # So a pool that has lost a worker ends the others.
    signal.signal(signal.SIGTERM, _leave)
    hung_up = getattr(signal, "SIGHUP", None)
    if hung_up is not None and signal.getsignal(hung_up) == signal.SIG_DFL:
        signal.signal(hung_up, _leave)
    if _MASKS:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _CTRL_C)
    own = threading.get_ident()
    if folder is not None:
        os.environ["TMPDIR"] = tempfile.tempdir = str(folder)

    def inherit() -> None:
        if folder is not None and os.getppid() != parent:
            _gone(folder)

    def watch() -> None:
        while os.getppid() == parent and not _Worker.terminated:
            time.sleep(_LOOK_S)
        if not _Worker.leaving:
            signal.pthread_kill(own, signal.SIGINT)
        until = time.monotonic() + _TO_TIDY_S
        while _Worker.at_work and time.monotonic() < until:
            time.sleep(_AGAIN_S)
        inherit()
        os._exit(1)

    atexit.register(inherit)
    Thread(target=watch, name="leave with parent", daemon=True).start()


def _leave(number: int, _frame: FrameType | None) -> None:
    """The handler of SIGINT and SIGTERM in a worker: the way out of a cell that no one prints, and nothing breaks off.

    Where it ends in a finaliser the cell is worked off to its end. Cells that wait behind it are not begun. Between two
    cells nothing is raised: what hands them over holds locks, which a way out would leave locked for all workers.
    """
    if number == signal.SIGTERM:
        _Worker.terminated = True
    if _Worker.leaving:
        return
    _Worker.leaving = True
    if _Worker.at_work:
        sys.unraisablehook = lambda _: None
        raise SystemExit(1)


@contextmanager
def at_work() -> Iterator[None]:
    """Around the work at a cell, in a worker: from here Ctrl-C has a way out. SystemExit where it came before."""
    _Worker.at_work = True
    try:
        if _Worker.leaving:
            raise SystemExit(1)
        yield
    finally:
        _Worker.at_work = False


def dask_cluster(address: str, workers: int) -> MakeExecutor:
    """A Dask cluster: ``tcp://host:port`` of a running scheduler, or ``local`` to start one with ``workers`` processes.

    InputError when dask.distributed is not installed or nobody answers at the address.
    """
    try:
        import distributed
    except ImportError:
        raise InputError(
            "--cluster", "dask.distributed is not installed", "install it: pip install 'vgvt[cluster]'"
        ) from None
    if address != "local" and "://" not in address:
        raise InputError("--cluster", f"{address!r} is no address", "write local, or tcp://HOST:PORT of a scheduler")

    @contextmanager
    def make() -> Iterator[Executor]:
        with ExitStack() as stack:
            if address == "local":
                cluster = distributed.LocalCluster(  # type: ignore[no-untyped-call]
                    n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
                )
                place: Any = stack.enter_context(cluster)
            else:
                place = address
            try:
                client = stack.enter_context(
                    distributed.Client(place, timeout="10s")  # type: ignore[no-untyped-call]
                )
            except OSError as error:
                raise InputError("--cluster", f"no scheduler answers at {address}", "start it first") from error
            # Dask itself runs a task again elsewhere when its worker dies.
            yield client.get_executor(pure=False, retries=ATTEMPTS - 1)

    return make
