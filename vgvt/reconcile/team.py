"""Tasks of a round shared with helpers: this process forked once, so that each knows the problem and keeps its own.

What travels is pickled, the problem and the catalogue's hypotheses by name. Whoever does a task, it is the same one:
how many help changes the time and nothing else. Where processes cannot be forked nobody helps.
"""

from __future__ import annotations

import io
import multiprocessing
import pickle
import signal
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, wait
from types import TracebackType
from typing import Any, Self

from vgvt.reconcile.progress import Progress

FORKS = sys.platform.startswith("linux")
"""Whether a process that has loaded numpy may be forked here."""
# Between two words of a helper.
_SELDOM_S = 0.25

Task = tuple[Callable[..., Any], tuple[Any, ...]]


class Team:
    """So many ``workers``: this process and its helpers, each of which has what is ``shared`` and is sent the rest."""

    def __init__(self, workers: int, shared: Sequence[object]) -> None:
        self._shared = tuple(shared)
        self._helpers = [_Helper(self._shared) for _ in range(workers - 1)] if FORKS and _may_have_children() else []

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
        round_ = _Round(tasks, self._helpers, self._shared, tell)
        try:
            return round_.done()
        except BaseException:
            # What a helper still works at nobody waits for.
            for helper in self._helpers:
                helper.dismiss()
            self._helpers = []
            raise


def _may_have_children() -> bool:
    return not multiprocessing.current_process().daemon


class _Round:
    """Tasks being worked off: helpers take from the end, this process from the beginning."""

    def __init__(
        self, tasks: Sequence[Task], helpers: Sequence[_Helper], shared: tuple[object, ...], tell: Progress
    ) -> None:
        self._tasks, self._tell, self._shared = tasks, tell, shared
        self._left, self._here = deque(range(len(tasks))), deque[int]()
        self._helpers = list(helpers)
        self._busy: dict[Connection, tuple[_Helper, int]] = {}
        self._results: dict[int, Any] = {}
        self._shares = [0.0] * len(tasks)

    def done(self) -> list[Any]:
        while self._left or self._here:
            k = self._here.popleft() if self._here else self._left.popleft()
            self._send()
            self._do(k)
            self._hear(0.0)
        while self._busy:
            self._hear(None)
            while self._here:
                self._do(self._here.popleft())
        return [self._results[k] for k in range(len(self._tasks))]

    def _do(self, k: int) -> None:
        function, arguments = self._tasks[k]
        self._results[k] = function(*arguments, lambda fraction, message: self._told(k, fraction, message))
        self._shares[k] = 1.0

    def _told(self, k: int, fraction: float, message: str) -> None:
        self._shares[k] = fraction
        self._tell(sum(self._shares) / len(self._shares), message)
        self._hear(0.0)

    def _send(self) -> None:
        """Give every idle helper a task."""
        busy = {id(helper) for helper, _ in self._busy.values()}
        for helper in [h for h in self._helpers if id(h) not in busy]:
            if not self._left:
                return
            k = self._left.pop()
            try:
                helper.pipe.send_bytes(_packed(self._tasks[k], self._shared))
            except (pickle.PicklingError, AttributeError, TypeError):
                self._here.append(k)
            except OSError:
                self._here.append(k)
                self._helpers.remove(helper)
            else:
                self._busy[helper.pipe] = (helper, k)

    def _hear(self, patience_s: float | None) -> None:
        """Take in all that helpers have said; with None wait until one says something."""
        ready = wait(list(self._busy), patience_s)
        while ready:
            for pipe in ready:
                assert isinstance(pipe, Connection)
                self._take(pipe)
            ready = wait(list(self._busy), 0.0)

    def _take(self, pipe: Connection) -> None:
        """One message, and another task for whoever is done with one."""
        helper, k = self._busy[pipe]
        try:
            kind, value = _unpacked(pipe.recv_bytes(), self._shared)
        except (EOFError, OSError):
            # A helper that died, of memory as a rule, has its task done here.
            del self._busy[pipe]
            self._helpers.remove(helper)
            self._here.append(k)
            return
        if kind == "told":
            self._shares[k] = value[0]
            self._tell(sum(self._shares) / len(self._shares), value[1])
            return
        del self._busy[pipe]
        if kind == "done":
            self._results[k], self._shares[k] = value, 1.0
        else:
            self._here.append(k)
        self._send()


class _Helper:
    """A forked process and the pipe to it."""

    def __init__(self, shared: tuple[object, ...]) -> None:
        context = multiprocessing.get_context("fork")
        self.pipe, other = context.Pipe()
        self._process = context.Process(target=_help, args=(other, self.pipe, shared), daemon=True)
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


def _help(pipe: Connection, others_end: Connection, shared: tuple[object, ...]) -> None:
    """What a helper does all its life: tasks, one after the other, until nobody is there to send one."""
    # Ctrl-C is for the process that was started: it dismisses its helpers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    others_end.close()
    last = 0.0
    try:
        while True:
            function, arguments = _unpacked(pipe.recv_bytes(), shared)

            def tell(fraction: float, message: str) -> None:
                # Whoever reads this is busy: a pipe full of it would stop the work.
                nonlocal last
                if time.monotonic() - last > _SELDOM_S:
                    last = time.monotonic()
                    pipe.send_bytes(_packed(("told", (fraction, message)), shared))

            try:
                packed = _packed(("done", function(*arguments, tell)), shared)
            except OSError:
                raise
            except Exception:  # noqa: BLE001 - an error, or what cannot travel, is met again where the task came from
                packed = _packed(("do it yourself", None), shared)
            pipe.send_bytes(packed)
    except (EOFError, OSError):
        return


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
