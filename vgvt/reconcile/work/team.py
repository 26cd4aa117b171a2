"""Tasks of a round shared with helpers: this process forked once, so that each knows the problem and keeps its own.

What travels is pickled, the problem and the catalogue's hypotheses by name. Whoever does a task, it is the same one:
how many help changes the time and nothing else. Where processes cannot be forked nobody helps.
"""

from __future__ import annotations

import io
import multiprocessing
import os
import pickle
import signal
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import chain
from multiprocessing.connection import Connection, wait
from multiprocessing.sharedctypes import Synchronized
from queue import SimpleQueue
from threading import Thread
from types import TracebackType
from typing import Any, Self, TypeAlias

from vgvt.reconcile.work.progress import Progress

FORKS = sys.platform.startswith("linux")
"""Whether a process that has loaded numpy may be forked here."""
# Between two words of a helper.
_SELDOM_S = 0.25

# What pickle raises of a lambda, of what is local to a function, and of what holds a lock: the task is done here then.
_CANNOT_TRAVEL = (pickle.PicklingError, AttributeError, TypeError)
_FORK = multiprocessing.get_context("fork" if FORKS else None)

Task = tuple[Callable[..., Any], tuple[Any, ...]]
Turn: TypeAlias = "Synchronized[int]"
"""The number of the task whose turn it is, seen by all."""


class Team:
    """So many ``workers``: this process and its helpers, each of which has what is ``shared`` and is sent the rest."""

    def __init__(self, workers: int, shared: Sequence[object]) -> None:
        self._shared = tuple(shared)
        self._helpers: list[_Helper] = []
        self._turn: Turn | None = None
        if workers > 1 and FORKS and _may_have_children():
            # A system may offer processes no memory to share: nobody helps there.
            with suppress(OSError):
                self._turn = _FORK.Value("i", 0)
            if self._turn is not None:
                self._helpers = [_Helper(self._shared, self._turn) for _ in range(workers - 1)]

    @property
    def workers(self) -> int:
        """How many share the work."""
        return 1 + len(self._helpers)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for helper in self._helpers:
            helper.dismiss()

    def work_off(self, tasks: Sequence[Task], tell: Progress) -> list[Any]:
        """What ``function(*arguments, progress)`` returns for every task, in their order.

        Functions are module-level ones, so that helpers know them too. A task that cannot be sent is done here, and so
        is one that failed: its error is raised as it would be without helpers.
        """
        round_ = _Round(tasks, self._helpers, self._shared, self._turn, tell)
        try:
            return round_.done()
        except BaseException:
            # What a helper still works at nobody waits for.
            for helper in self._helpers:
                helper.dismiss()
            self._helpers, self._turn = [], None
            raise


def _may_have_children() -> bool:
    return not multiprocessing.current_process().daemon


class _Round:
    """Tasks being worked off: whoever is free takes the next one, so that nobody waits for another to hand it out."""

    def __init__(
        self, tasks: Sequence[Task], helpers: Sequence[_Helper], shared: tuple[object, ...], turn: Turn | None,
        tell: Progress,
    ) -> None:  # fmt: skip
        self._tasks, self._shared, self._turn, self._tell = tasks, shared, turn, tell
        self._busy = {helper.pipe: helper for helper in helpers}
        self._here = deque[int]()
        self._results: dict[int, Any] = {}
        self._shares = [0.0] * len(tasks)

    def done(self) -> list[Any]:
        count = len(self._tasks)
        self._begin()
        for k in range(count) if self._turn is None else chain(range(count)[:1], _turns(self._turn, count)):
            self._do(k)
            self._hear(0.0)
            self._do_what_came_back()
        while self._busy:
            self._hear(None)
            self._do_what_came_back()
        # A helper that died, of memory as a rule, has its task done here.
        for k in range(count):
            if k not in self._results:
                self._do(k)
        return [self._results[k] for k in range(count)]

    def _begin(self) -> None:
        """Give every helper all tasks: in one piece, so that what they have in common travels once."""
        if self._turn is None:
            return
        self._turn.value = 1  # the first is for this process
        packed = _packed_tasks(self._tasks, self._shared)
        for pipe in tuple(self._busy):
            try:
                pipe.send_bytes(packed)
            except OSError:
                del self._busy[pipe]

    def _do_what_came_back(self) -> None:
        while self._here:
            self._do(self._here.popleft())

    def _do(self, k: int) -> None:
        function, arguments = self._tasks[k]
        self._results[k] = function(*arguments, lambda fraction, message: self._told(k, fraction, message))
        self._shares[k] = 1.0

    def _told(self, k: int, fraction: float, message: str) -> None:
        self._shares[k] = fraction
        self._tell(sum(self._shares) / len(self._shares), message)
        self._hear(0.0)

    def _hear(self, patience_s: float | None) -> None:
        """Take in all that helpers have said; with None wait until one says something."""
        ready = wait(list(self._busy), patience_s)
        while ready:
            for pipe in ready:
                assert isinstance(pipe, Connection)
                self._take(pipe)
            ready = wait(list(self._busy), 0.0)

    def _take(self, pipe: Connection) -> None:
        """One message."""
        try:
            kind, k, value = _unpacked(pipe.recv_bytes(), self._shared)
        except (EOFError, OSError):
            kind, k, value = "over", 0, None
        if kind == "told":
            self._shares[k] = value[0]
            self._tell(sum(self._shares) / len(self._shares), value[1])
        elif kind == "done":
            self._results[k], self._shares[k] = value, 1.0
        elif kind == "do it yourself":
            self._here.append(k)
        else:
            del self._busy[pipe]


