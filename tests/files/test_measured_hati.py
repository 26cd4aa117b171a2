"""The measured Hati campaign, from the raw records and from the 200 Hz copy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import Campaign, FrequencyResponseSet, InputError
from vgvt.files import open_campaign
from vgvt.files.open import shipped_sidecar
from vgvt.signals import estimate_frf

pytestmark = pytest.mark.measured

# From the test's own log and the analysis of the records; one line of a 60 s record is 1/60 Hz.
PEAKS_HZ = (7.797, 19.058, 23.819, 31.784)
LINE_HZ = 1 / 60

RAW, COPY = "hati-2015-09-24", "hati-2015-09-24-200hz"


@pytest.fixture(scope="module", autouse=True)
def where(measured_folder: Path) -> Path:
    """Skips the module where the records are absent."""
    return measured_folder


@pytest.fixture(scope="module")
def campaigns(where: Path) -> dict[str, Campaign]:
    """Both forms of the campaign that are on this machine."""
    found = {}
    for name in (RAW, COPY):
        try:
            found[name] = open_campaign(name)
        except InputError as error:
            if "not on this machine" not in error.problem:
                raise
    return found


@pytest.fixture(scope="module")
def responses(campaigns: dict[str, Campaign]) -> dict[str, FrequencyResponseSet]:
    """Accelerances of both, in the excited band."""
    return {name: estimate_frf(c, band_hz=(2.0, 34.5)) for name, c in campaigns.items()}


def of(name: str, found: dict) -> object:
    """The entry, or a skip with the reason."""
    if name not in found:
        pytest.skip(f"{name} is not on this machine")
    return found[name]


@pytest.mark.parametrize("name", [RAW, COPY])
def test_records_have_the_channels_of_the_test_log(campaigns: dict[str, Campaign], name: str) -> None:
    campaign = of(name, campaigns)
    assert len(campaign.runs) == 10
    assert [str(d) for d in campaign.response_dofs] == [f"{n}+Z" for n in range(1, 21)]
    assert [str(d) for d in campaign.reference_dofs] == ["100+Z"]
    assert all(r.duration_s == pytest.approx(60.0, abs=0.01) for r in campaign.runs)


@pytest.mark.parametrize("name", [RAW, COPY])
@pytest.mark.parametrize("peak_hz", PEAKS_HZ)
def test_sigma_plot_peaks_where_the_log_says(
    responses: dict[str, FrequencyResponseSet], name: str, peak_hz: float
) -> None:
    frf = of(name, responses)
    near = frf.band(peak_hz - 0.3, peak_hz + 0.3)
    assert near.frequency_hz[near.sigma().argmax()] == pytest.approx(peak_hz, abs=LINE_HZ)


def sixty_seconds(campaign: Campaign) -> Campaign:
    """The first 60 s of every run: both forms then share their frequency lines."""
    runs = tuple(replace(r, samples=r.samples[:, : round(60 * r.sample_rate_hz)]) for r in campaign.runs)
    return replace(campaign, runs=runs)


def test_raw_records_and_decimated_copy_agree(campaigns: dict) -> None:
    raw, copy = (sixty_seconds(of(name, campaigns)) for name in (RAW, COPY))
    one, other = (estimate_frf(c, band_hz=(3.0, 34.0)) for c in (raw, copy))
    np.testing.assert_allclose(one.frequency_hz, other.frequency_hz, rtol=1e-12)
    lines = np.round(one.frequency_hz * 60).astype(int)
    force = {r.run: np.abs(np.fft.rfft(r.samples[1] - r.samples[1].mean()))[lines] for r in raw.runs}
    # Weighed with the force of its run, a difference of responses is one of accelerations. Unweighed, the
    # notch of the force at 9.15 Hz (some 100 times below its neighbours) would drown everything else.
    weight = np.array([force[run] for run in one.runs])
    difference = weight * (one.values - other.values)[:, 0]
    assert np.linalg.norm(difference) < 0.02 * np.linalg.norm(weight * one.values[:, 0])


def test_below_the_elastic_modes_the_aircraft_moves_as_one_mass(responses: dict) -> None:
    frf = of(RAW, responses).band(2.0, 4.0)
    # Heave and pitch/roll about the centre of gravity: near it A/F is about 1/m, and in phase with the force.
    mean = frf.values[:, 0].real.mean()
    assert mean == pytest.approx(1 / 6.24, rel=0.3)


def test_a_truncated_copy_of_a_real_record_says_so(where: Path, tmp_path: Path) -> None:
    source = where / "raw" / "run_Run1.mat"
    if not source.is_file():
        pytest.skip("the raw records are not on this machine")
    raw = tmp_path / "raw"
    raw.mkdir()
    content = source.read_bytes()
    (raw / "run_Run1.mat").write_bytes(content[: len(content) // 2])
    sidecar = shipped_sidecar(RAW).read_text(encoding="utf-8").replace('dataset = "hati-2015-09-24"\n', "")
    (tmp_path / "hati.toml").write_text(sidecar, encoding="utf-8")
    with pytest.raises(InputError, match=r"run_Run1\.mat: truncated or damaged"):
        open_campaign(tmp_path / "hati.toml")
