"""A wider sweep hurts low modes: ``python docs/studies/sweep_width.py [SEEDS]`` fills docs/studies/sweep-width.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from command_line import BEGIN_AGAIN, parser_of_seeds, whole_number, worked_off
from numpy.typing import NDArray
from virtual_lab import IMAGES, PAGES, deviation_ratio, nearest, reduced_hati, save_figure, table, write_results

from vgvt.identification import make_identifier
from vgvt.simulation import simulate, truth_of

START_HZ = 3.0
NARROW_HZ, WIDE_HZ = 13.0, 35.0
STOPS_HZ = (NARROW_HZ, 19.0, WIDE_HZ)
SEEDS, SEED_STEP = 400, 1000


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """First bending out of many repetitions of one sweep; ``limit_hz`` is the bound that the truth states."""

    stop_hz: float
    true_hz: float
    true_damping_ratio: float
    limit_hz: float
    frequency_hz: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    stated_std_hz: NDArray[np.float64]

    @property
    def width_hz(self) -> float:
        """Width of the sweep."""
        return self.stop_hz - START_HZ


def repeat(stop_hz: float, seeds: range) -> Sweep:
    """Measure and identify the first bending once a seed; RuntimeError if a repetition does not find it."""
    scenario = reduced_hati(START_HZ, stop_hz)
    modes = truth_of(scenario).as_tested[0]
    first = modes.labels.index("1st symmetric bending")
    true_hz = float(modes.natural_frequency_hz[first])
    limits = modes.natural_frequency_std_hz
    if limits is None:
        raise RuntimeError("the truth states no bound")
    found = []
    for seed in seeds:
        campaign = simulate(scenario.model_copy(update={"seed": seed})).campaign
        claim = make_identifier("quadrature").identify(campaign, campaign.band_hz)
        k = nearest(claim, true_hz)
        if k is None or claim.natural_frequency_std_hz is None:
            raise RuntimeError(f"seed {seed}: no mode near {true_hz:.2f} Hz")
        found.append((claim.natural_frequency_hz[k], claim.damping_ratio[k], claim.natural_frequency_std_hz[k]))
    frequency, damping, stated = np.array(found).reshape(-1, 3).T
    return Sweep(stop_hz, true_hz, float(modes.damping_ratio[first]), float(limits[first]), frequency, damping, stated)


def law(wide: Sweep, narrow: Sweep) -> float:
    """What the square-root law says: √(Δf wide / Δf narrow)."""
    return float(np.sqrt(wide.width_hz / narrow.width_hz))


def results(sweeps: list[Sweep]) -> str:
    """The tables of the page."""
    rows = [
        (
            f"{START_HZ:g}–{s.stop_hz:g}",
            f"{1e3 * s.frequency_hz.std(ddof=1):.4f}",
            f"{1e3 * s.limit_hz:.4f}",
            f"{1e3 * np.median(s.stated_std_hz):.4f}",
            f"{1e3 * (s.frequency_hz.mean() - s.true_hz):+.4f}",
            f"{100 * s.damping_ratio.std(ddof=1) / s.true_damping_ratio:.4f}",
            f"{100 * s.limit_hz / (s.true_damping_ratio * s.true_hz):.4f}",
        )
        for s in sweeps
    ]
    spreads = table(
        (
            "sweep, Hz",
            "std(f), mHz",
            "bound, mHz",
            "std that the identifier states, mHz",
            "mean error, mHz",
            "std(ζ)/ζ, %",
            "bound, %",
        ),
        rows,
    )
    narrow = sweeps[0]
    ratios = []
    for wide in sweeps[1:]:
        f = deviation_ratio(wide.frequency_hz, narrow.frequency_hz)
        z = deviation_ratio(wide.damping_ratio, narrow.damping_ratio)
        ratios.append(
            (
                f"{START_HZ:g}–{wide.stop_hz:g} to {START_HZ:g}–{narrow.stop_hz:g}",
                f"{f[0]:.2f} ({f[1]:.2f}–{f[2]:.2f})",
                f"{z[0]:.2f} ({z[1]:.2f}–{z[2]:.2f})",
                f"{law(wide, narrow):.2f}",
                f"{wide.limit_hz / narrow.limit_hz:.2f}",
            )
        )
    head = ("sweeps, Hz", "ratio of std(f)", "ratio of std(ζ)", "√Δf law", "ratio of the bounds")
    return f"{narrow.frequency_hz.size} seeds a sweep.\n\n{spreads}\n\n{table(head, ratios)}"


def picture(sweeps: list[Sweep]) -> None:
    """Spread against the width of the sweep, with F intervals about the narrowest."""
    width = np.array([s.width_hz for s in sweeps])
    figure, axes = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
    narrow = sweeps[0]
    for name, colour, shift in (("frequency_hz", "tab:blue", 0.99), ("damping_ratio", "tab:red", 1.01)):
        ratios = np.array([deviation_ratio(getattr(s, name), getattr(narrow, name)) for s in sweeps[1:]])
        bars = np.abs(ratios[:, 1:].T - ratios[:, 0])
        label = {"frequency_hz": "natural frequency", "damping_ratio": "damping ratio"}[name]
        axes.errorbar(width[1:] * shift, ratios[:, 0], bars, fmt="o", color=colour, capsize=3, label=label)
    line = np.linspace(width[0], width[-1], 100)
    axes.plot(line, np.sqrt(line / width[0]), color="0.3", label="√Δf law")
    axes.plot(width, [s.limit_hz / narrow.limit_hz for s in sweeps], "kx", label="bound in the truth")
    axes.set(xlabel="width of the sweep in Hz", ylabel="standard deviation over that of 3–13 Hz")
    axes.grid(alpha=0.3)
    axes.legend()
    save_figure(figure, IMAGES / "study-sweep-width.svg")
    plt.close(figure)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    # A spread needs two, and the next sweep's own seeds begin a step further on.
    return parser_of_seeds(__doc__, whole_number(2, SEED_STEP), SEEDS, "a sweep").parse_args(words)


def fill(count: int) -> None:
    """Measure, and fill the page and its figure."""
    # Seeds of their own for every sweep: the F interval wants independent samples.
    measured = [repeat(stop, range(SEED_STEP * k, SEED_STEP * k + count)) for k, stop in enumerate(STOPS_HZ)]
    write_results(PAGES / "sweep-width.md", results(measured))
    picture(measured)


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: fill(given.seeds), BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
