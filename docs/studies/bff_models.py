"""The 2014 paper's pipeline on its virtual aircraft: ``python docs/studies/bff_models.py`` fills bff-models.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from command_line import BEGIN_AGAIN, parser_of, worked_off
from numpy.typing import NDArray
from virtual_lab import IMAGES, PAGES, nearest, save_figure, table, with_fields, write_results

from vgvt.data import Campaign, FrequencyResponseSet, FrfFit, ModalModel
from vgvt.identification import run_identifier
from vgvt.scenario import load_scenario
from vgvt.signals import estimate_frf
from vgvt.simulation import simulate, truth_of
from vgvt.simulation.attitude import attitudes_deg
from vgvt_identifiers.era import Era
from vgvt_identifiers.era_sources import shared_settings, sources_by_response
from vgvt_identifiers.frf_spectra import frf_spectra
from vgvt_identifiers.prediction_error import PredictionError
from vgvt_scoreboard import merge_truth, validate

BAND_HZ = (5.0, 30.0)
PUBLISHED_HZ = (5.67, 8.37, 18.34, 19.82, 23.17, 28.60)
"""Table I of the paper."""
ACCEPTED_PERCENT, ACCEPTED_GAP = 70.0, 0.3
ERA = Era(spectra="estimator", average="plain")
MODELS = {
    "20 states, as in the paper": PredictionError(spectra="estimator", poles="common", weight="none"),
    "20 states for each run": PredictionError(spectra="estimator"),
}
HOOKS_M = (0.65, 0.68, 0.70, 0.72, 0.75)
"""Hooks behind the centre of gravity, aft of the nose: that of ``bff-hung-aft`` and its neighbours."""


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What the pipeline makes of one campaign; ``scatter`` holds the poles (Hz, ζ) of each sensor alone, (n, 2)."""

    true: ModalModel
    frf: FrequencyResponseSet
    scatter: tuple[NDArray[np.float64], ...]
    era: ModalModel
    claims: dict[str, ModalModel]
    fits: dict[str, FrfFit]


def measure() -> tuple[Campaign, ModalModel]:
    """The campaign of the scenario ``bff`` and the average of its modes as tested."""
    result = simulate(load_scenario("bff"))
    return result.campaign, merge_truth(result.truth).model.band(*BAND_HZ)


def pipeline(campaign: Campaign, true: ModalModel) -> Outcome:
    """ERA sensor by sensor, state-space models of all sensors, and their validation against the measured FRFs."""
    frf = estimate_frf(campaign, "auto")
    spectra = frf_spectra(frf, campaign.band_hz)
    scatter = tuple(
        np.stack([np.abs(s.poles) / (2 * np.pi), -s.poles.real / np.abs(s.poles)], axis=1)
        for s in sources_by_response(spectra, shared_settings(ERA), ERA.model)
    )
    claims = {name: run_identifier(method, campaign, BAND_HZ) for name, method in MODELS.items()}
    fits = {name: validate(frf, claim, BAND_HZ) for name, claim in claims.items()}
    return Outcome(true, frf, scatter, run_identifier(ERA, campaign, BAND_HZ), claims, fits)


def patterns(model: ModalModel) -> list[NDArray[np.float64]]:
    """Members (n, 2) of every pattern of ERA, Hz and damping ratio, in order of frequency."""
    groups: dict[str, list[tuple[float, float]]] = {}
    for pole in model.candidates:
        if pole.kept:
            groups.setdefault(pole.reason, []).append((pole.frequency_hz, pole.damping_ratio))
    return sorted((np.array(g) for g in groups.values()), key=lambda g: float(g[:, 0].mean()))


def extra(claim: ModalModel, true: ModalModel) -> list[int]:
    """Claims that are nearest to no true mode."""
    taken = {nearest(claim, float(f)) for f in true.natural_frequency_hz}
    return [k for k in range(len(claim)) if k not in taken]


