"""Where cells are worked off: in this process, in a pool of processes, or on a Dask cluster."""

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
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from types import FrameType
from typing import Any

from vgvt.bench.cell import Cell, Row, run_cell
from vgvt.data import InputError

MakeExecutor = Callable[[], AbstractContextManager[Executor]]

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_LOOK_S = 1.0  # between two looks for the parent
_TO_TIDY_S = 5.0  # for a worker without a parent or a pool to take away what it has on disk
_AGAIN_S = 0.1  # between two tries to remove what somebody still writes into
_ATTEMPTS = 3  # of a cell whose worker died under it
_leaving, _terminated = threading.Event(), threading.Event()


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
        os.environ.update(dict.fromkeys(_THREADS, "1"))
        pool = ProcessPoolExecutor(
            workers, mp_context=get_context("spawn"), initializer=leave_with_parent, initargs=(os.getpid(), folder)
        )
        # In a thread: Ctrl-C breaks off none, and whoever goes on with an error need not wait for cells under way.
        closing = Thread(target=_closed, args=(pool, folder), name="close the pool")
        try:
            folder.mkdir(mode=0o700)
            yield pool
        except BaseException:
            closing.start()
            raise
        else:
            closing.start()
            closing.join()
        finally:
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value

    return make


def _closed(pool: Executor, folder: Path) -> None:
    """Wait for the cells that are under way, and take away what all workers had on disk."""
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
    own = threading.get_ident()
    if folder is not None:
        os.environ["TMPDIR"] = tempfile.tempdir = str(folder)

    def inherit() -> None:
        if folder is not None and os.getppid() != parent:
            _gone(folder)

    def watch() -> None:
        while os.getppid() == parent and not _terminated.is_set():
            time.sleep(_LOOK_S)
        if not _leaving.is_set():
            signal.pthread_kill(own, signal.SIGINT)
        time.sleep(_TO_TIDY_S)
        inherit()
        os._exit(1)

    atexit.register(inherit)
    Thread(target=watch, name="leave with parent", daemon=True).start()


def _leave(number: int, _frame: FrameType | None) -> None:
    """The handler of SIGINT and SIGTERM in a worker: the way out that no one prints, and that nothing breaks off.

    Where it ends in a finaliser the cell is worked off to its end. Cells that wait behind it are not begun.
    """
    if number == signal.SIGTERM:
        _terminated.set()
    if _leaving.is_set():
        return
    _leaving.set()
    sys.unraisablehook = lambda _: None
    raise SystemExit(1)


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
            yield client.get_executor(pure=False, retries=_ATTEMPTS - 1)

    return make


def in_order_of_completion(
    cells: Sequence[Cell], make: MakeExecutor | None, work: Callable[[Cell], list[Row]] = run_cell
) -> Iterator[tuple[Cell, list[Row]]]:
    """Every cell with its rows as soon as they are there; serially without an executor.

    A pool that loses a worker is made anew. What was under way is done again after all the rest, each with nothing
    beside it: a worker that dies then was killed by that cell. A cell that does so three times raises
    RuntimeError with its title, and so do workers that die three times in a row before they begin anything.
    """
    if make is None:
        for cell in cells:
            yield cell, work(cell)
        return
    left = dict.fromkeys(range(len(cells)))
    deaths: dict[int, int] = {}  # of those that were under way when a worker died: how many were surely theirs
    before_work = 0
    while left:
        together = [k for k in left if k not in deaths] or [min(deaths, key=lambda k: (deaths[k], k))]
        with TemporaryDirectory(prefix="vgvt-under-way-", ignore_cleanup_errors=True) as folder, make() as executor:
            marks = {k: Path(folder) / str(k) for k in together}
            futures = {executor.submit(_marked, mark, work, cells[k]): k for k, mark in marks.items()}
            for k, rows in _until_broken(futures):
                del left[k]
                deaths.pop(k, None)
                yield cells[k], rows
            under_way = [k for k, mark in marks.items() if k in left and mark.exists()]
        for k in under_way:
            deaths[k] = deaths.get(k, 0) + (len(under_way) == 1)
            if deaths[k] >= _ATTEMPTS:
                raise RuntimeError(f"{cells[k].title}: its worker died {_ATTEMPTS} times")
        before_work = before_work + 1 if not under_way and any(k in left for k in together) else 0
        if before_work >= _ATTEMPTS:
            raise RuntimeError(f"the workers died {_ATTEMPTS} times in a row before they began anything")


def _marked(mark: Path, work: Callable[[Cell], list[Row]], cell: Cell) -> list[Row]:
    """The rows of a cell; the mark is there while it is under way, and stays when the worker dies under it."""
    if _leaving.is_set():
        raise SystemExit(1)
    with suppress(OSError):  # on another machine the folder is not there, and nobody asks for the mark
        mark.touch()
    try:
        return work(cell)
    finally:
        with suppress(OSError):
            mark.unlink()


def _until_broken(futures: dict[Future[list[Row]], int]) -> Iterator[tuple[int, list[Row]]]:
    """Results as they come; ends early when the pool breaks."""
    waiting = set(futures)
    while waiting:
        done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            try:
                rows = future.result()
            except BrokenProcessPool:
                return
            yield futures[future], rows
