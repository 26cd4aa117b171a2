"""The curve drawn of a claim is the one that its fit in per cent is of: with residual terms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Quantity, synthesise
from vgvt.view import frf_figure, sigma_figure
from vgvt.view.report import render_report

BAND_HZ = (3.0, 35.0)


def loaded(example, sign: float = 1.0):
    """The true modes with heavy and stiff ones outside the band, as they would be measured, and the claim of them."""
    dofs = example.campaign.response_dofs
    claim = example.truth.as_tested[0].at(dofs)
    clean = synthesise(claim, example.frf.frequency_hz)
    outside = sign * (0.4 + 2e-5 * (2 * np.pi * clean.frequency_hz) ** 2)
    return replace(clean, values=clean.values + outside), claim


def test_a_claim_is_drawn_with_the_residual_terms_that_it_is_judged_with(example) -> None:
    measured, claim = loaded(example)
    for response in (measured.responses[0], measured.responses[7]):
        figure = frf_figure(measured, {"modes": claim}, response, band_hz=BAND_HZ)
        curve = next(trace for trace in figure.data if trace.name == "modes")
        exact = synthesise(claim.at((response,)), curve.x.astype(float)).values[0, 0]
        expected = exact + 0.4 + 2e-5 * (2 * np.pi * curve.x.astype(float)) ** 2
        assert curve.y == pytest.approx(np.abs(expected), rel=2e-3)
        assert np.abs(np.log(np.abs(exact[:5]) / curve.y[:5])).min() > 0.5, "without them the modes miss"
    sigma = next(t for t in sigma_figure(measured, {"modes": claim}, (), BAND_HZ).data if t.name == "modes, fit")
    assert sigma.y == pytest.approx(np.interp(sigma.x, measured.frequency_hz, measured.sigma()), rel=0.05)


def test_a_claim_is_drawn_as_a_window_shows_it(example) -> None:
    """What a hammer's exponential window adds is in the measured curve, not in the claim."""
    claim = example.truth.as_tested[0].at(example.campaign.response_dofs)
    measured = synthesise(claim, example.frf.frequency_hz, added_decay_rad_per_s=2.0)
    response = measured.responses[0]
    figure = frf_figure(measured, {"modes": claim}, response, band_hz=BAND_HZ)
    curve = next(trace for trace in figure.data if trace.name == "modes")
    exact = synthesise(claim.at((response,)), curve.x.astype(float), added_decay_rad_per_s=2.0).values[0, 0]
    assert curve.y == pytest.approx(np.abs(exact), rel=2e-3)


def test_lines_without_a_value_and_other_quantities_do_not_stop_the_drawing(example) -> None:
    measured, claim = loaded(example)
    response = measured.responses[0]
    whole = frf_figure(measured, {"modes": claim}, response, band_hz=BAND_HZ).data[2].y
    values = measured.values.copy()
    values[:, :, 700] = np.nan
    gap = frf_figure(replace(measured, values=values), {"modes": claim}, response, band_hz=BAND_HZ).data[2].y
    assert gap == pytest.approx(whole, rel=1e-3)
    nothing = replace(measured, values=np.full_like(values, np.nan))
    assert np.isfinite(frf_figure(nothing, {"modes": claim}, response, band_hz=BAND_HZ).data[2].y).all()
    receptance = synthesise(claim, measured.frequency_hz, Quantity.DISPLACEMENT)
    curve = frf_figure(receptance, {"modes": claim}, response, band_hz=BAND_HZ).data[2]
    exact = synthesise(claim.at((response,)), curve.x.astype(float), Quantity.DISPLACEMENT).values[0, 0]
    assert curve.y == pytest.approx(np.abs(exact), rel=2e-3)


def test_the_page_says_what_is_drawn(example) -> None:
    page = render_report("t", example.campaign, example.frf, example.claims, None, {}, {})
    assert "residual terms" in page[page.index('id="frf-select"') - 500 : page.index('id="frf-select"')]