def results(outcome: Outcome) -> str:
    """The tables of the page."""
    rows = []
    groups = patterns(outcome.era)
    for k, (hertz, ratio) in enumerate(zip(outcome.true.natural_frequency_hz, outcome.true.damping_ratio, strict=True)):
        near = min(groups, key=lambda g: abs(float(g[:, 0].mean()) - float(hertz)))
        seen = near.shape[0]
        cells = [outcome.true.labels[k], f"{hertz:.3f}", f"{100 * ratio:.2f}"]
        cells += [
            f"{near[:, 0].mean():.3f} ± {near[:, 0].std(ddof=1):.3f}",
            f"{100 * near[:, 1].mean():.2f} ± {100 * near[:, 1].std(ddof=1):.2f}",
            f"{seen} of {len(outcome.scatter)}",
        ]
        for claim in outcome.claims.values():
            j = nearest(claim, float(hertz))
            cells += (
                ["–", "–"]
                if j is None
                else [f"{claim.natural_frequency_hz[j]:.3f}", f"{100 * claim.damping_ratio[j]:.2f}"]
            )
        rows.append(cells)
    head = ["mode", "true, Hz", "true ζ, %", "ERA: mean ± std over sensors, Hz", "ERA: ζ, %", "seen by"]
    head += [f"{name}, {what}" for name in outcome.claims for what in ("Hz", "ζ in %")]
    checks = []
    for name, fit in outcome.fits.items():
        said, more = fit.as_dict(ACCEPTED_PERCENT), extra(outcome.claims[name], outcome.true)
        beside = ", ".join(f"{outcome.claims[name].natural_frequency_hz[k]:.2f} Hz" for k in more) or "none"
        checks.append(
            (
                name,
                f"{fit.fit_percent.size - said['below']} of {fit.fit_percent.size}",
                f"{said['median_fit_percent']:.1f}",
                f"{fit.fit_percent.min():.1f}",
                f"{said['largest_nu_gap']:.3f} at {said['largest_nu_gap_hz']:.2f} Hz",
                beside,
            )
        )
    columns = ("model", "NRMSE above 70 %", "median, %", "worst, %", "largest ν-gap, 5–30 Hz", "modes that are none")
    return f"{table(head, rows)}\n\n{table(columns, checks)}"


def hangs() -> str:
    """The table of what the hang does: attitude, modes as tested by hook, and the published frequencies."""
    level, hung = load_scenario("bff"), load_scenario("bff-hung-aft")
    rows = []
    for x in (level.suspension.hook_m[0], *HOOKS_M):
        scenario = with_fields(level, "suspension", hook_m=(x, *level.suspension.hook_m[1:]))
        modes = merge_truth(truth_of(scenario)).model.band(*BAND_HZ)
        pitch = np.mean([pitch for _, pitch in attitudes_deg(scenario)])
        name = {one.suspension.hook_m: f" (`{one.name}`)" for one in (level, hung)}.get(scenario.suspension.hook_m, "")
        rows.append([f"{x:.3f}{name}", f"{max(-pitch, 0.0):.0f}", *(f"{f:.3f}" for f in modes.natural_frequency_hz)])
    rows.append(["*identified in the paper*", "", *(f"{f:.2f}" for f in PUBLISHED_HZ)])
    return table(("hook, m aft of the nose", "nose down, °", *modes.labels), rows)


def picture(outcome: Outcome) -> None:
    """The paper's figures 4, 8 and 9: scatter over sensors, NRMSE by sensor, ν-gap over frequency."""
    figure, axes = plt.subplots(3, 1, figsize=(6.4, 7.6), layout="constrained", height_ratios=(1.5, 1, 1))
    for sensor, poles in enumerate(outcome.scatter):
        axes[0].plot(poles[:, 0], np.full(len(poles), sensor + 1), "x", color="tab:blue", markersize=4)
    for hertz in outcome.true.natural_frequency_hz:
        axes[0].axvline(hertz, color="0.4", linestyle="--", linewidth=0.8)
    axes[0].set(xlabel="frequency in Hz", ylabel="sensor", xlim=(3, 35), title="ERA of each sensor; dashed: true modes")
    for k, (name, fit) in enumerate(outcome.fits.items()):
        place = np.arange(fit.fit_percent.shape[0]) + 1 + 0.4 * (k - 0.5)
        axes[1].bar(place, fit.fit_percent[:, 0], width=0.38, color=f"C{k}", label=name)
        axes[2].plot(fit.frequency_hz, fit.nu_gap, color=f"C{k}", linewidth=1)
    axes[1].axhline(ACCEPTED_PERCENT, color="0.3", linestyle="--", linewidth=0.8)
    axes[1].set(xlabel="sensor", ylabel="NRMSE fit in %", ylim=(0, 125), yticks=range(0, 101, 20))
    axes[1].legend(loc="upper center", fontsize=8, ncols=2)
    axes[2].axhline(ACCEPTED_GAP, color="0.3", linestyle="--", linewidth=0.8)
    axes[2].set(xlabel="frequency in Hz", ylabel="ν-gap", xlim=BAND_HZ, ylim=(0, 0.4))
    for one in axes:
        one.grid(alpha=0.3)
    save_figure(figure, IMAGES / "study-bff-models.svg")
    plt.close(figure)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, on which there is nothing to choose."""
    return parser_of(__doc__).parse_args(words)


def fill() -> None:
    """Measure, and fill the page and its figure."""
    hung, answer = hangs(), pipeline(*measure())
    write_results(PAGES / "bff-models.md", hung, "of the hang")
    write_results(PAGES / "bff-models.md", results(answer))
    picture(answer)


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    arguments(words)
    return worked_off(fill, BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