class _Helper:
    """A forked process and the pipe to it."""

    def __init__(self, shared: tuple[object, ...], turn: Turn) -> None:
        self.pipe, other = _FORK.Pipe()
        self._process = _FORK.Process(target=_help, args=(other, self.pipe, shared, turn), daemon=True)
        with warnings.catch_warnings():
            # Where a terminal's progress has a thread of its own, Python 3.12 warns of its locks: helpers draw nothing.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._process.start()
        other.close()

    def dismiss(self) -> None:
        """End it, whatever it does."""
        self.pipe.close()
        self._process.terminate()
        self._process.join()


def _help(pipe: Connection, others_end: Connection, shared: tuple[object, ...], turn: Turn) -> None:
    """What a helper does all its life: its share of one round after the other, until nobody is there to begin one."""
    # Ctrl-C is for the process that was started: it dismisses its helpers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    others_end.close()
    said: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_send, args=(pipe, said), daemon=True).start()
    try:
        while True:
            tasks = _unpacked(pipe.recv_bytes(), shared)
            for k in _turns(turn, len(tasks)):
                said.put(_answer(k, tasks[k], said, shared))
            said.put(_packed(("over", 0, None), shared))
    except (EOFError, OSError):
        return


def _send(pipe: Connection, said: SimpleQueue[bytes]) -> None:
    """Hand over what is said: a result is longer than a pipe is, and whoever takes it may be busy for long."""
    while True:
        try:
            pipe.send_bytes(said.get())
        except OSError:  # nobody is left to listen
            os._exit(1)


def _answer(k: int, task: Task | None, said: SimpleQueue[bytes], shared: tuple[object, ...]) -> bytes:
    """What a task comes to, packed, or that it cannot be done here."""
    last = 0.0

    def tell(fraction: float, message: str) -> None:
        # Whoever reads this has other things to do.
        nonlocal last
        if time.monotonic() - last > _SELDOM_S:
            last = time.monotonic()
            said.put(_packed(("told", k, (fraction, message)), shared))

    if task is not None:
        function, arguments = task
        # An error, or what cannot travel, is met again where the task came from.
        with suppress(Exception):
            return _packed(("done", k, function(*arguments, tell)), shared)
    return _packed(("do it yourself", k, None), shared)


def _turns(turn: Turn, count: int) -> Iterator[int]:
    """The numbers below a count that nobody else has taken, one after the other."""
    while True:
        with turn.get_lock():
            k = turn.value
            turn.value = k + 1
        if k >= count:
            return
        yield k


def _packed_tasks(tasks: Sequence[Task], shared: tuple[object, ...]) -> bytes:
    """Tasks packed, None for one that cannot be sent."""
    try:
        return _packed(list(tasks), shared)
    except _CANNOT_TRAVEL:
        return _packed([task if _travels(task, shared) else None for task in tasks], shared)


def _travels(task: Task, shared: tuple[object, ...]) -> bool:
    try:
        _packed(task, shared)
    except _CANNOT_TRAVEL:
        return False
    return True


def _packed(value: object, shared: tuple[object, ...]) -> bytes:
    """A value pickled, what is shared by its number."""
    number = {id(thing): k for k, thing in enumerate(shared)}

    class Packer(pickle.Pickler):
        def persistent_id(self, obj: object) -> int | None:
            return number.get(id(obj))

    out = io.BytesIO()
    Packer(out, protocol=pickle.HIGHEST_PROTOCOL).dump(value)
    return out.getvalue()


def _unpacked(data: bytes, shared: tuple[object, ...]) -> Any:
    class Unpacker(pickle.Unpickler):
        def persistent_load(self, number: Any) -> object:
            return shared[number]

    return Unpacker(io.BytesIO(data)).load()


ALONE = Team(1, ())
"""Nobody helps."""
