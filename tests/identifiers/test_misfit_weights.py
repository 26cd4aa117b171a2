"""Residues for some of the poles: a mode that nobody told of must not bend them."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import Campaign, modal_assurance
from vgvt.identification.example import Example
from vgvt_identifiers.misfit_weights import residues_beside_others
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.spectra import campaign_spectra

FOUR = Example(
    frequency_hz=(5.2, 11.7, 17.3, 26.1), damping_ratio=(0.01,) * 4, stations=6, duration_s=40.0, noise_m_s2=0.05
)


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return FOUR.campaign()


def test_a_mode_without_a_pole_leaves_the_others_their_residues(campaign: Campaign) -> None:
    spectra = campaign_spectra(campaign, FOUR.band_hz)
    known = FOUR.modes().poles[[0, 1, 3]]
    shapes, plain = [], []
    for run in spectra.runs:
        shapes.append(residues_beside_others(run, spectra.frequency_hz, known).residues)
        plain.append(fit_residues(run, spectra.frequency_hz, known).residues)
    truth = FOUR.modes().shapes[[0, 1, 3]]
    beside, bent = (np.diag(modal_assurance(np.concatenate(s).T, truth)) for s in (shapes, plain))
    assert beside.min() > 0.999
    assert (1 - beside).max() < 0.1 * (1 - bent).max()


def test_with_all_poles_it_is_the_plain_fit_within_its_deviations(campaign: Campaign) -> None:
    spectra = campaign_spectra(campaign, FOUR.band_hz)
    for run in spectra.runs:
        whole = residues_beside_others(run, spectra.frequency_hz, FOUR.modes().poles)
        plain = fit_residues(run, spectra.frequency_hz, FOUR.modes().poles)
        assert (np.abs(whole.residues - plain.residues) < plain.std).all()
