"""The quadrature method on the measured Hati campaign: the peaks that the test's own log and paper report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vgvt.data import Campaign, ModalModel
from vgvt.files import open_campaign
from vgvt.identification import run_identifier
from vgvt_identifiers.bell_fit import bell_fit
from vgvt_identifiers.quadrature import Quadrature
from vgvt_identifiers.spectra import campaign_spectra

pytestmark = [pytest.mark.measured, pytest.mark.slow]
LINE_HZ = 1 / 60


@pytest.fixture(scope="module")
def campaign(measured_folder: Path) -> Campaign:
    return open_campaign("hati-2015-09-24")


@pytest.fixture(scope="module")
def model(campaign: Campaign) -> ModalModel:
    return run_identifier(Quadrature(), campaign)


@pytest.mark.parametrize("logged_hz", [7.797, 19.058, 23.819, 31.784])
def test_the_sigma_peaks_of_the_log_are_found_within_a_line(model: ModalModel, logged_hz: float) -> None:
    raw = [float(f.partition("=")[2]) for flags in model.flags for f in flags if f.startswith("sigma_peak_hz=")]
    assert np.abs(np.array(raw) - logged_hz).min() <= LINE_HZ


def test_the_bell_near_19_hz_is_where_the_paper_has_it(campaign: Campaign) -> None:
    spectra = campaign_spectra(campaign, campaign.band_hz)
    for drop_db in (6.0, 10.0, 20.0):
        fit = bell_fit(spectra.frequency_hz, spectra.power, 19.0, drop_db=drop_db)
        assert fit.natural_frequency_hz == pytest.approx(19.07, abs=0.05)


def test_the_fitted_mode_at_19_hz_agrees_with_the_bell(model: ModalModel) -> None:
    nearest = np.argmin(np.abs(model.natural_frequency_hz - 19.07))
    assert model.natural_frequency_hz[nearest] == pytest.approx(19.07, abs=0.05)


def test_the_lines_that_are_a_line_or_two_wide_are_flagged(model: ModalModel) -> None:
    for logged_hz in (7.797, 23.819):
        nearest = int(np.argmin(np.abs(model.natural_frequency_hz - logged_hz)))
        assert "narrow" in model.flags[nearest]
