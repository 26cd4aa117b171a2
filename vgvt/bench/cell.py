"""One cell of the bench: a scenario with a seed, simulated once and put before every identifier."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any

from vgvt.bench.entry import Entry
from vgvt.bench.rows import failure_row, score_rows
from vgvt.bench.umpire import Limits, attempt, handed_out
from vgvt.data import Campaign, FrequencyResponseSet, FrfFit, InputError, ModalModel, PluginError
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream
from vgvt.signals import estimate_frf
from vgvt.simulation.campaign import simulate
from vgvt_scoreboard import score, validate

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Cell:
    """A scenario (with seed and engine written in), the number of the seed, and the entries to try on it.

    Everything that a worker on another machine needs to know is in it.
    """

    scenario: Scenario
    seed_number: int
    entries: tuple[Entry, ...]
    limits: Limits
    band_hz: tuple[float, float] | None = None

    @property
    def key(self) -> str:
        """A hash of all that the result depends on, code aside."""
        text = json.dumps(
            [
                self.scenario.model_dump(mode="json"),
                [e.label for e in self.entries],
                [self.limits.time_s, self.limits.memory_mib],
                self.band_hz,
            ],
            sort_keys=True,
        )
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def title(self) -> str:
        """The cell in words, for progress."""
        return f"{self.scenario.name}, seed {self.seed_number}"


def derived_seed(base: int, scenario: str, number: int) -> int:
    """The seed of the ``number``-th campaign of a scenario: it depends on these three and nothing else."""
    return int(named_stream(base, "bench", scenario, number).integers(2**31))


def seeded(scenario: Scenario, base: int, number: int, engine: str | None) -> Scenario:
    """The scenario with its derived seed, and with another engine where one is given."""
    changes: dict[str, Any] = {"seed": derived_seed(base, scenario.name, number)}
    if engine is not None:
        changes["simulation"] = scenario.simulation.model_copy(update={"engine": engine})
    return scenario.model_copy(update=changes)


def run_cell(cell: Cell) -> list[Row]:
    """The rows of a cell: one per entry and mode, one for an entry that came to nothing.

    Never raises for what an identifier does; a scenario that cannot be simulated makes one row per entry.
    """
    common: Row = {"scenario": cell.scenario.name, "seed_number": cell.seed_number, "seed": cell.scenario.seed}
    try:
        result = simulate(cell.scenario)
    except (InputError, PluginError, RuntimeError) as error:
        reason = f"simulation failed: {str(error).splitlines()[0]}"
        return [failure_row(common, entry, reason) for entry in cell.entries]
    band = cell.band_hz or result.campaign.band_hz
    measured = _measured(result.campaign)
    rows: list[Row] = []
    with handed_out(result.campaign) as file:
        for entry in cell.entries:
            tried = attempt(entry, file, band, cell.limits)
            cost = {"wall_s": tried.wall_s, "peak_memory_mib": tried.peak_memory_mib}
            if tried.claim is None:
                rows.append(failure_row(common | cost, entry, tried.reason))
                continue
            try:
                card = score(result.truth, tried.claim, band, cell.scenario.name, entry.label)
            except InputError as error:
                rows.append(failure_row(common | cost, entry, f"cannot be scored: {str(error).splitlines()[0]}"))
                continue
            rows += score_rows(common | cost, entry, card, _fit(measured, tried.claim, band))
    return rows


def _measured(campaign: Campaign) -> FrequencyResponseSet | None:
    """The responses that claims are held against, estimated once for all of them; None without a force."""
    try:
        return estimate_frf(campaign, "auto")
    except InputError:
        return None


def _fit(measured: FrequencyResponseSet | None, claim: ModalModel, band_hz: tuple[float, float]) -> FrfFit | None:
    """How the claim's responses meet the measured ones; None where it states no residues."""
    try:
        return None if measured is None else validate(measured, claim, band_hz)
    except InputError:
        return None
