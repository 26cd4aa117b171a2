"""Excitation, spectra and frequency response functions, with labels."""

from vgvt.signals.dwells import DwellSchedule, dwell_schedule
from vgvt.signals.excitation import linear_chirp, linear_chirp_frequency, linear_chirp_phase
from vgvt.signals.excitation_impact import impact_train
from vgvt.signals.excitation_multisine import multisine, multisine_lines
from vgvt.signals.excitation_random import burst_random, continuous_random
from vgvt.signals.excitation_sines import logarithmic_chirp, stepped_frequencies, stepped_sine
from vgvt.signals.frf import ESTIMATORS, estimate_frf
from vgvt.signals.impact import ImpactWindows, impact_windows, without_window_damping
from vgvt.signals.local_polynomial import local_polynomial_variance
from vgvt.signals.noise import coloured_noise, interpolated_density
from vgvt.signals.periods import Periods
from vgvt.signals.spectra import power_spectral_density

__all__ = [
    "ESTIMATORS",
    "DwellSchedule",
    "ImpactWindows",
    "Periods",
    "burst_random",
    "coloured_noise",
    "continuous_random",
    "dwell_schedule",
    "estimate_frf",
    "impact_train",
    "impact_windows",
    "interpolated_density",
    "linear_chirp",
    "linear_chirp_frequency",
    "linear_chirp_phase",
    "local_polynomial_variance",
    "logarithmic_chirp",
    "multisine",
    "multisine_lines",
    "power_spectral_density",
    "stepped_frequencies",
    "stepped_sine",
    "without_window_damping",
]
