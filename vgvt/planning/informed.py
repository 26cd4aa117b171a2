"""The best that can be made of a campaign: poles fitted by maximum likelihood that is told the noise, as a bound is.

A method of a lab must find the noise out, and takes what its model cannot explain for noise, too. This fit does not:
its scatter over simulated campaigns says what the test tells, whatever method is used later. The rig's response is
computed once, exactly as ``simulate`` does it; sensors, conditioners and converters then act on it with seeds of
their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.proposal import RIGID
from vgvt.planning.system import System, run_information, systems_of
from vgvt.scenario import Scenario
from vgvt.scenario.streams import named_stream
from vgvt.simulation.acquisition import record
from vgvt.simulation.assembly import plans
from vgvt.simulation.command import drive_commands, sample_times_s, sent_commands
from vgvt.simulation.fisher import accelerance, mean_weights
from vgvt.simulation.information import Seen
from vgvt.simulation.linear_engine import respond
from vgvt.simulation.noise_floor import ac_coupling, force_noise, response_noise
from vgvt.simulation.truth import driven_state_space
from vgvt_identifiers.likelihood_fit import weighted_problem
from vgvt_identifiers.pole_fit import fit_poles
from vgvt_identifiers.run_noise import RunNoise
from vgvt_identifiers.spectra import RunSpectra

INFORMED = "informed"
"""What this fit is called where identifiers have names."""
_STEPS = 6


def estimates(scenario: Scenario, numbers: Iterable[int]) -> Iterator[NDArray[np.float64]]:
    """Frequencies, Hz, and damping ratios (2, M) of the elastic modes in the campaigns with these numbers, in order.

    One shaker and the linear engine, whatever the scenario says. Runs are averaged as the prediction does it.
    """
    layouts, systems, time = plans(scenario), systems_of(scenario), sample_times_s(scenario)
    modes = _elastic(systems[0])
    told = [(system, run_information(system, run)[1]) for run, system in enumerate(systems)]
    weights = _weights(systems, modes)
    readings = []
    for run, layout in enumerate(layouts):
        model = driven_state_space(layout, run)[1]
        drive = len(layout.points)
        index = [*systems[run].sensors, *range(drive, model.output_matrix.shape[0])]
        readings.append(
            respond(model.outputs(index), sent_commands(layout, run, time), scenario.acquisition.sample_rate_hz)
        )
    for k in numbers:
        seed = int(named_stream(scenario.seed, "plan", k).integers(2**31))
        runs = []
        for run, (layout, known, clean) in enumerate(zip(layouts, told, readings, strict=True)):
            seeded = replace(layout, scenario=layout.scenario.model_copy(update={"seed": seed}))
            taken = record(seeded, run, drive_commands(scenario, run, time), clean.copy())
            runs.append(_fitted(*known, np.asarray(taken.samples, dtype=np.float64), taken.sample_rate_hz, modes))
        poles = np.array(runs)
        estimated = np.array([np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)])
        yield (weights * estimated).sum(axis=1)


def _elastic(system: System) -> NDArray[np.intp]:
    """Indices of the elastic modes inside the swept band."""
    low, high = system.layout.scenario.excitation.recorded_band_hz
    hz = system.modes.natural_frequency_hz
    elastic = np.array([label not in RIGID for label in system.modes.labels])
    return np.flatnonzero(elastic & (hz >= low) & (hz <= high))


def _weights(systems: tuple[System, ...], modes: NDArray[np.intp]) -> NDArray[np.float64]:
    """Weights (2, R, M) of the runs in the means of frequencies and damping ratios of some modes (M,)."""
    values, deviations = np.zeros((2, len(systems), modes.size)), np.full((2, len(systems), modes.size), np.inf)
    for run, system in enumerate(systems):
        values[:, run] = system.modes.natural_frequency_hz[modes], system.modes.damping_ratio[modes]
        information, seen = run_information(system, run)
        least = np.array(information.deviations())
        for k, mode in enumerate(modes):
            deviations[:, run, k] = least[:, seen.unknown == mode][:, 0]
    return np.array(
        [
            [mean_weights(v, d) for v, d in zip(value.T, deviation.T, strict=True)]
            for value, deviation in zip(values, deviations, strict=True)
        ]
    ).transpose(0, 2, 1)


def _fitted(
    system: System, seen: Seen, samples: NDArray[np.float64], rate_hz: float, modes: NDArray[np.intp]
) -> NDArray[np.complex128]:
    """Poles (M,), rad/s, of modes (M,) from one run: samples (channels, N), drive and force before responses.

    The unknowns are those of the prediction.
    """
    band_hz = system.layout.scenario.excitation.recorded_band_hz
    count = samples.shape[1]
    lines = np.arange(count // 2 + 1) * rate_hz / count
    keep = (lines > 0) & (lines >= band_hz[0]) & (lines <= band_hz[1])
    spectra, f = np.fft.rfft(samples, axis=1)[:, keep], lines[keep]
    # After the drive; as they were sensed, which is what the noise is told of.
    stated = system.layout.scenario
    force = spectra[1] / ac_coupling(system.layout, stated.transducer.high_pass_hz, f)
    responses = spectra[2:] / ac_coupling(system.layout, stated.accelerometers.high_pass_hz, f)
    power = rate_hz * count / 2
    own = np.tile(response_noise(system.layout, f) * power, (len(responses), 1))
    felt = force_noise(system.layout, f) * power
    gain = np.abs(accelerance(f, system.modes.poles, system.residues)[list(system.sensors)]) ** 2
    noise = RunNoise(own, felt, felt * (gain / own).sum(axis=0))
    dofs = tuple(system.modes.dofs[i] for i in system.sensors)
    ratio = responses / force
    run = RunSpectra(1, system.modes.references[0], dofs, force, ratio, own, ratio, own)
    powers = np.array(seen.background)
    lower, upper = int((powers <= 0).sum()), int((powers > 0).sum())
    problem = replace(weighted_problem(f, (run,), (noise,), shared=True), lower_terms=lower, upper_terms=upper)
    poles = fit_poles(problem, system.modes.poles[seen.unknown], _STEPS).poles
    return np.asarray(poles[np.searchsorted(seen.unknown, modes)])
