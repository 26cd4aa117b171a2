"""Linear algebra held to one thread: an analysis is thousands of small decompositions, which threads slow down."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
T = TypeVar("T")


def one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """The function with one BLAS thread while it runs, also in processes that it forks; as many as before afterwards.

    What is computed does not depend on how many there were: threads sum in another order, and the last figures differ.
    """

    @wraps(function)
    def held(*args: P.args, **kwargs: P.kwargs) -> T:
        with _libraries().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return held


@lru_cache(maxsize=1)
def _libraries() -> ThreadpoolController:
    """The libraries of numpy and scipy; looked for once (8 ms), and set in 0.1 ms from then on."""
    # Loaded before they are looked for: scipy brings a library of its own.
    import scipy.linalg  # noqa: F401

    return ThreadpoolController()
