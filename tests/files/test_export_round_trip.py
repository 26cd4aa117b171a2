"""A campaign in another format and back: the same, to the rounding of the format's own numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich_campaign import rich_campaign, single_precision

from vgvt.data import Campaign, Quantity
from vgvt.files import open_campaign, read_manifest
from vgvt.files.export import campaign as export
from vgvt.files.export.campaign import export_campaign, planned_files
from vgvt.files.export.form import Form
from vgvt.files.uff.describe import describe_uff

FORMS = [("x.uff", False), ("x.unv", True), ("x.mat", False), ("x.csv", False), ("x.nc", False)]


def same(read: Campaign, campaign: Campaign, accuracy: float) -> None:
    assert (read.name, read.band_hz, read.notes) == (campaign.name, campaign.band_hz, campaign.notes)
    assert read.geometry.nodes == campaign.geometry.nodes
    assert read.geometry.lines == campaign.geometry.lines
    np.testing.assert_array_equal(read.geometry.positions_m, campaign.geometry.positions_m)
    for one, other in zip(read.geometry.outline_m, campaign.geometry.outline_m, strict=True):
        np.testing.assert_array_equal(one, other)
    for one, other in zip(read.runs, campaign.runs, strict=True):
        assert one.channels == other.channels
        assert (one.run, one.sample_rate_hz, one.overloaded) == (other.run, other.sample_rate_hz, other.overloaded)
        assert sorted(one.notes) == sorted(other.notes)
        np.testing.assert_allclose(one.samples, other.samples, rtol=accuracy, atol=0)


@pytest.mark.parametrize(("name", "text"), FORMS)
@pytest.mark.parametrize("runs", [1, 2])
def test_it_comes_back_as_it_was(tmp_path: Path, name: str, text: bool, runs: int) -> None:
    campaign = rich_campaign()
    campaign = replace(campaign, runs=campaign.runs[:runs])
    exported = export_campaign(campaign, tmp_path / "new" / name, text=text)
    assert exported.remarks == ()
    written = [*exported.files, *([exported.sidecar] if exported.sidecar else [])]
    assert sorted(written) == sorted((tmp_path / "new").iterdir())
    assert tuple(written) == planned_files(campaign, tmp_path / "new" / name)
    read = open_campaign(exported.sidecar or exported.files[0])
    same(read, campaign, 1e-12 if text else 0.0)


@pytest.mark.parametrize(
    ("name", "text", "accuracy", "kind"),
    [
        ("x.uff", False, 0.0, np.float32),
        ("x.unv", True, 1e-12, np.float64),
        ("x.mat", False, 0.0, np.float32),
        ("x.csv", False, 1e-8, np.float64),
        ("x.nc", False, 0.0, np.float32),
    ],
)
def test_single_precision_stays_as_exact_as_it_was(
    tmp_path: Path, name: str, text: bool, accuracy: float, kind: type
) -> None:
    campaign = single_precision(rich_campaign())
    exported = export_campaign(campaign, tmp_path / name, text=text)
    read = open_campaign(exported.sidecar or exported.files[0])
    same(read, campaign, accuracy)
    assert {record.samples.dtype for record in read.runs} == {np.dtype(kind)}
    for one, other in zip(read.runs, campaign.runs, strict=True):
        np.testing.assert_array_equal(one.samples.astype(np.float32), other.samples)


def test_a_file_by_itself_says_what_it_can(tmp_path: Path) -> None:
    """Without the sidecar that was written: units, places, lines and directions come from the Universal File."""
    campaign = rich_campaign()
    first = campaign.runs[0]
    keep = [1, 2]
    run = replace(first, channels=tuple(first.channels[k] for k in keep), samples=first.samples[keep, 20:])
    export_campaign(replace(campaign, runs=(run,)), tmp_path / "x.uff")
    description = describe_uff([tmp_path / "x.uff"], tmp_path / "again.toml")
    assert description.missing == ()
    read = open_campaign(tmp_path / "again.toml")
    assert [str(channel.dof) for channel in read.runs[0].channels] == ["9+Z", "1+Z"]
    np.testing.assert_array_equal(read.runs[0].samples, run.samples)
    assert read.runs[0].sample_rate_hz == 1652.5
    np.testing.assert_allclose(read.geometry.positions_m, campaign.geometry.positions_m, rtol=1e-5)
    assert read.geometry.lines == campaign.geometry.lines


@pytest.mark.parametrize(("name", "text"), FORMS[:4])
def test_samples_that_are_not_finite_need_no_note(tmp_path: Path, name: str, text: bool) -> None:
    """As of campaigns from Python; reading tells of them, beside the notes that were there, an empty one among them."""
    campaign = rich_campaign()
    first, second = campaign.runs
    samples = second.samples.copy()
    samples[2, 5] = np.inf
    second = replace(second, samples=samples, notes=("a2 é: 1 of 900 samples are not finite", ""))
    exported = export_campaign(replace(campaign, runs=(first, second)), tmp_path / name, text=text)
    read = open_campaign(exported.sidecar or name).runs[1]
    assert read.notes == (*second.notes, "a2 é: 1 of 77 samples are not finite")
    np.testing.assert_allclose(read.samples, samples, rtol=1e-12)


@pytest.mark.parametrize(("name", "text"), FORMS)
def test_a_run_of_one_sample_comes_back(tmp_path: Path, name: str, text: bool) -> None:
    campaign = rich_campaign()
    campaign = replace(campaign, runs=(replace(campaign.runs[1], samples=campaign.runs[1].samples[:, :1]),))
    exported = export_campaign(campaign, tmp_path / name, text=text)
    same(open_campaign(exported.sidecar or exported.files[0]), campaign, 1e-12 if text else 0.0)


@pytest.mark.parametrize(("name", "text"), FORMS[:4])
def test_numbers_of_numpy_are_numbers(tmp_path: Path, name: str, text: bool) -> None:
    """A rate is often 1 / np.mean(np.diff(t)); of it no sidecar had been made, for the truth value of an array."""
    campaign = rich_campaign()
    geometry, band = campaign.geometry, campaign.band_hz
    numpy_ones = replace(
        campaign,
        runs=tuple(replace(r, run=np.int64(r.run), sample_rate_hz=np.float64(r.sample_rate_hz)) for r in campaign.runs),
        geometry=replace(geometry, nodes=tuple(map(np.int64, geometry.nodes))),
        band_hz=(np.float64(band[0]), np.float64(band[1])),
    )
    exported = export_campaign(numpy_ones, tmp_path / name, text=text)
    assert exported.remarks == ()
    same(open_campaign(exported.sidecar or name), campaign, 1e-12 if text else 0.0)


def test_a_manifest_goes_into_a_campaign_file(tmp_path: Path) -> None:
    exported = export_campaign(rich_campaign(), tmp_path / "x.nc", manifest={"converted_from": "y.toml"})
    assert exported.form is Form.CAMPAIGN
    assert read_manifest(tmp_path / "x.nc")["converted_from"] == "y.toml"


def test_sensitivities_are_said_to_be_lost(tmp_path: Path) -> None:
    campaign = rich_campaign()
    channels = list(campaign.runs[0].channels)
    channels[2] = replace(channels[2], sensitivity_v_per_unit=0.1)
    channels[3] = replace(channels[3], range_v=10.0)
    runs = (replace(campaign.runs[0], channels=tuple(channels)), campaign.runs[1])
    exported = export_campaign(replace(campaign, runs=runs), tmp_path / "x.mat")
    assert exported.remarks == ("samples are in SI: sensitivities and full scales do not come back (a1, vel)",)


def without_one(campaign: Campaign) -> Campaign:
    first, second = campaign.runs
    return replace(campaign, runs=(first, replace(second, channels=second.channels[1:], samples=second.samples[1:])))


def with_reaction(campaign: Campaign) -> Campaign:
    def reacting(run):
        channels = list(run.channels)
        channels[1] = replace(channels[1], quantity=Quantity.REACTION_FORCE)
        return replace(run, channels=tuple(channels))

    return replace(campaign, runs=tuple(map(reacting, campaign.runs)))


def in_gravities(campaign: Campaign) -> Campaign:
    def scaled(run):
        return replace(run, channels=(*run.channels[:2], replace(run.channels[2], unit="g"), *run.channels[3:]))

    return replace(campaign, runs=tuple(map(scaled, campaign.runs)))


def twice_at_one_place(campaign: Campaign) -> Campaign:
    def moved(run):
        return replace(run, channels=(*run.channels[:4], replace(run.channels[4], dof=run.channels[3].dof)))

    return replace(campaign, runs=tuple(map(moved, campaign.runs)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (without_one, "run 3 has other channels than run 7"),
        (with_reaction, "force, left measures reaction force"),
        (in_gravities, "a1 is in g, and not in SI"),
        (lambda campaign: replace(campaign, band_hz=(0.0, 3.0)), "its band begins at 0 Hz"),
        (twice_at_one_place, "run 7: vel and disp are both responses at 3+RX"),
    ],
)
@pytest.mark.parametrize("name", ["x.uff", "x.mat", "x.csv"])
def test_what_no_sidecar_says_is_written_without_one(tmp_path: Path, name: str, change, words: str) -> None:
    exported = export_campaign(change(rich_campaign()), tmp_path / name)
    (remark,) = exported.remarks
    assert remark.startswith("no sidecar was written") and words in remark
    assert exported.sidecar is None
    assert sorted(exported.files) == sorted(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x.uff", "x.mat", "x.csv"])
def test_what_reads_back_otherwise_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """As with a disk that lies: the records are read once before they take their names."""
    write = export._write

    def wrong(campaign: Campaign, *rest: object) -> None:
        second = campaign.runs[1]
        samples = second.samples * (1 + 1e-6 * (np.arange(77) == 60))
        write(replace(campaign, runs=(campaign.runs[0], replace(second, samples=samples))), *rest)

    (tmp_path / name).write_text("mine")
    monkeypatch.setattr(export, "_write", wrong)
    with pytest.raises(RuntimeError, match=r"a sample of run 3 reads back otherwise"):
        export_campaign(rich_campaign(), tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "mine"
