"""Work shared with forked helpers: the same results in the same order, and nobody left behind when something fails."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.reconcile.work import team as module
from vgvt.reconcile.work.progress import silent
from vgvt.reconcile.work.team import ALONE, FORKS, Team

pytestmark = pytest.mark.skipif(not FORKS, reason="no process is forked here")

Tell = Callable[[float, str], None]


class Known:
    """Something that is not to be copied."""

    def __init__(self) -> None:
        self.local = lambda: None  # cannot be pickled


def who(number: int, tell: Tell) -> tuple[int, int]:
    for share in (0.2, 0.6):
        time.sleep(0.3)
        tell(share, f"task {number}")
    return number, os.getpid()


def handed_back(thing: object, tell: Tell) -> object:
    time.sleep(0.1)
    AT_HOME.append(os.getpid())
    return [thing]


def unfit_to_travel(tell: Tell) -> object:
    time.sleep(0.1)
    return lambda: None


AT_HOME: list[int] = []  # every process has its own


def slow(tell: Tell) -> None:
    for k in range(60):
        time.sleep(0.02)
        tell(k / 60, "slow")


def failing(tell: Tell) -> None:
    """With an error that cannot travel: it is made of more than its message."""
    time.sleep(0.1)
    raise InputError("effect", "there is no such number", "write another one")


def dying_elsewhere(home: int, tell: Tell) -> int:
    time.sleep(0.1)
    if os.getpid() != home:
        os._exit(9)
    return os.getpid()


def test_two_share_the_work_and_keep_its_order() -> None:
    with Team(2, ()) as team:
        found = team.work_off([(who, (k,)) for k in range(5)], silent)
    assert [k for k, _ in found] == list(range(5))
    assert len({pid for _, pid in found}) == 2
    assert {pid for _, pid in ALONE.work_off([(who, (1,)), (who, (2,))], silent)} == {os.getpid()}


def test_whoever_is_done_takes_the_next() -> None:
    """While this process is at its first task, a helper does the rest, if that is soon done."""
    AT_HOME.clear()
    with Team(2, ()) as team:
        found = team.work_off([(slow, ()), *[(handed_back, (k,)) for k in range(3)]], silent)
    assert found[1:] == [[0], [1], [2]]
    assert AT_HOME == []


def test_progress_is_of_all_and_never_falls() -> None:
    told: list[tuple[float, str]] = []
    with Team(2, ()) as team:
        team.work_off([(who, (k,)) for k in range(4)], lambda f, m: told.append((f, m)))
    shares = [f for f, _ in told]
    assert shares == sorted(shares)
    assert {m for _, m in told} == {f"task {k}" for k in range(4)}


def test_what_is_shared_is_not_copied() -> None:
    known, other = Known(), Known()
    with Team(2, (known, other)) as team:
        found = team.work_off([(handed_back, (x,)) for x in (known, other, known, other)], silent)
    assert [x[0] for x in found] == [known, other, known, other]


def test_what_cannot_travel_is_done_here() -> None:
    with Team(2, ()) as team:
        assert all(callable(f) for f in team.work_off([(unfit_to_travel, ())] * 4, silent))
        # Not the known one: it cannot be sent either.
        assert len(team.work_off([(handed_back, (Known(),))] * 3, silent)) == 3


def test_an_error_of_a_helper_is_the_error_that_there_would_be_without_and_the_helper_goes() -> None:
    with Team(2, ()) as team:
        with pytest.raises(InputError, match="no such number"):
            team.work_off([(who, (1,)), (failing, ())], silent)
        assert not multiprocessing.active_children()
        assert [k for k, _ in team.work_off([(who, (k,)) for k in range(3)], silent)] == [0, 1, 2]


def test_a_helper_that_dies_leaves_its_task() -> None:
    with Team(2, ()) as team:
        found = team.work_off([(dying_elsewhere, (os.getpid(),))] * 4, silent)
    assert found == [os.getpid()] * 4


def chatting(words: int, tell: Tell) -> float:
    """Seconds that it took to say a lot."""
    started = time.monotonic()
    for k in range(words):
        tell(k / words, "much ado " * 20)
    return time.monotonic() - started


def silent_for_long(tell: Tell) -> tuple[float, bytes]:
    time.sleep(1.5)
    return 0.0, b""


def test_a_helper_that_has_much_to_say_does_not_wait_for_a_listener() -> None:
    with Team(2, ()) as team:
        _, took = team.work_off([(silent_for_long, ()), (chatting, (5000,))], silent)
    assert took < 0.7


def long_answer(words: int, tell: Tell) -> tuple[float, bytes]:
    """When it began, and more than a pipe holds."""
    return time.monotonic(), bytes(words)


def test_a_helper_goes_on_while_nobody_listens() -> None:
    """Neither for its next task nor for its result to be taken does it wait for this process."""
    with Team(2, ()) as team:
        started = time.monotonic()
        _, *answers = team.work_off([(silent_for_long, ()), *[(long_answer, (3_000_000,))] * 4], silent)
    assert all(began - started < 0.7 for began, _ in answers)
    assert {len(words) for _, words in answers} == {3_000_000}


def test_what_tasks_have_in_common_travels_once() -> None:
    common = [1.0]
    with Team(2, ()) as team:
        found = team.work_off([(silent_for_long, ()), *[(whose, (common,))] * 3], silent)
    assert len({thing for thing, _ in found[1:]}) == 1
    assert all(pid != os.getpid() for _, pid in found[1:])


def whose(thing: object, tell: Tell) -> tuple[int, int]:
    return id(thing), os.getpid()


def test_without_memory_to_share_nobody_helps(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*given: object) -> None:
        raise OSError("function not implemented")

    monkeypatch.setattr(module._FORK, "Value", none)
    with Team(2, ()) as team:
        assert team.workers == 1
        assert [k for k, _ in team.work_off([(who, (k,)) for k in range(2)], silent)] == [0, 1]


def test_nobody_stays() -> None:
    with Team(3, ()) as team:
        team.work_off([(who, (k,)) for k in range(3)], silent)
    assert not multiprocessing.active_children()


def test_helpers_of_a_process_that_was_killed_end_too(tmp_path: Path) -> None:
    """Each inherits the pipes to those before it: they end one after the other."""
    code = (
        "import os, pathlib, signal, sys, time\n"
        "from vgvt.reconcile.work.team import Team\n"
        "team = Team(4, ())\n"
        "pathlib.Path(sys.argv[1]).write_text(' '.join(str(h._process.pid) for h in team._helpers))\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "helpers")], check=False)
    helpers = [Path("/proc") / pid for pid in (tmp_path / "helpers").read_text(encoding="utf-8").split()]
    assert len(helpers) == 3
    until = time.monotonic() + 10
    while any(_runs(h) for h in helpers) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(_runs(h) for h in helpers)


def _runs(process: Path) -> bool:
    """Whether a process is there and not merely waiting to be counted."""
    try:
        return ") Z " not in (process / "stat").read_text(encoding="utf-8")
    except OSError:
        return False
