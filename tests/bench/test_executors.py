"""A pool whose workers die: every cell gets its rows, and the one that kills them is the one that is named."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest
from patience import soon
from threadpoolctl import threadpool_info

from vgvt.bench.completion import in_order_of_completion
from vgvt.bench.executors import MakeExecutor, at_work, process_pool


@dataclass(frozen=True)
class Stub:
    """In a cell's place: kills its worker so many times, or takes its time."""

    number: int
    folder: Path
    deaths: int = 0
    takes_s: float = 0.0

    @property
    def title(self) -> str:
        return f"cell {self.number}"


def work(stub: Stub) -> list[dict[str, Any]]:
    """The number as a row, after as many deaths as the stub has; the folder remembers those that were."""
    died = len(list(stub.folder.glob(f"{stub.number}-*")))
    if died < stub.deaths:
        (stub.folder / f"{stub.number}-{died}").touch()
        os._exit(9)
    time.sleep(stub.takes_s)
    return [{"number": stub.number}]


def quick_pool(workers: int) -> MakeExecutor:
    """A pool as the bench's own, but of processes that start in an instant."""

    @contextmanager
    def make() -> Iterator[Executor]:
        context = get_context("forkserver")
        context.set_forkserver_preload(["vgvt.bench.executors"])
        pool = ProcessPoolExecutor(workers, mp_context=context)
        try:
            yield pool
        finally:
            pool.shutdown(wait=False, cancel_futures=True)

    return make


def finished(stubs: list[Stub], make: MakeExecutor, done: list[int]) -> None:
    """Work the stubs off; ``done`` grows by the number of each as its rows come, for what is left of it by an error."""
    for stub, rows in in_order_of_completion(stubs, make, work):
        assert rows == [{"number": stub.number}]
        done.append(stub.number)


PINS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def test_workers_have_one_blas_thread_each_where_nobody_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the environment says nothing each would take all cores. What it says here is as before when all is done."""
    for name in PINS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv(PINS[2], "7")
    with process_pool(1)() as pool:
        libraries = pool.submit(threadpool_info).result()
        pins = [pool.submit(os.getenv, name).result() for name in PINS]
    assert any(library["user_api"] == "blas" for library in libraries)
    assert {library["num_threads"] for library in libraries} == {1}
    assert pins == ["1"] * len(PINS)
    assert [os.getenv(name) for name in PINS] == [None, None, "7", None]


@pytest.mark.slow
def test_three_cells_that_lose_a_worker_each_are_no_three_deaths_of_one(tmp_path: Path) -> None:
    stubs = [Stub(k, tmp_path, deaths=1 if k in (1, 3, 5) else 0) for k in range(8)]
    done: list[int] = []
    finished(stubs, quick_pool(1), done)
    assert sorted(done) == list(range(8))
    assert len(list(tmp_path.iterdir())) == 3


def test_the_cell_that_kills_its_worker_is_named_and_no_neighbour(tmp_path: Path) -> None:
    """The first cell is under way at each of the deaths that it has no part in; all but the culprit are done."""
    stubs = [Stub(0, tmp_path, takes_s=1.5), Stub(1, tmp_path, deaths=99), *(Stub(k, tmp_path) for k in range(2, 6))]
    done: list[int] = []
    with pytest.raises(RuntimeError, match="cell 1: its worker died 3 times"):
        finished(stubs, quick_pool(2), done)
    assert sorted(done) == [0, 2, 3, 4, 5]


def test_workers_that_cannot_begin_are_no_cells_fault(tmp_path: Path) -> None:
    made = []

    @contextmanager
    def stillborn() -> Iterator[Executor]:
        made.append(1)
        with ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=os._exit, initargs=(9,)) as pool:
            yield pool

    with pytest.raises(RuntimeError, match="3 times in a row before they began"):
        finished([Stub(k, tmp_path) for k in range(3)], stillborn, [])
    assert len(made) == 3


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where this process and the workers that it starts have their temporary files."""
    place = tmp_path / "temporary"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(place))
    return place


def die_with_a_folder() -> None:
    tempfile.mkdtemp(prefix="vgvt-contest-")
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_worker_that_is_killed_leaves_nothing_on_disk(temporary: Path) -> None:
    """Its folder cannot be its own alone: what is killed takes nothing away."""
    with process_pool(1)() as pool:
        assert isinstance(pool.submit(die_with_a_folder).exception(), BrokenProcessPool)
    assert list(temporary.iterdir()) == []


@at_work()
def tidy_slowly(told: Path) -> None:
    """In a folder until it is told to leave, and then for a while longer, as one that waits for its contestant."""
    with tempfile.TemporaryDirectory(prefix="vgvt-contest-") as folder:
        told.write_text(folder)
        try:
            time.sleep(60)
        finally:
            time.sleep(1)
            told.with_suffix(".tidied").touch()


def test_a_worker_that_is_gone_lets_the_others_tidy(temporary: Path, tmp_path: Path) -> None:
    """The pool ends them."""
    told = tmp_path / "told"
    with process_pool(2)() as pool:
        busy = pool.submit(tidy_slowly, told)
        assert soon(told.exists)
        idle = pool.submit(os.getpid).result()
        os.kill(idle, signal.SIGKILL)
        assert isinstance(busy.exception(timeout=30), BrokenProcessPool)
    assert told.with_suffix(".tidied").exists()
    assert list(temporary.iterdir()) == []
