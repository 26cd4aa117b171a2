"""Draw the README's picture from a run folder: ``vgvt run quick && python docs/make_pictures.py runs/quick``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from studies.command_line import BEGIN_AGAIN, parser_of, worked_off

from vgvt.data import FrequencyResponseSet, ModalModel
from vgvt.files import read_campaign
from vgvt.files.atomically import replacing
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

    path = IMAGES / f"sigma-{folder.absolute().name}.svg"
    with replacing(path) as part:
        figure.savefig(part, format="svg", metadata={"Date": None})
    plt.close(figure)
    return path


def _on_curve(claim: ModalModel, frf: FrequencyResponseSet) -> tuple[list[float], list[float]]:
    """Claimed frequencies and the curve there, a little above so that the markers point at it."""
    frequency = [float(f) for f in claim.natural_frequency_hz]
    return frequency, [1.35 * float(np.interp(f, frf.frequency_hz, frf.sigma())) for f in frequency]


def run_folder(text: str) -> Path:
    """The type of an argument that names what ``vgvt run`` has left."""
    if not (Path(text) / "campaign.nc").is_file():
        raise argparse.ArgumentTypeError(f"{text} holds no campaign.nc: name a folder that vgvt run has written")
    return Path(text)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; ``folders`` are those of the runs to draw."""
    parser, said = parser_of(__doc__), "a run's folder (runs/quick if nothing is said)"
    parser.add_argument("folders", nargs="*", type=run_folder, metavar="FOLDER", help=said)
    given = parser.parse_args(words)
    if not given.folders:
        given.folders = [Path("runs/quick")]
        if not (given.folders[0] / "campaign.nc").is_file():
            parser.error("runs/quick holds no campaign.nc: write vgvt run quick first, or name another run's folder")
    return given


def fill(folders: Sequence[Path]) -> None:
    """Draw every run, and say where its picture is."""
    for folder in folders:
        sys.stdout.write(f"{sigma_picture(folder)}\n")


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: fill(given.folders), BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
