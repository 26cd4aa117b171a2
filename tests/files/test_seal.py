"""Damage of a campaign or truth file is told before libhdf5 parses it, which runs for ever over some of it."""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np
import pytest

from vgvt.data import Campaign, InputError
from vgvt.files import netcdf
from vgvt.files.campaign_file import read_campaign, read_manifest, write_campaign
from vgvt.files.seal import check_seal, seal
from vgvt.identification.example import Example

_SEAL_BYTES = 48


@pytest.fixture
def campaign() -> Campaign:
    return Example(sample_rate_hz=64.0, duration_s=2.0, sweep_s=1.0, band_hz=(3.0, 30.0)).campaign()


def test_an_emptied_heap_is_told_at_once(campaign: Campaign, tmp_path: Path) -> None:
    """libhdf5 takes the next object of a heap to lie no bytes further, and looks at it for ever."""
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    content = path.read_bytes()
    heap = content.index(b"GCOL")
    path.write_bytes(content[: heap + 40] + bytes(400) + content[heap + 440 :])
    for read in (read_campaign, read_manifest):
        with pytest.raises(InputError, match=r"c\.nc: damaged: its bytes are not(.|\n)*again"):
            read(path)


def test_no_damaged_byte_reaches_the_library(
    campaign: Campaign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    for at in rng.integers(0, len(content) - _SEAL_BYTES, 200):
        path.write_bytes(content[:at] + bytes([content[at] ^ int(rng.integers(1, 256))]) + content[at + 1 :])
        with pytest.raises(InputError, match=r"damaged|not a netCDF-4 file"):
            netcdf.check_netcdf(path)
            check_seal(path)


def test_an_end_that_never_arrived_is_told(campaign: Campaign, tmp_path: Path) -> None:
    """A copy that stopped leaves a file of the right size whose end is zeros, its seal among them."""
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    content = path.read_bytes()
    for missing in (1, 30, _SEAL_BYTES, 500, len(content) // 2):
        path.write_bytes(content[:-missing] + bytes(missing))
        with pytest.raises(InputError, match="damaged: its bytes are not those that were written"):
            read_campaign(path)
    for missing in (1, _SEAL_BYTES - 1, _SEAL_BYTES + 1, len(content) // 2, len(content) - 20):
        path.write_bytes(content[:-missing])
        with pytest.raises(InputError, match="damaged"):
            read_campaign(path)


def test_a_file_without_a_seal_is_read(campaign: Campaign, tmp_path: Path) -> None:
    path = tmp_path / "c.nc"
    write_campaign(path, campaign)
    os.truncate(path, path.stat().st_size - _SEAL_BYTES)
    assert read_campaign(path).name == campaign.name


def test_what_edits_a_file_breaks_or_removes_its_seal(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["x"] = np.arange(5.0)
    seal(path)
    check_seal(path)
    with h5py.File(path, "r") as file:
        np.testing.assert_array_equal(file["x"], np.arange(5.0))
    with h5py.File(path, "r+") as file:
        file["x"][2] = 7.0
    check_seal(path)
    assert b"sealed" not in path.read_bytes()
