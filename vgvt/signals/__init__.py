"""Excitation, spectra and frequency response functions, with labels."""

from vgvt.signals.excitation import linear_chirp, linear_chirp_frequency, linear_chirp_phase
from vgvt.signals.frf import ESTIMATORS, estimate_frf
from vgvt.signals.local_polynomial import local_polynomial_variance
from vgvt.signals.noise import coloured_noise, interpolated_density
from vgvt.signals.spectra import power_spectral_density

__all__ = [
    "ESTIMATORS",
    "coloured_noise",
    "estimate_frf",
    "interpolated_density",
    "linear_chirp",
    "linear_chirp_frequency",
    "linear_chirp_phase",
    "local_polynomial_variance",
    "power_spectral_density",
]
