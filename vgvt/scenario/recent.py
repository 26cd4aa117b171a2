"""The last few answers of a function, known again by their argument being the same object.

A scenario is large: to tell that two are equal, or to hash one, takes as long as much of what is asked of it, and a fit
asks for many things of one object and of thousands of others.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Generic, TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")


class Recent(Generic[Key, Value]):
    """``make`` with its last ``count`` answers kept. To be read, not changed: whoever asks again gets the same one."""

    def __init__(self, make: Callable[[Key], Value], count: int = 8) -> None:
        self._make = make
        # The arguments are kept, too: an object's identity is its own for as long as it lives.
        self._known: deque[tuple[Key, Value]] = deque(maxlen=count)

    def __call__(self, key: Key) -> Value:
        """The answer for an argument, made where it is not one of the last."""
        # A copy: another thread may add to them meanwhile.
        for known, value in tuple(self._known):
            if known is key:
                return value
        value = self._make(key)
        self._known.append((key, value))
        return value
