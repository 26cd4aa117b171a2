"""Ctrl-C while cells are worked off: it comes at any line, and breaks off nothing that holds a lock."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from patience import soon

from vgvt.bench.completion import in_order_of_completion
from vgvt.bench.executors import MakeExecutor, at_work, process_pool


@dataclass(frozen=True)
class Stub:
    """In a cell's place."""

    number: int
    title: str = "a cell"


def work(stub: Stub) -> list[dict[str, Any]]:
    return [{"number": stub.number}]


class Interrupting(ThreadPoolExecutor):
    """Ctrl-C arrives when it is handed its third task, and holds the lock that it is shut down with."""

    def __init__(self) -> None:
        super().__init__(1)
        self.lock, self.handed, self.was_shut = threading.Lock(), 0, False

    def submit(self, *arguments: Any, **named: Any) -> Future[Any]:
        self.lock.acquire()
        self.handed += 1
        if self.handed == 3:
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(20):  # lines at which Python looks for signals
                time.sleep(0.01)
        self.lock.release()
        return super().submit(*arguments, **named)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self.was_shut = self.lock.acquire(timeout=5)
        super().shutdown(wait, cancel_futures=cancel_futures)


@pytest.fixture
def ctrl_c(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Ctrl-C as a command has it, whoever runs the tests."""

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, interrupt)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_leaves_no_lock_of_the_executor_locked() -> None:
    executor = Interrupting()

    @contextmanager
    def make() -> Iterator[Executor]:
        try:
            yield executor
        finally:
            executor.shutdown(wait=False, cancel_futures=True)

    with pytest.raises(KeyboardInterrupt):
        list(in_order_of_completion([Stub(k) for k in range(5)], make, work))
    assert executor.handed == 5
    assert executor.was_shut


@pytest.fixture
def counted() -> tuple[list[int], MakeExecutor]:
    """What an executor of one thread was given, and how it is made."""
    given: list[int] = []

    class Counting(ThreadPoolExecutor):
        def submit(self, function: Any, *arguments: Any, **named: Any) -> Future[Any]:
            given.append(threading.get_ident())
            return super().submit(function, *arguments, **named)

    @contextmanager
    def make() -> Iterator[Executor]:
        with Counting(1) as executor:
            yield executor

    return given, make


def test_the_main_thread_never_touches_the_executor(counted: tuple[list[int], MakeExecutor]) -> None:
    given, make = counted
    cells = [Stub(k) for k in range(4)]
    found = {cell.number: rows for cell, rows in in_order_of_completion(cells, make, work)}
    assert found == {k: [{"number": k}] for k in range(4)}
    assert len(given) == 4
    assert threading.main_thread().ident not in given


def fail_at_one(stub: Stub) -> list[dict[str, Any]]:
    if stub.number == 1:
        raise ValueError("this cell fails")
    return work(stub)


def test_an_error_of_a_cell_is_raised_where_its_rows_are_awaited(counted: tuple[list[int], MakeExecutor]) -> None:
    cells = [Stub(k) for k in range(4)]
    with pytest.raises(ValueError, match="this cell fails"):
        list(in_order_of_completion(cells, counted[1], fail_at_one))


def test_who_stops_asking_leaves_no_thread_behind(counted: tuple[list[int], MakeExecutor]) -> None:
    rows = in_order_of_completion([Stub(k) for k in range(4)], counted[1], work)
    next(rows)
    rows.close()  # type: ignore[attr-defined]
    assert "work off cells" not in {thread.name for thread in threading.enumerate()}


@at_work()
def take_long() -> None:
    time.sleep(60)


@at_work()
def nothing() -> None:
    return


def test_a_worker_between_two_cells_is_not_broken_off_by_ctrl_c() -> None:
    """It would leave the queue locked for all workers; the cells behind are not begun all the same."""
    with process_pool(1)() as pool:
        pid = pool.submit(os.getpid).result()
        os.kill(pid, signal.SIGINT)
        assert soon(lambda: isinstance(pool.submit(nothing).exception(timeout=30), SystemExit))
        assert pool.submit(os.getpid).result() == pid


def test_a_worker_at_a_cell_leaves_it_on_ctrl_c() -> None:
    with process_pool(1)() as pool:
        pid = pool.submit(os.getpid).result()
        under_way = pool.submit(take_long)
        assert soon(under_way.running)
        time.sleep(0.5)
        os.kill(pid, signal.SIGINT)
        assert isinstance(under_way.exception(timeout=30), SystemExit)


def sent_away(stub: Stub) -> list[dict[str, Any]]:
    """The first worker that has the second cell gets the signal that ends workers, as from a batch system."""
    mark = Path(os.environ["VGVT_TEST_MARKS"]) / "sent away"
    if stub.number == 1 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(60)
    return work(stub)


def test_a_worker_that_is_sent_away_is_one_that_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its cell is done again by another one: no reason to end without a word."""
    monkeypatch.setenv("VGVT_TEST_MARKS", str(tmp_path))
    cells = [Stub(k) for k in range(4)]
    rows = in_order_of_completion(cells, process_pool(1), sent_away)
    assert sorted(cell.number for cell, _ in rows) == [0, 1, 2, 3]


def test_what_the_environment_said_of_threads_it_says_again_where_there_is_no_pool(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    with pytest.raises(ValueError, match="max_workers"), process_pool(0)():
        pytest.fail("there is no such pool")
    assert os.environ["OMP_NUM_THREADS"] == "7"


def test_a_worker_that_is_just_born_says_nothing_of_ctrl_c(capfd: pytest.CaptureFixture[str]) -> None:
    """It has no handlers before it has loaded what it needs; from then on it begins nothing."""
    said: list[BaseException | None] = []

    def interrupted_at_birth() -> None:
        with process_pool(1)() as pool:
            handed: Future[Any] = pool.submit(_at_work)
            (born,) = pool._processes  # type: ignore[attr-defined]
            os.kill(born, signal.SIGINT)
            said.append(handed.exception(timeout=60))

    thread = threading.Thread(target=interrupted_at_birth)
    thread.start()
    thread.join(60)
    assert isinstance(said[0], SystemExit)
    assert capfd.readouterr().err == ""


def test_a_pool_in_the_main_thread_keeps_no_ctrl_c_from_it() -> None:
    with process_pool(1)():
        assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, set())


def _at_work() -> None:
    with at_work():
        pass
