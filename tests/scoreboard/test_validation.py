"""NRMSE and ν-gap of a claim against frequency responses, where both are known in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Direction, Dof, FrequencyResponseSet, InputError, ModalModel, Quantity, synthesise
from vgvt_scoreboard import validate
from vgvt_scoreboard.nu_gap import STANDARD_GRAVITY_M_S2

BAND = (5.0, 30.0)
LINES = np.linspace(2, 40, 1901)
DOFS = tuple(Dof(i, Direction.PLUS_Z) for i in (1, 2, 3))
DRIVE = (Dof(9, Direction.PLUS_Z),)


def model(gain: float = 1.0) -> ModalModel:
    frequency, damping = np.array([8.0, 21.0]), np.array([0.01, 0.02])
    shapes = np.array([[1.0, -0.4, 0.6], [0.3, 1.0, -0.8]])
    residues = gain * (shapes / (4j * np.pi * frequency[:, None]))[:, :, None]
    return ModalModel(frequency, damping, shapes.astype(complex), DOFS, references=DRIVE, residues=residues)


def test_a_claim_that_says_what_was_measured_fits_perfectly() -> None:
    fit = validate(synthesise(model(), LINES), model(), BAND)
    assert fit.fit_percent == pytest.approx(100, abs=1e-6)
    assert fit.nu_gap.max() < 1e-6
    assert fit.frequency_hz[0] >= BAND[0]
    assert fit.frequency_hz[-1] <= BAND[1]
    said = fit.as_dict()
    assert said["below"] == 0
    assert len(said["nrmse"]) == 3


def test_a_reference_named_along_the_opposite_direction_is_the_same_reference() -> None:
    claim = model()
    assert claim.residues is not None
    turned = replace(claim, references=(Dof(9, Direction.MINUS_Z),), residues=-claim.residues)
    measured = synthesise(claim, LINES)
    assert validate(measured, turned, BAND).fit_percent == pytest.approx(100, abs=1e-6)
    assert validate(measured, replace(turned, residues=claim.residues), BAND).fit_percent.max() < 0
    moved = replace(claim, references=(Dof(8, Direction.PLUS_Z),))
    with pytest.raises(InputError, match="no reference"):
        validate(measured, moved, BAND)


def test_a_claim_is_compared_with_what_a_window_shows_of_it() -> None:
    """A hammer's exponential window damps what was measured; a claim states the structure's damping."""
    seen = synthesise(model(), LINES, added_decay_rad_per_s=2.0)
    fit = validate(seen, model(), BAND)
    assert fit.fit_percent == pytest.approx(100, abs=1e-6)
    assert fit.nu_gap.max() < 1e-6
    assert validate(replace(seen, added_decay_rad_per_s=0.0), model(), BAND).fit_percent.max() < 80


def test_the_gap_of_a_wrong_gain_is_the_chordal_distance() -> None:
    """For parallel columns a and g a the graphs span one plane: the gap is |g - 1| |a| / sqrt((1 + a²)(1 + g² a²))."""
    gain = 1.3
    fit = validate(synthesise(model(), LINES), model(gain), BAND, residual_terms=False)
    column = synthesise(model(), fit.frequency_hz).values[:, 0] / STANDARD_GRAVITY_M_S2
    size = np.sqrt((np.abs(column) ** 2).sum(axis=0))
    expected = (gain - 1) * size / np.sqrt((1 + size**2) * (1 + (gain * size) ** 2))
    assert fit.nu_gap == pytest.approx(expected, abs=1e-9)
    y = synthesise(model(), fit.frequency_hz).values
    spread = np.linalg.norm(y - y.mean(axis=2, keepdims=True), axis=2)
    assert fit.fit_percent == pytest.approx(100 - 100 * (gain - 1) * np.linalg.norm(y, axis=2) / spread, abs=1e-9)


def test_residual_terms_stand_for_what_lies_outside_the_band() -> None:
    measured = synthesise(model(), LINES)
    outside = 0.8 + 3e-5 * (2 * np.pi * LINES) ** 2
    loaded = replace(measured, values=measured.values + outside)
    assert validate(loaded, model(), BAND).fit_percent == pytest.approx(100, abs=1e-6)
    assert validate(loaded, model(), BAND, residual_terms=False).fit_percent.max() < 90


def test_only_what_both_know_is_compared_and_lines_without_a_value_are_left_out() -> None:
    measured = synthesise(model(), LINES)
    values = measured.values.copy()
    values[:, :, 500] = np.nan
    more = FrequencyResponseSet(
        (Dof(2, Direction.MINUS_Z), Dof(7, Direction.PLUS_X)), DRIVE, LINES,
        np.concatenate([-values[1:2], values[:1]]), (0, 0),
    )  # fmt: skip
    fit = validate(more, model(), BAND)
    assert fit.responses == (Dof(2, Direction.MINUS_Z),)
    assert fit.fit_percent == pytest.approx(100, abs=1e-6)
    assert LINES[500] not in fit.frequency_hz


def test_what_cannot_be_compared_is_refused() -> None:
    measured = synthesise(model(), LINES)
    bare = replace(model(), residues=None, references=())
    with pytest.raises(InputError, match="no modes with residues"):
        validate(measured, bare, BAND)
    with pytest.raises(InputError, match="accelerances"):
        validate(synthesise(model(), LINES, Quantity.VELOCITY), model(), BAND)
    with pytest.raises(InputError, match="share no response"):
        validate(replace(measured, references=(Dof(8, Direction.PLUS_Z),)), model(), BAND)
    with pytest.raises(InputError, match="finite lines"):
        validate(measured, model(), (5.0, 5.001))
