"""Excitation, spectra and frequency response functions, with labels."""
