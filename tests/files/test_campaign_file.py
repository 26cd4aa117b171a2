"""The campaign file: nothing is lost, and damage is told."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Geometry, InputError, Quantity, Record
from vgvt.files import open_campaign, read_campaign, read_manifest, write_campaign
from vgvt.files.campaign_file import content_hash


def assert_same(first: Campaign, second: Campaign) -> None:
    """Equal in every field, samples bit for bit and in the same precision."""
    assert (first.name, first.notes, tuple(first.band_hz)) == (second.name, second.notes, second.band_hz)
    assert (first.geometry.nodes, first.geometry.lines) == (second.geometry.nodes, second.geometry.lines)
    np.testing.assert_array_equal(first.geometry.positions_m, second.geometry.positions_m)
    for one, other in zip(first.geometry.outline_m, second.geometry.outline_m, strict=True):
        np.testing.assert_array_equal(one, other)
    for one, other in zip(first.runs, second.runs, strict=True):
        assert (one.run, one.sample_rate_hz, one.channels) == (other.run, other.sample_rate_hz, other.channels)
        assert (one.overloaded, one.notes) == (other.overloaded, other.notes)
        assert one.samples.dtype == other.samples.dtype
        np.testing.assert_array_equal(one.samples, other.samples)


def test_a_campaign_comes_back_as_it_was(campaign: Campaign, tmp_path: Path) -> None:
    write_campaign(tmp_path / "campaign.nc", campaign)
    assert_same(campaign, read_campaign(tmp_path / "campaign.nc"))
    assert_same(campaign, open_campaign(tmp_path))
    assert_same(campaign, open_campaign(str(tmp_path / "campaign.nc")))


def test_samples_that_are_not_finite_come_back_too(campaign: Campaign, tmp_path: Path) -> None:
    samples = campaign.runs[0].samples.copy()
    samples[1, :3] = np.nan, np.inf, -0.0
    odd = replace(campaign, runs=(replace(campaign.runs[0], samples=samples),))
    write_campaign(tmp_path / "c.nc", odd)
    assert_same(odd, read_campaign(tmp_path / "c.nc"))


def test_the_manifest_comes_back_and_says_how_the_file_was_made(campaign: Campaign, tmp_path: Path) -> None:
    facts = {"scenario": "quick", "seed": 7, "text": "x" * 200_000, "nested": {"a": [1, 2.5, None]}}
    write_campaign(tmp_path / "c.nc", campaign, facts)
    manifest = read_manifest(tmp_path / "c.nc")
    assert {k: manifest[k] for k in facts} == facts
    assert manifest["format"] == "vgvt campaign"
    assert manifest["content_sha256"] == content_hash(campaign)
    assert {"created", "vgvt_version", "format_version"} <= set(manifest)


def test_the_hash_depends_on_every_sample_and_label(campaign: Campaign) -> None:
    samples = campaign.runs[1].samples.copy()
    samples[-1, -1] = np.nextafter(samples[-1, -1], np.float32(np.inf))
    turned = replace(campaign.runs[1].channels[0], dof=Dof.from_label("9-Z"))
    changed = [
        replace(campaign, runs=(campaign.runs[0], replace(campaign.runs[1], samples=samples))),
        replace(
            campaign,
            runs=(campaign.runs[0], replace(campaign.runs[1], channels=(turned, campaign.runs[1].channels[1]))),
        ),
        replace(campaign, name="other"),
        replace(campaign, runs=campaign.runs[::-1]),
    ]
    assert len({content_hash(c) for c in [campaign, *changed]}) == 5


def test_an_interrupted_write_leaves_the_old_file_and_no_rubbish(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    too_wide = replace(campaign.runs[1], samples=campaign.runs[1].samples.astype(np.longdouble))
    with pytest.raises(InputError, match="without loss"):
        write_campaign(path, replace(campaign, runs=(campaign.runs[0], too_wide)))
    assert_same(campaign, read_campaign(path))
    assert [p.name for p in tmp_path.iterdir()] == ["c.nc"]


def test_a_place_that_cannot_be_written_is_bad_input(campaign: Campaign, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot be written"):
        write_campaign(tmp_path / "file" / "c.nc", campaign)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.5, 0.99])
def test_a_truncated_file_says_so(campaign: Campaign, tmp_path: Path, share: float) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(len(whole) * share)])
    with pytest.raises(InputError, match=r"truncated|damaged|empty") as caught:
        read_campaign(path)
    assert caught.value.where == str(path)
    assert "again" in caught.value.advice


def test_a_changed_sample_is_recognised(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    with h5py.File(path, "r+") as file:
        file["run_4/samples"][1, 100] += 1e-3
    with pytest.raises(InputError, match="does not match its SHA-256"):
        read_campaign(path)


def test_a_flipped_byte_anywhere_in_the_samples_is_recognised(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    with h5py.File(path, "r") as file:
        chunk = file["run_1/samples"].id.get_chunk_info(0)
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 0x40
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"damaged|SHA-256"):
        read_campaign(path)


@pytest.mark.parametrize("name", ["samples", "sensitivity_v_per_unit", "dof"])
def test_a_missing_variable_is_named(campaign: Campaign, tmp_path: Path, name: str) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    with h5py.File(path, "r+") as file:
        del file["run_4"][name]
    with pytest.raises(InputError, match=f"run_4: '{name}' is missing"):
        read_campaign(path)


def test_a_missing_run_is_named(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    with h5py.File(path, "r+") as file:
        del file["run_4"]
    with pytest.raises(InputError, match="run_4"):
        read_campaign(path)


@pytest.mark.parametrize(("key", "value"), [("role", "observer"), ("dof", "nose"), ("quantity", 99)])
def test_a_label_that_means_nothing_is_told(campaign: Campaign, tmp_path: Path, key: str, value: object) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    with h5py.File(path, "r+") as file:
        file[f"run_1/{key}"][0] = value
    with pytest.raises(InputError, match="damaged"):
        read_campaign(path)


def test_other_files_are_told_apart(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    with pytest.raises(InputError, match="no such file"):
        read_campaign(path)
    path.write_text("time,force\n0,1\n")
    with pytest.raises(InputError, match="not a netCDF-4 file"):
        read_campaign(path)
    with h5py.File(path, "w") as file:
        file.attrs["title"] = "someone else's data"
    with pytest.raises(InputError, match="its format is None"):
        read_campaign(path)
    write_campaign(path, campaign)
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(InputError, match=r"version 99(.|\n)*update vgvt"):
        read_campaign(path)


@pytest.mark.slow
def test_a_full_campaign_is_handled_without_piling_up_copies(tmp_path: Path) -> None:
    from vgvt.signals import estimate_frf

    generator = np.random.default_rng(0)
    drive = Channel("drive", Quantity.GENERAL, ChannelRole.DRIVE)
    force = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof.from_label("100+Z"))
    runs = []
    for k in range(10):
        acc = [
            Channel(f"a{i}", Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof.from_label(f"{2 * k + i}+Z"))
            for i in (1, 2)
        ]
        runs.append(Record(k + 1, 2000.0, (drive, force, *acc), generator.standard_normal((4, 120_001))))
    nodes = (*range(1, 21), 100)
    full = Campaign("full", Geometry(nodes, np.zeros((21, 3))), tuple(runs), (1.0, 35.0))
    size = sum(r.samples.nbytes for r in runs)
    # The libraries come in with the first call, whichever test makes it; they are not what is measured.
    brief = Campaign("brief", full.geometry, tuple(replace(r, samples=r.samples[:, :4000]) for r in runs), (1.0, 35.0))
    write_campaign(tmp_path / "brief.nc", brief)
    estimate_frf(read_campaign(tmp_path / "brief.nc"), band_hz=(1.0, 35.0), local_variance=True)
    peak = {}
    for name, work in {
        "write": lambda: write_campaign(tmp_path / "c.nc", full),
        "read": lambda: read_campaign(tmp_path / "c.nc"),
        "estimate": lambda: estimate_frf(full),
        "band": lambda: estimate_frf(full, band_hz=(1.0, 35.0), local_variance=True),
    }.items():
        tracemalloc.start()
        work()
        peak[name] = tracemalloc.get_traced_memory()[1] / size
        tracemalloc.stop()
    assert peak["write"] < 0.5
    assert peak["read"] < 1.5
    assert peak["estimate"] < 3.0
    assert peak["band"] < 1.0
