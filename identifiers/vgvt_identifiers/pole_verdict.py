"""Which fitted poles are modes of the structure: evidence, share, damping, band, sign at the drive point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.drifting_poles import RunStates
from vgvt_identifiers.pole_covariance import pole_deviations
from vgvt_identifiers.pole_fit import PoleProblem
from vgvt_identifiers.pole_search import least_fall

DOUBTFUL_DEVIATION = 0.1
"""Standard deviation of a damping ratio over the ratio, above which a claim says that it is poorly known."""
ONE_FLANK = "the band ends inside its half-power width: only one flank is seen"
_WRONG_SHARE = 0.3  # of the largest residue, by which a drive point must answer with the wrong sign


@dataclass(frozen=True, slots=True)
class VerdictRules:
    """What a pole must show to be claimed.

    ``false_alarm``: chance that noise alone brings a pole in. ``least_share``: of the response at its
    own frequency, below which small errors of the instruments or of linearity could be the
    pole. ``largest_deviation``: standard deviation of its damping over the damping.
    """

    false_alarm: float = 1e-3
    least_share: float = 2e-3
    largest_deviation: float = 0.25
    largest_damping_ratio: float = 0.3


@dataclass(frozen=True, slots=True)
class Verdict:
    """The fate of one pole: claimed as a mode, kept in the fit as background, or dropped, and why in words."""

    claimed: bool
    kept: bool
    reason: str


def judge_poles(
    problems: tuple[PoleProblem, ...], states: RunStates, band_hz: tuple[float, float], rules: VerdictRules
) -> tuple[Verdict, ...]:
    """A verdict for every common pole."""
    needed = least_fall(problems, rules.false_alarm, transient=False)
    gain, share = states.gain, pole_share(problems, states)
    std_hz, std_ratio = pole_deviations(states.poles, states.pooled_covariance)
    verdicts = []
    for i, pole in enumerate(states.poles):
        hertz, ratio = float(abs(pole)) / (2 * np.pi), float(-pole.real / abs(pole))
        evidence = f"evidence {_number(gain[i] / 2)} nats, noise alone reaches {needed / 2:.0f}"
        known = f"damping known within {_number(100 * std_ratio[i] / ratio)} %"
        if not gain[i] > needed:
            verdicts.append(Verdict(False, False, f"{evidence}: noise explains it"))
        elif share[i] < rules.least_share:
            why = f"{100 * share[i]:.2g} % of the response at its frequency: less than an imperfect rig may add"
            verdicts.append(Verdict(False, False, why))
        elif ratio > rules.largest_damping_ratio:
            verdicts.append(Verdict(False, True, f"damping ratio {ratio:.2g}: background, no resonance"))
        elif not band_hz[0] <= hertz <= band_hz[1]:
            verdicts.append(Verdict(False, True, "outside the band: background"))
        elif not band_hz[0] <= hertz * (1 - ratio) < hertz * (1 + ratio) <= band_hz[1]:
            verdicts.append(Verdict(False, True, ONE_FLANK))
        elif std_ratio[i] > rules.largest_deviation * ratio or std_hz[i] > hertz * ratio:
            verdicts.append(Verdict(False, True, f"{evidence}, but {known} only"))
        else:
            verdicts.append(Verdict(True, True, f"{evidence}; {known}; {100 * min(share[i], 1):.0f} % of the response"))
    return tuple(verdicts)


def _number(value: float) -> str:
    """Three digits without an exponent below a million."""
    return f"{value:.0f}" if 100 <= value < 1e6 else f"{value:.3g}"


def pole_share(problems: tuple[PoleProblem, ...], states: RunStates) -> NDArray[np.float64]:
    """Height (N,) of each mode alone over the fitted response at the nearest line, over all rows and runs."""
    alone, total = np.zeros(states.poles.size), np.zeros(states.poles.size)
    for problem, state in zip(problems, states.states, strict=True):
        lines = np.abs(2 * np.pi * problem.frequency_hz[:, None] - np.abs(state.poles)).argmin(axis=0)
        for rows, residues, smooth in zip(problem.rows, state.residues, state.smooth, strict=True):
            scale = rows.row_scale * np.median(rows.weight, axis=1)
            height = residues * state.poles**2 / state.poles.real
            alone += (np.abs(height * scale[:, None]) ** 2).sum(axis=0)
            total += (np.abs(smooth[:, lines] * scale[:, None]) ** 2).sum(axis=0)
    return np.asarray(np.sqrt(alone / np.maximum(total, 1e-300)))


def wrong_at_the_drive_point(run_modes: tuple[RunModes, ...]) -> NDArray[np.bool_]:
    """Modes (N,) whose drive-point residue would feed the shaker: Im R > 0, and not just by a small phase error.

    At its own drive point a passive structure takes power at every resonance; Ewins, Modal Testing, 2nd ed., 2.7.
    """
    wrong = np.zeros(run_modes[0].poles.size, bool)
    for modes in run_modes:
        largest = np.abs(modes.residues).max(axis=1)
        for column, dof in enumerate(modes.responses):
            if dof.unsigned == modes.reference.unsigned:
                sign = dof.direction.sign * modes.reference.direction.sign
                wrong |= modes.residues[:, column].imag * sign > _WRONG_SHARE * largest
    return wrong
