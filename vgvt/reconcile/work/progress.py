"""Progress of nested work: a share done and what is being done, and how a part of the work tells it."""

from __future__ import annotations

from collections.abc import Callable

from vgvt.reconcile.question.hypothesis import Hypothesis

Progress = Callable[[float, str], None]


def silent(fraction: float, message: str) -> None:
    """Tells nobody."""


def part(tell: Progress, start: float, stop: float) -> Progress:
    """Progress of a part of the work."""

    def inner(fraction: float, message: str) -> None:
        tell(start + (stop - start) * fraction, message)

    return inner


def naming(tell: Progress, hypothesis: Hypothesis) -> Progress:
    """Progress that says which candidate is fitted."""
    return lambda fraction, message: tell(fraction, f"{message} {hypothesis.name}")
