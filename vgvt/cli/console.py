"""Words and progress for people: logs and bars on stderr, tables on stdout."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from vgvt.cli import interruption

if TYPE_CHECKING:
    from rich.console import RenderableType

ProgressReport = Callable[[float, str], None]

_SECONDS_BETWEEN_LINES = 10.0


def log(message: str) -> None:
    """Write one line to stderr; one that cannot be written is lost, and nothing else."""
    with suppress(OSError, ValueError):
        sys.stderr.write(f"{message}\n")
        sys.stderr.flush()


def show(*renderables: RenderableType) -> None:
    """Write tables and text to stdout, as wide as the terminal (120 columns where there is none)."""
    from rich.console import Console
    from rich.text import Text

    console = Console(file=sys.stdout, width=None if sys.stdout.isatty() else 120, highlight=False)
    # Rendered first and written in one go, so that a closed pipe is an ordinary OSError.
    with console.capture() as capture:
        for renderable in renderables:
            # As Text, square brackets in names and paths stay what they are.
            console.print(Text(renderable) if isinstance(renderable, str) else renderable)
    sys.stdout.write(capture.get())


def bullets(lines: Iterable[str]) -> RenderableType:
    """Lines of text as a list, each with a dash; what folds stays right of the dashes."""
    from rich.table import Table
    from rich.text import Text

    listed = Table.grid(padding=(0, 1, 0, 0))
    for line in lines:
        # As Text, square brackets in names and paths stay what they are.
        listed.add_row("  -", Text(line))
    return listed


@contextmanager
def progress(title: str) -> Iterator[ProgressReport]:
    """A function (fraction, message) that shows how far a long piece of work is.

    On a terminal a bar with the time left; elsewhere a line every ten seconds.
    """
    if sys.stderr.isatty():
        with _bar(title) as report:
            yield _interruptible(report)
    else:
        yield _interruptible(_lines(title))


@contextmanager
def waiting(title: str) -> Iterator[Callable[[str], None]]:
    """A function (message) that says what work is at that cannot say how far it is.

    On a terminal a line with the time so far; elsewhere one every ten seconds.
    """
    said = [""]

    def say(message: str) -> None:
        interruption.raise_if_asked()
        said[0] = message

    with _spinner(title, said) if sys.stderr.isatty() else _repeated(title, said):
        yield say


@contextmanager
def _spinner(title: str, said: list[str]) -> Iterator[None]:
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn, SpinnerColumn, Task, TimeElapsedColumn
    from rich.text import Text

    class Said(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(f"{title}: {said[0]}")

    with Progress(SpinnerColumn(), Said(), TimeElapsedColumn(), console=Console(stderr=True), transient=True) as bar:
        bar.add_task(title, total=None)
        yield


@contextmanager
def _repeated(title: str, said: list[str]) -> Iterator[None]:
    start, done = time.monotonic(), threading.Event()

    def repeat() -> None:
        while not done.wait(_SECONDS_BETWEEN_LINES):
            log(f"{title}: {said[0]}, {time.monotonic() - start:.0f} s so far")

    thread = threading.Thread(target=repeat, name="say what is going on", daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _interruptible(report: ProgressReport) -> ProgressReport:
    def checked(fraction: float, message: str) -> None:
        interruption.raise_if_asked()
        report(fraction, message)

    return checked


@contextmanager
def _bar(title: str) -> Iterator[ProgressReport]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TextColumn("took"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=1.0)

        def report(fraction: float, message: str) -> None:
            bar.update(task, completed=fraction, description=f"{title}: {message}" if message else title)

        yield report


def _lines(title: str) -> ProgressReport:
    start = time.monotonic()
    last = start

    def report(fraction: float, message: str) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < _SECONDS_BETWEEN_LINES:
            return
        last = now
        left = (now - start) * (1 - fraction) / fraction if fraction > 0 else float("nan")
        log(f"{title}: {message} {100 * fraction:.0f} %" + (f", {left:.0f} s left" if left == left else ""))

    return report
