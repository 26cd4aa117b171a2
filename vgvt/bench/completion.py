"""Cells worked off in the order in which they get done, whatever becomes of workers and of whoever asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from threading import Thread
from typing import TypeAlias, TypeVar

from vgvt.bench.cell import Row
from vgvt.bench.executors import ATTEMPTS, MakeExecutor, at_work
from vgvt.bench.task import Titled

T = TypeVar("T", bound=Titled)
Work: TypeAlias = Callable[[T], list[Row]]
_Finished: TypeAlias = "SimpleQueue[Future[list[Row]] | None]"
_Said: TypeAlias = "SimpleQueue[tuple[int, list[Row]] | BaseException | None]"


class _NobodyListensError(Exception):
    """Whoever asked for the rows has gone on to something else."""


def in_order_of_completion(
    cells: Sequence[T], make: MakeExecutor | None, work: Work[T]
) -> Iterator[tuple[T, list[Row]]]:
    """Every cell with its rows as soon as they are there; serially without an executor.

    A pool that loses a worker is made anew. What was under way is done again after all the rest, each with nothing
    beside it: a worker that dies then was killed by that cell. A cell that does so three times raises
    RuntimeError with its title, and so do workers that die three times in a row before they begin anything.
    """
    if make is None:
        for cell in cells:
            yield cell, work(cell)
        return
    # Ctrl-C is raised in the main thread, at any line. There it may only wait: an executor that is broken off while it
    # holds one of its locks never ends.
    finished: _Finished = SimpleQueue()
    said: _Said = SimpleQueue()
    thread = Thread(target=_told, args=(cells, make, work, finished, said), name="work off cells")
    try:
        thread.start()
        while (word := said.get()) is not None:
            if isinstance(word, BaseException):
                raise word
            k, rows = word
            yield cells[k], rows
    finally:
        finished.put(None)
        if thread.ident is not None:
            thread.join()


def _told(cells: Sequence[T], make: MakeExecutor, work: Work[T], finished: _Finished, said: _Said) -> None:
    """Say the number and the rows of every cell, and None or an error behind the last."""
    try:
        for word in _worked_off(cells, make, work, finished):
            said.put(word)
        said.put(None)
    except _NobodyListensError:
        return
    except BaseException as error:  # noqa: BLE001  raised again where somebody waits for it
        said.put(error)


def _worked_off(
    cells: Sequence[T], make: MakeExecutor, work: Work[T], finished: _Finished
) -> Iterator[tuple[int, list[Row]]]:
    left = dict.fromkeys(range(len(cells)))
    deaths: dict[int, int] = {}  # of those that were under way when a worker died: how many were surely theirs
    before_work = 0
    while left:
        together = [k for k in left if k not in deaths] or [min(deaths, key=lambda k: (deaths[k], k))]
        with TemporaryDirectory(prefix="vgvt-under-way-", ignore_cleanup_errors=True) as folder, make() as executor:
            marks = {k: Path(folder) / str(k) for k in together}
            futures: dict[Future[list[Row]], int] = {}
            with suppress(BrokenProcessPool):  # where a worker dies before the last is handed over
                for k, mark in marks.items():
                    futures[executor.submit(_marked, mark, work, cells[k])] = k
            for future in futures:
                future.add_done_callback(finished.put)
            for k, rows in _until_broken(futures, finished):
                del left[k]
                deaths.pop(k, None)
                yield k, rows
            under_way = [k for k, mark in marks.items() if k in left and mark.exists()]
        for k in under_way:
            deaths[k] = deaths.get(k, 0) + (len(under_way) == 1)
            if deaths[k] >= ATTEMPTS:
                raise RuntimeError(f"{cells[k].title}: its worker died {ATTEMPTS} times")
        before_work = before_work + 1 if not under_way and any(k in left for k in together) else 0
        if before_work >= ATTEMPTS:
            raise RuntimeError(f"the workers died {ATTEMPTS} times in a row before they began anything")


def _marked(mark: Path, work: Work[T], cell: T) -> list[Row]:
    """The rows of a cell; the mark is there while it is under way, and stays when the worker dies under it."""
    with at_work():
        with suppress(OSError):  # on another machine the folder is not there, and nobody asks for the mark
            mark.touch()
        try:
            return work(cell)
        finally:
            with suppress(OSError):
                mark.unlink()


def _until_broken(futures: dict[Future[list[Row]], int], finished: _Finished) -> Iterator[tuple[int, list[Row]]]:
    """Results as they come; ends early when the pool breaks, or somebody sends a worker away.

    _NobodyListensError when whoever asked has gone.
    """
    left = len(futures)
    while left:
        future = finished.get()
        if future is None:
            raise _NobodyListensError
        if future not in futures:  # of a pool that broke
            continue
        left -= 1
        try:
            rows = future.result()
        except (BrokenProcessPool, SystemExit):
            return
        yield futures[future], rows
