"""Frequency responses as the spectra of runs, and a realisation of them without any record."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import Direction, Dof, FrequencyResponseSet, InputError, ModalModel, Quantity, synthesise
from vgvt_identifiers.era import Era
from vgvt_identifiers.era_sources import shared_settings, sources_by_response
from vgvt_identifiers.frf_spectra import frf_spectra
from vgvt_identifiers.pole_claim import ClaimOptions, claim_of_patterns
from vgvt_identifiers.pole_patterns import PatternOptions, find_patterns

DOFS = tuple(Dof(i, Direction.PLUS_Z) for i in range(1, 9))
DRIVE = (Dof(50, Direction.PLUS_Z),)


def analyser(
    noise: float = 1e-3, quantity: Quantity = Quantity.ACCELERATION
) -> tuple[ModalModel, FrequencyResponseSet]:
    """400 lines from 3 to 35 Hz of a structure with four modes, a run a response."""
    generator = np.random.default_rng(2)
    frequency, damping = np.array([6.1, 12.7, 19.3, 27.0]), np.array([0.015, 0.01, 0.02, 0.02])
    shapes = generator.standard_normal((4, 8))
    residues = (shapes / (4j * np.pi * frequency[:, None]))[:, :, None]
    model = ModalModel(frequency, damping, shapes.astype(complex), DOFS, references=DRIVE, residues=residues)
    frf = synthesise(model, np.linspace(3, 35, 400), quantity, tuple(range(8)))
    error = generator.standard_normal((2, *frf.values.shape))
    values = frf.values + noise * (error[0] + 1j * error[1]) / np.sqrt(2)
    return model, FrequencyResponseSet(DOFS, DRIVE, frf.frequency_hz, values, frf.runs, quantity)


def test_realisation_of_an_analysers_responses_shows_every_mode() -> None:
    model, frf = analyser()
    spectra = frf_spectra(frf, (3.0, 35.0))
    assert len(spectra.runs) == 8
    era = Era()
    sources = sources_by_response(spectra, shared_settings(era), era.model)
    options = PatternOptions(least_quality=0.3)
    found = find_patterns(sources, spectra, options)
    claim = claim_of_patterns(found, spectra, (4.0, 33.0), ClaimOptions(options, estimator=True))
    assert claim.natural_frequency_hz == pytest.approx(model.natural_frequency_hz, rel=1e-3)
    assert claim.damping_ratio == pytest.approx(model.damping_ratio, rel=0.03)
    assert claim.residues is not None
    assert model.residues is not None
    error = np.linalg.norm((claim.residues - model.residues)[:, :, 0], axis=1)
    assert np.all(error < 0.02 * np.linalg.norm(model.residues[:, :, 0], axis=1))


def test_the_noise_is_read_from_neighbouring_lines() -> None:
    """A median over 400 lines of exponential variates is known to 1.44 / sqrt(133); third differences share lines."""
    _, frf = analyser(noise=0.5)
    spectra = frf_spectra(frf, (3.0, 35.0))
    level = np.mean([run.variance[0, 0] for run in spectra.runs])
    assert level == pytest.approx(0.25, rel=0.3)


def test_only_accelerances_of_one_reference_are_taken() -> None:
    _, frf = analyser(quantity=Quantity.VELOCITY)
    with pytest.raises(InputError, match="accelerances of one reference"):
        frf_spectra(frf, (3.0, 35.0))
