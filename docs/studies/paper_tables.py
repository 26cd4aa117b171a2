"""The first paper's tables: ``python docs/studies/paper_tables.py`` fills docs/studies/paper-tables.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from command_line import BEGIN_AGAIN, parser_of, worked_off
from paper_claims import CLAIMED, Claimed
from unequal_wings import unequal_wings
from virtual_lab import PAGES, nearest, table, write_results

from vgvt.data import ModalModel, Scorecard, Truth, modal_assurance
from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import load_scenario
from vgvt.simulation import simulate
from vgvt_scoreboard import merge_truth, score

TESTS = ("skoll-gvt1", "skoll-gvt2", "hati-symmetric", "hati-unsymmetric")
METHODS = ("quadrature", "cfdd")
POLES = "plscf"
"""A method that fits poles to all responses and needs no peak, for comparison."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """One virtual test: the score of every method, and how much each true mode raises the sigma plot, in dB.

    ``torsion_hz`` is the lowest torsion mode of the aircraft as tested in its first run. ``poles`` has a row for each
    true mode in the band: label, true Hz, Hz and damping ratio of the nearest pole that was fitted, and the MAC.
    """

    name: str
    cards: dict[str, Scorecard]
    rise_db: dict[str, float]
    torsion_hz: float
    poles: list[tuple[str, float, float | None, float | None, float | None]]


def judge(name: str) -> Judged:
    """Simulate a bundled test by the linear engine, identify and score it."""
    test = simulate(load_scenario(name), engine="linear")
    band = test.campaign.band_hz
    cards = {}
    for method in METHODS:
        claim = run_identifier(make_identifier(method), test.campaign)
        cards[method] = score(test.truth, claim, band)
    first = test.truth.as_tested[0]
    lowest = min(f for f, kind in zip(first.natural_frequency_hz, first.labels, strict=True) if "torsion" in kind)
    fitted = run_identifier(make_identifier(POLES), test.campaign)
    return Judged(name, cards, rises(first, band), float(lowest), nearest_poles(test.truth, fitted, band))


def nearest_poles(
    truth: Truth, claim: ModalModel, band_hz: tuple[float, float]
) -> list[tuple[str, float, float | None, float | None, float | None]]:
    """Rows of :class:`Judged`: for each true mode in the band the pole nearest to it, whatever its shape."""
    true = merge_truth(truth).model.band(*band_hz)
    true = true.at(tuple(d for d in claim.dofs if d in true.dofs))
    rows: list[tuple[str, float, float | None, float | None, float | None]] = []
    for k, (label, hertz) in enumerate(zip(true.labels, true.natural_frequency_hz, strict=True)):
        j = nearest(claim, float(hertz), within=0.01)
        if j is None:
            rows.append((label, float(hertz), None, None, None))
        else:
            mac = modal_assurance(true.shapes[[k]], claim.at(true.dofs).shapes[[j]])[0, 0]
            found = float(claim.natural_frequency_hz[j])
            rows.append((label, float(hertz), found, float(claim.damping_ratio[j]), float(mac)))
    return rows


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
    head: tuple[str, ...] = ("mode", "true, Hz", "rise, dB")
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


def poles(judged: list[Judged]) -> str:
    """What the method that fits poles says, mode by mode, of the tests of Hati."""
    rows = []
    for test in judged:
        for label, true_hz, found_hz, ratio, mac in test.poles if test.name.startswith("hati") else ():
            cells = ["–", "", "", ""]
            if found_hz is not None and ratio is not None and mac is not None:
                error = 100 * (found_hz / true_hz - 1)
                cells = [f"{found_hz:.4f}", f"{error:+.4f}", f"{100 * ratio:.2f}", f"{mac:.3f}"]
            rows.append([f"`{test.name}`", label, f"{true_hz:.4f}", *cells])
    return table(("test", "mode", "true, Hz", f"{POLES}, Hz", "error, %", "ζ, %", "MAC"), rows)


def paper_modes(judged: list[Judged]) -> str:
    """The paper's modes one by one, beside the true mode of that kind and what both methods make of it in that test."""
    tests = {test.name: test for test in judged}
    rows = [_paper_mode(claimed, tests) for claimed in CLAIMED]
    said = ("mode", "kind, in the paper's words", "quadrature, Hz", "CFDD, Hz")
    here = ("virtual mode of that kind", "true, Hz", "paper against it, %", "quadrature / cfdd here, Hz")
    return table((*said, *here), rows)


def _paper_mode(claimed: Claimed, tests: dict[str, Judged]) -> list[str]:
    row = [f"{claimed.aircraft} {claimed.number}", claimed.kind]
    row += ["–" if said is None else f"{said[0]} (`{said[1]}`)" for said in (claimed.quadrature, claimed.cfdd)]
    said = claimed.cfdd or claimed.quadrature
    if said is None:
        raise RuntimeError(f"{claimed.aircraft} {claimed.number}: neither method states it")
    test = tests[said[1]]
    if not claimed.counterpart:
        kind = f"none (torsion begins at {test.torsion_hz:.2f} Hz)" if claimed.kind == "torsion" else "none near"
        return [*row, kind, "", "", "–"]
    true = next(((f, z) for label, f, z in _true_modes(test.cards[METHODS[0]]) if label == claimed.counterpart), None)
    if true is None:
        raise RuntimeError(f"{claimed.counterpart} is not in {test.name}")
    found = [_cells(test.cards[method], claimed.counterpart, true[1])[0] for method in METHODS]
    off = f"{100 * (float(said[0]) / true[0] - 1):+.1f}"
    return [*row, claimed.counterpart, f"{true[0]:.3f}", off, " / ".join(found)]


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


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, on which there is nothing to choose."""
    return parser_of(__doc__).parse_args(words)


def fill() -> None:
    """Judge, and fill the page."""
    page, tests = PAGES / "paper-tables.md", [judge(name) for name in TESTS]
    told = {
        "of the script": results(tests),
        "of the poles": poles(tests),
        "of the paper": paper_modes(tests),
        "of unequal wings": unequal_wings(),
    }
    for part, text in told.items():
        write_results(page, text, part)


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    arguments(words)
    return worked_off(fill, BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
