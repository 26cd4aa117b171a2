"""The first paper's tables: ``python docs/studies/paper_tables.py`` fills docs/studies/paper-tables.md."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from virtual_lab import PAGES, table, write_results

from vgvt.data import ModalModel, Scorecard
from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import load_scenario
from vgvt.simulation import simulate
from vgvt_scoreboard import score

TESTS = ("skoll-gvt1", "skoll-gvt2", "hati-symmetric", "hati-unsymmetric")
METHODS = ("quadrature", "cfdd")


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """One virtual test: the score of every method, and how much each true mode raises the sigma plot, in dB."""

    name: str
    cards: dict[str, Scorecard]
    rise_db: dict[str, float]


def judge(name: str) -> Judged:
    """Simulate a bundled test by the linear engine, identify and score it."""
    test = simulate(load_scenario(name), engine="linear")
    band = test.campaign.band_hz
    cards = {}
    for method in METHODS:
        claim = run_identifier(make_identifier(method), test.campaign)
        cards[method] = score(test.truth, claim, band)
    return Judged(name, cards, rises(test.truth.as_tested[0], band))


def rises(modes: ModalModel, band_hz: tuple[float, float]) -> dict[str, float]:
    """By how many dB a mode raises the sigma plot of the first run's structure at its own frequency, by label."""
    if modes.residues is None:
        raise RuntimeError("the truth states no residues")
    found = {}
    for k, (hertz, label) in enumerate(zip(modes.natural_frequency_hz, modes.labels, strict=True)):
        if band_hz[0] <= hertz <= band_hz[1]:
            s = 2j * np.pi * hertz
            upper = modes.residues[:, :, 0] / (s - modes.poles)[:, None]
            lower = modes.residues[:, :, 0].conj() / (s - modes.poles.conj())[:, None]
            terms = upper + lower
            whole, rest = terms.sum(axis=0), np.delete(terms, k, axis=0).sum(axis=0)
            found[label] = float(10 * np.log10((np.abs(whole) ** 2).sum() / (np.abs(rest) ** 2).sum()))
    return found


def results(judged: list[Judged]) -> str:
    """The tables of the page."""
    head = ("mode", "true, Hz", "rise, dB")
    for method in METHODS:
        head = (*head, f"{method}, Hz", "error, %", "ζ, true / found, %", "MAC")
    parts = []
    for test in judged:
        rows = []
        first = test.cards[METHODS[0]]
        for label, true_hz, true_ratio in _true_modes(first):
            row = [label, f"{true_hz:.3f}", f"{test.rise_db[label]:.1f}"]
            for method in METHODS:
                row += _cells(test.cards[method], label, true_ratio)
            rows.append(row)
        false = "; ".join(f"{m}: {_false(test.cards[m])}" for m in METHODS)
        parts.append(f"**{test.name}**\n\n{table(head, rows)}\n\nClaims that fit no true mode: {false}.")
    return "\n\n".join(parts)


def _true_modes(card: Scorecard) -> list[tuple[str, float, float]]:
    rows = [m for m in (*card.modes, *card.unreached) if m.true_hz is not None and m.true_damping_ratio is not None]
    inside = [m for m in rows if card.band_hz[0] <= m.true_hz <= card.band_hz[1]]  # type: ignore[operator]
    return sorted(((str(m.label), float(m.true_hz or 0), float(m.true_damping_ratio or 0)) for m in inside), key=_hertz)


def _hertz(mode: tuple[str, float, float]) -> float:
    return mode[1]


def _cells(card: Scorecard, label: str, true_ratio: float) -> list[str]:
    for mode in card.modes:
        if mode.label == label and mode.claimed_hz is not None and mode.mac is not None:
            ratios = f"{100 * true_ratio:.2f} / {100 * (mode.claimed_damping_ratio or np.nan):.2f}"
            return [f"{mode.claimed_hz:.3f}", f"{mode.frequency_error_percent:+.3f}", ratios, f"{mode.mac:.3f}"]
    return ["–", "", "", ""]


def _false(card: Scorecard) -> str:
    claimed = [f"{m.claimed_hz:.3f} Hz" for m in card.modes if m.true_hz is None and m.claimed_hz is not None]
    return ", ".join(claimed) or "none"


if __name__ == "__main__":
    write_results(PAGES / "paper-tables.md", results([judge(name) for name in TESTS]))
