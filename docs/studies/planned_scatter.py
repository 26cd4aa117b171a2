"""Does the scatter of simulated campaigns meet the plan's prediction? Noise drawn anew, the poles fitted each time.

The rig's response is computed once, exactly as ``simulate`` does it; sensors, conditioners and converters
then act on it with a seed of their own. The fit is the maximum-likelihood one of the package, told the noise;
with ``--identifier`` it is a registered method, told nothing, on campaigns simulated as ``vgvt plan`` does it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.budget import Budget
from vgvt.planning.confirmation import claims, lighter
from vgvt.planning.fisher import accelerance
from vgvt.planning.prediction import predict
from vgvt.planning.proposal import RIGID, elastic, proposal
from vgvt.planning.system import System, systems_of
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.streams import named_stream
from vgvt.simulation.acquisition import record
from vgvt.simulation.assembly import plans
from vgvt.simulation.command import drive_commands, sample_times_s, sent_commands
from vgvt.simulation.information import force_noise, response_noise
from vgvt.simulation.linear_engine import respond
from vgvt.simulation.truth import driven_state_space
from vgvt_identifiers.likelihood_fit import weighted_problem
from vgvt_identifiers.pole_fit import fit_poles
from vgvt_identifiers.run_noise import RunNoise
from vgvt_identifiers.spectra import RunSpectra

_STEPS = 6


def estimates(scenario: Scenario, first: int, last: int) -> Iterator[NDArray[np.float64]]:
    """Frequencies and damping ratios (2, M) of one campaign after the other, each pole by its runs' information."""
    scenario = lighter(scenario)
    layouts, systems, time = plans(scenario), systems_of(scenario), sample_times_s(scenario)
    readings = []
    for run, layout in enumerate(layouts):
        model = driven_state_space(layout, run)[1]
        drive = len(layout.points)
        index = [*systems[run].sensors, *range(drive, model.output_matrix.shape[0])]
        readings.append(
            respond(model.outputs(index), sent_commands(layout, run, time), scenario.acquisition.sample_rate_hz)
        )
    for k in range(first, last):
        seed = int(named_stream(scenario.seed, "plan", k).integers(2**31))
        runs = []
        for run, (layout, system, clean) in enumerate(zip(layouts, systems, readings, strict=True)):
            seeded = replace(layout, scenario=layout.scenario.model_copy(update={"seed": seed}))
            taken = record(seeded, run, drive_commands(scenario, run, time), clean.copy())
            runs.append(_fitted(system, taken.samples, taken.sample_rate_hz, scenario.excitation.band_hz))
        yield _together(runs)


def _fitted(
    system: System, samples: NDArray[np.float64], rate_hz: float, band_hz: tuple[float, float]
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Poles (M,) of one run's samples (channels, N) and the variances of their damping."""
    count = samples.shape[1]
    lines = np.arange(count // 2 + 1) * rate_hz / count
    keep = (lines >= band_hz[0]) & (lines <= band_hz[1])
    spectra, f = np.fft.rfft(samples, axis=1)[:, keep], lines[keep]
    force, responses = spectra[1], spectra[2:]  # after the drive
    power = rate_hz * count / 2
    own = np.tile(response_noise(system.layout, f) * power, (len(responses), 1))
    felt = force_noise(system.layout, f) * power
    gain = np.abs(accelerance(f, system.modes.poles, system.residues)[list(system.sensors)]) ** 2
    noise = RunNoise(own, felt, felt * (gain / own).sum(axis=0))
    dofs = tuple(system.modes.dofs[i] for i in system.sensors)
    ratio = responses / force
    run = RunSpectra(1, system.modes.references[0], dofs, force, ratio, own, ratio, own)
    problem = weighted_problem(f, (run,), (noise,), shared=True)
    elastic = [label not in RIGID for label in system.modes.labels]
    hz = system.modes.natural_frequency_hz
    start = system.modes.poles[np.array(elastic) & (hz > band_hz[0]) & (hz < band_hz[1])]
    state = fit_poles(problem, start, _STEPS)
    variance = np.diag(state.covariance())[: start.size]
    return state.poles, variance


def _together(runs: list[tuple[NDArray[np.complex128], NDArray[np.float64]]]) -> NDArray[np.float64]:
    poles, weight = np.array([p for p, _ in runs]), np.array([1 / v for _, v in runs])
    mean = (weight * poles).sum(axis=0) / weight.sum(axis=0)
    return np.array([np.abs(mean) / (2 * np.pi), -mean.real / np.abs(mean)])


def _rows(scenario: Scenario, identifier: str | None, first: int, last: int) -> Iterator[NDArray[np.float64]]:
    if identifier is None:
        return estimates(scenario, first, last)
    expected = predict(scenario)
    plan = proposal("plan", scenario, Budget(20.0, 20), elastic(expected), prediction=expected)
    return claims(plan, identifier, range(first, last))


def main() -> None:
    """Write one JSON line per campaign, then print the ratios of scatter to prediction."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenario", help="a plan's TOML file, or a bundled scenario")
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 50), metavar=("FIRST", "LAST"))
    parser.add_argument("--identifier", help="a registered method in place of the fit that is told the noise")
    parser.add_argument("--out", type=Path, default=Path("planned-scatter.jsonl"))
    given = parser.parse_args()
    scenario = load_scenario(given.scenario)
    modes = [m for m in predict(scenario).modes if m.label not in RIGID]
    predicted = np.array([[m.frequency_std_hz for m in modes], [m.damping_ratio_std for m in modes]])
    rows = []
    with given.out.open("a", encoding="utf-8") as lines:
        for row in _rows(scenario, given.identifier, *given.seeds):
            rows.append(row)
            lines.write(json.dumps(row.tolist()) + "\n")
            lines.flush()
    ratio = np.nanstd(rows, axis=0, ddof=1) / predicted
    print(f"{len(rows)} campaigns, each ratio known to {100 / np.sqrt(2 * (len(rows) - 1)):.0f} %")  # noqa: T201
    print("frequency", ratio[0].round(3), "damping", ratio[1].round(3))  # noqa: T201
    print("found", np.isfinite(np.array(rows)[:, 0]).sum(axis=0), "predicted", *predicted)  # noqa: T201


if __name__ == "__main__":
    main()
