"""Draw the README's picture from a run folder: ``vgvt run quick && python docs/make_pictures.py runs/quick``."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from vgvt.data import FrequencyResponseSet, InputError, ModalModel
from vgvt.files import read_campaign
from vgvt.files.claim import read_claim
from vgvt.files.truth import read_truth
from vgvt.signals import estimate_frf
from vgvt_scoreboard import merge_truth

IMAGES = Path(__file__).parent / "images"


def sigma_picture(folder: Path) -> Path:
    """The sigma plot of a run with the true and the claimed modes marked, as an SVG; returns its path."""
    campaign = read_campaign(folder / "campaign.nc")
    low, high = campaign.band_hz
    truth = merge_truth(read_truth(folder / "sealed" / "truth.nc")).model.band(low, high)
    claims = {path.stem: read_claim(path).model for path in sorted((folder / "claims").glob("*.json"))}
    frf = estimate_frf(campaign).band(low, high)

    mpl.rcParams.update({"svg.hashsalt": "vgvt", "font.size": 9, "path.simplify_threshold": 0.5})
    figure, axes = plt.subplots(figsize=(8.0, 3.4), layout="constrained")
    axes.semilogy(frf.frequency_hz, frf.sigma(), color="0.25", linewidth=0.9, label="simulated measurement")
    for k, frequency in enumerate(truth.natural_frequency_hz):
        axes.axvline(frequency, color="tab:blue", linewidth=1.2, alpha=0.7, label="true mode" if k == 0 else None)
    for name, claim in claims.items():
        axes.plot(*_on_curve(claim, frf), "v", color="tab:red", markersize=7, label=f"claim of {name}")
    sigma = frf.sigma()
    axes.set(
        xlim=(low, high),
        ylim=(0.6 * sigma.min(), 2.5 * sigma.max()),
        xlabel="frequency in Hz",
        ylabel="largest singular value in (m/s²)/N",
    )
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", framealpha=0.9)

    IMAGES.mkdir(exist_ok=True)
    path = IMAGES / f"sigma-{folder.name}.svg"
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    return path


def _on_curve(claim: ModalModel, frf: FrequencyResponseSet) -> tuple[list[float], list[float]]:
    """Claimed frequencies and the curve there, a little above so that the markers point at it."""
    frequency = [float(f) for f in claim.natural_frequency_hz]
    return frequency, [1.35 * float(np.interp(f, frf.frequency_hz, frf.sigma())) for f in frequency]


if __name__ == "__main__":
    try:
        for argument in sys.argv[1:] or ["runs/quick"]:
            sys.stdout.write(f"{sigma_picture(Path(argument))}\n")
    except InputError as error:
        sys.exit(f"{error}")
