"""The law of a thing that has no name: read as what it is made of, and as nothing where it is of nothing simple."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.evidence.fitted_law import FittedLaw, Part
from vgvt.reconcile.evidence.smooth_law import TERMS, law_terms

LINE = np.geomspace(3.0, 35.0, 120)
OMEGA = 2 * np.pi * LINE


def law_of(
    values: np.ndarray, kind: str = "structure", std: float | np.ndarray = 1.0, turns: bool = False
) -> FittedLaw:
    """The smooth law nearest to some values (L,), each line known as well as ``std`` says, on its own."""
    terms = law_terms(LINE)
    sizes = np.linalg.lstsq(terms.astype(complex), values, rcond=None)[0]
    one = terms.T @ (terms / np.broadcast_to(std, LINE.shape)[:, None] ** 2)
    return FittedLaw(LINE, sizes, np.kron(np.eye(2), one), kind, turns)


def parts(law: FittedLaw) -> dict[str, float]:
    return {p.name: p.value for p in law.reading.parts}


def test_on_the_structure_it_is_a_spring_a_damper_and_a_mass() -> None:
    law = law_of(-300.0 + 5j * OMEGA - 0.05 * OMEGA**2)
    assert parts(law) == pytest.approx({"stiffness": -300, "damping": 5, "mass": 0.05}, rel=0.02)
    assert law.unit == "N/m" and law.reading.left < 1e-3
    said = law.reading.in_words
    stiffness, damping, mass = (p.in_words for p in law.reading.parts)
    assert said == f"reads as {stiffness}, {damping} and {mass}"
    assert stiffness.endswith("N/m") and damping.endswith("N s/m") and mass.endswith("kg")
    # Where it turns all of it has other units.
    turning = law_of(200.0 - 0.02 * OMEGA**2, turns=True)
    assert turning.unit == "N m/rad"
    assert [p.unit for p in turning.reading.parts] == ["N m/rad", "N m s/rad", "kg m^2"]
    assert parts(turning)["inertia"] == pytest.approx(0.02, rel=0.02)


def test_a_part_that_is_not_there_is_not_told() -> None:
    law = law_of(5j * OMEGA, std=0.5)
    assert law.reading.in_words.startswith("reads as a damping of 5.")
    assert "stiffness" not in law.reading.in_words and "mass" not in law.reading.in_words


@pytest.mark.parametrize("gain", [1.1, -1.0, 0.4])
def test_on_a_channel_it_is_a_gain_and_a_delay_however_large(gain: float) -> None:
    law = law_of(gain * np.exp(-1j * OMEGA * 0.004) - 1, kind="sensor", std=0.01)
    assert law.unit == ""
    assert parts(law) == pytest.approx({"gain error": gain - 1, "delay": 0.004}, rel=0.05)
    assert law.reading.at(LINE) == pytest.approx(law.values, abs=0.06)


@pytest.mark.parametrize("gain", [1.4, 0.5, -1.0])
def test_on_the_force_channel_it_is_what_the_force_reads(gain: float) -> None:
    """All responses are divided by it: a force that reads 40 % too much makes them small, a late one early."""
    law = law_of(1 / (gain * np.exp(-1j * OMEGA * 0.004)) - 1, kind="drive", std=0.01)
    assert parts(law) == pytest.approx({"gain error": gain - 1, "delay": 0.004}, rel=0.05)
    assert law.reading.at(LINE) == pytest.approx(law.values, abs=0.06)


def test_where_a_channel_reads_next_to_nothing_its_gain_is_hardly_known() -> None:
    """Of a factor that falls from 1 to 0.05 the lines above would make a third of it missing in the mean."""
    x = np.log(LINE / LINE[0]) / np.log(LINE[-1] / LINE[0])
    assert parts(law_of(-0.95 * x**2 + 0j, kind="sensor", std=0.01))["gain error"] == pytest.approx(-0.18, abs=0.03)


def test_a_dead_channel_has_no_gain_and_numbers_for_all_that() -> None:
    law = law_of(-1.0 + 0j * LINE, kind="sensor")
    assert all(np.isfinite([p.value, p.std]).all() for p in law.reading.parts)


def test_what_the_parts_leave_makes_them_less_sharp() -> None:
    """An absorber above the band, with no spring at all: half of its mass is told as more, and known as little."""
    pole = (2 * np.pi * 45.0) ** 2
    law = law_of(-0.1 * OMEGA**2 * pole / (pole - OMEGA**2))
    mass = next(p for p in law.reading.parts if p.name == "mass")
    assert law.reading.tells and abs(mass.value - 0.1) < 3 * mass.std < 0.2


def test_a_value_has_no_more_digits_than_its_deviation() -> None:
    assert Part("stiffness", -301.4, 12.3, "N/m").in_words == "a stiffness of -300 ± 10 N/m"
    assert Part("inertia", 0.10632, 0.0021, "kg m^2").in_words == "an inertia of 0.106 ± 0.002 kg m^2"
    assert Part("delay", 0.0040023, 2e-5, "s").in_words == "a delay of 0.00400 ± 0.00002 s"
    assert Part("gain error", 0.5, 0.0, "").in_words.startswith("a gain error of 0.5")


def test_what_is_hardly_known_is_said_to_be_so() -> None:
    assert law_of(0 * LINE + 0j).reading.in_words == "is too little known to be read"


def test_what_is_nothing_simple_is_said_to_be_nothing_simple() -> None:
    """An absorber within the band: stiff below its frequency, and a mass the other way round above."""
    x = np.log(LINE / LINE[0]) / np.log(LINE[-1] / LINE[0])
    law = law_of(300 * np.sin(2 * np.pi * x) + 0j)
    assert not law.reading.tells
    assert law.reading.in_words == "reads as no stiffness, damping or mass at one place"
    bent = law_of(0.5 * np.sin(2 * np.pi * x) + 0j, kind="sensor", std=0.01)
    assert bent.reading.in_words == "reads as no gain error or delay at one place"


def test_lines_that_are_hardly_known_hardly_count() -> None:
    """Of a spring whose upper half something else spoils that is not known at all there."""
    spoiled = 300.0 + 2000.0 * (LINE > 15)
    std = np.where(LINE > 12, 1e4, 1.0)
    known = law_of(300.0 + 0j * LINE, std=std)
    sizes = known.sizes + np.linalg.lstsq(law_terms(LINE) / std[:, None], (spoiled - 300.0) / std, rcond=None)[0]
    law = FittedLaw(LINE, sizes, known.precision, "structure", False)
    below = LINE < 12
    assert np.abs(law.values[below] - 300).max() < 30
    assert parts(law)["stiffness"] == pytest.approx(300, abs=40)


def test_deviations_are_those_of_many_such_laws() -> None:
    """Values that err together are drawn, read, and as far apart as one of them says."""
    rng = np.random.default_rng(5)
    terms, lag = law_terms(LINE), 12
    # Errors that neighbours share: the law knows nothing of how it was weighed.
    kernel = np.exp(-0.5 * ((np.arange(LINE.size)[:, None] - np.arange(LINE.size)) / lag) ** 2)
    spread = np.linalg.pinv(terms) @ kernel @ np.linalg.pinv(terms).T * 4.0
    precision = np.kron(np.eye(2), np.linalg.inv(spread))
    root = np.linalg.cholesky(spread)
    true = np.linalg.lstsq(terms.astype(complex), 40.0 + 0.5j * OMEGA, rcond=None)[0]
    found, said = [], []
    for _ in range(300):
        noise = root @ (rng.standard_normal(TERMS) + 1j * rng.standard_normal(TERMS))
        law = FittedLaw(LINE, true + noise, precision, "structure", False)
        found.append([p.value for p in law.reading.parts])
        said.append([p.std for p in law.reading.parts])
    # What the parts leave of a law that errs is counted, too: never less, and here up to twice as much.
    ratio = np.sqrt(np.mean(np.square(said), axis=0)) / np.std(found, axis=0)
    assert (ratio > 0.9).all() and (ratio < 2.5).all()
    assert law.std.real == pytest.approx(np.sqrt(np.einsum("lj,jk,lk->l", terms, spread, terms)), rel=1e-6)


def test_its_document_has_the_curve_and_the_reading() -> None:
    law = law_of(-300.0 + 5j * OMEGA)
    told = law.document()
    assert told["unit"] == "N/m"
    curves = [np.array(told[k]) for k in ("frequency_hz", "real", "imaginary", "real_std", "imaginary_std")]
    assert {c.size for c in curves} == {33}
    assert curves[0][[0, -1]] == pytest.approx(LINE[[0, -1]])
    assert curves[2] == pytest.approx(2 * np.pi * curves[0] * 5, rel=0.03, abs=8)
    reads_as: Any = told["reads_as"]
    assert reads_as["damping"]["value"] == pytest.approx(5, rel=0.02)
    assert "damping" in repr(law)
