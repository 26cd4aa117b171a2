"""The bench: every scenario with every seed before every entry, resumable, as one long table."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from vgvt.bench.cell import Cell, run_cell, seeded
from vgvt.bench.completion import in_order_of_completion
from vgvt.bench.entry import Entry
from vgvt.bench.executors import MakeExecutor
from vgvt.bench.fingerprint import fingerprint
from vgvt.bench.resume import left_to_do
from vgvt.bench.store import Store
from vgvt.bench.table import table_of
from vgvt.bench.umpire import Limits
from vgvt.data import InputError
from vgvt.scenario.model import Scenario

if TYPE_CHECKING:
    import pandas

Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True)
class BenchPlan:
    """What to bench: scenarios, how many seeds each, entries, limits.

    ``engine`` None leaves each scenario its own; ``base_seed`` starts the seeds, which derive from it
    and the scenario's name. ``band_hz`` None is each campaign's excited band. InputError for scenarios of one name:
    nothing else tells their campaigns apart.
    """

    scenarios: tuple[Scenario, ...]
    seeds: int
    entries: tuple[Entry, ...]
    limits: Limits
    base_seed: int = 0
    engine: str | None = "linear"
    band_hz: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name, count in Counter(scenario.name for scenario in self.scenarios).items():
            if count > 1:
                raise InputError(
                    f"scenario {name!r}",
                    f"{count} scenarios of this bench are called so",
                    "name each once; give a changed copy a name of its own",
                )

    def cells(self) -> list[Cell]:
        """The cells, seed by seed, so that an interrupted bench has seen every scenario."""
        return [
            Cell(seeded(scenario, self.base_seed, number, self.engine), number, self.entries, self.limits, self.band_hz)
            for number in range(self.seeds)
            for scenario in self.scenarios
        ]


def bench(
    plan: BenchPlan, folder: Path, make_executor: MakeExecutor | None = None, progress: Progress | None = None
) -> pandas.DataFrame:
    """Work the plan off and return the long table; what the same code has done already in ``folder`` is not done again.

    Entries that ran out of time are, when all else is done. The table is the same for any executor, these and the
    columns ``vgvt.bench.rows.MEASURED`` apart.
    ``progress(fraction, message)`` is called before the first cell and after each.
    """
    store = Store(folder, fingerprint(plan.entries))
    cells = plan.cells()
    rows, left = left_to_do(cells, store)
    parts = {part.cell.key: part for part in left}
    report = _Reporter(progress, len(cells), len(cells) - len(left))
    report("")
    for cell, fresh in in_order_of_completion([part.cell for part in left], make_executor, run_cell):
        part = parts[cell.key]
        done = [*part.kept, *fresh]
        store.keep(part.whole, done)
        rows += done
        report.done += 1
        report(cell.title)
    return table_of(rows)


@dataclass(slots=True)
class _Reporter:
    """Turns the count of cells into progress with the time left."""

    progress: Progress | None
    total: int
    done: int

    def __post_init__(self) -> None:
        self._start, self._before = time.monotonic(), self.done

    _start: float = 0.0
    _before: int = 0

    def __call__(self, title: str) -> None:
        if self.progress is None:
            return
        fresh = self.done - self._before
        left = ""
        if fresh and self.done < self.total:
            seconds = (time.monotonic() - self._start) / fresh * (self.total - self.done)
            left = f", about {_in_words(seconds)} left"
        words = f"{self.done} of {self.total} campaigns{left}" + (f"; {title}" if title else "")
        self.progress(self.done / max(self.total, 1), words)


def _in_words(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def failures(table: pandas.DataFrame) -> pandas.DataFrame:
    """The rows of entries that came to no claim at all, with their reasons."""
    return table[table["outcome"] == "failed"]


def entries_of(texts: Sequence[str]) -> tuple[Entry, ...]:
    """Entries from their texts, each once, in order."""
    return tuple(dict.fromkeys(Entry.parse(text) for text in texts))
