"""Linear algebra of an analysis in one thread, whatever a caller's environment says."""

from __future__ import annotations

import inspect
import os
import time
from collections.abc import Callable

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from vgvt.reconcile import attribute, calibrate, fit, localise, power, reconcile, screen, suggest
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import silent
from vgvt.reconcile.work.team import FORKS, Team

Tell = Callable[[float, str], None]


def threads() -> set[int]:
    return {found["num_threads"] for found in threadpool_info() if found["user_api"] == "blas"}


def threads_of(number: int, tell: Tell) -> tuple[set[int], int]:
    time.sleep(0.2)
    return threads(), os.getpid()


def test_a_function_has_one_thread_and_its_caller_as_many_as_before() -> None:
    with threadpool_limits(2):
        assert threads() == {2}
        assert one_thread(threads)() == {1}
        assert threads() == {2}


def test_they_are_as_many_as_before_after_an_error_too() -> None:
    @one_thread
    def fails() -> None:
        raise ValueError(threads())

    with threadpool_limits(2):
        with pytest.raises(ValueError, match=r"\{1\}"):
            fails()
        assert threads() == {2}


@pytest.mark.skipif(not FORKS, reason="no process is forked here")
def test_forked_helpers_have_one_thread_each() -> None:
    @one_thread
    def shared() -> list[tuple[set[int], int]]:
        with Team(2, ()) as team:
            return team.work_off([(threads_of, (k,)) for k in range(4)], silent)

    with threadpool_limits(2):
        found = shared()
    assert [each for each, _ in found] == [{1}] * 4
    assert len({pid for _, pid in found}) == 2


@pytest.mark.parametrize("step", [reconcile, calibrate, fit, screen, attribute, localise, suggest, power])
def test_each_step_that_computes_for_long_is_held(step: Callable[..., object]) -> None:
    """Given what tells, at the first look at it, how many threads there are."""

    class Asked:
        def __getattribute__(self, name: str) -> object:
            raise LookupError(threads())

        def __len__(self) -> int:
            raise LookupError(threads())

    needed = [p for p in inspect.signature(step).parameters.values() if p.default is p.empty]
    with threadpool_limits(2), pytest.raises(LookupError, match=r"\{1\}"):
        step(*(Asked() for _ in needed))
