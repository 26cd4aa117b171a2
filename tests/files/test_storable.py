"""What a file cannot hold of a campaign is told with its place and what to write; nothing of it is written or lost."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich_campaign import rich_campaign
from scipy.io import loadmat

from vgvt.data import Campaign, Dof, FrequencyResponseSet, Geometry, InputError
from vgvt.files import write_campaign
from vgvt.files.campaign_file import read_campaign
from vgvt.files.export.campaign import export_campaign
from vgvt.files.export.responses import export_responses
from vgvt.files.npz import read_npz
from vgvt.files.open import open_campaign
from vgvt.files.uff.describe import describe_uff
from vgvt.files.uff.read import read_uff

HALF, NUL = "a\udce9b", "a\0b"
FORMS = ["x.nc", "x.uff", "x.mat", "x.csv"]


def simple(samples: Any = float, **changes: Any) -> Campaign:
    """One run of the rich campaign, in whose place others can be put."""
    campaign = rich_campaign()
    record = replace(campaign.runs[1], samples=np.round(100 * campaign.runs[1].samples).astype(samples))
    return replace(campaign, **{"runs": (record,), **changes})


def channel_changed(**changes: Any) -> Campaign:
    record = simple().runs[0]
    first, second, *others = record.channels
    return simple(runs=(replace(record, channels=(first, replace(second, **changes), *others)),))


def run_changed(**changes: Any) -> Campaign:
    return simple(runs=(replace(simple().runs[0], **changes),))


def numbered(*nodes: int) -> Campaign:
    """The nodes 1 and 2 by other numbers."""
    campaign = simple()
    new = dict(zip((1, 2), nodes, strict=False))
    geometry, record = campaign.geometry, campaign.runs[0]
    channels = tuple(
        c if c.dof is None else replace(c, dof=Dof(new.get(c.dof.node, c.dof.node), c.dof.direction))
        for c in record.channels
    )
    moved = Geometry(
        tuple(new.get(n, n) for n in geometry.nodes),
        geometry.positions_m,
        tuple(tuple(new.get(n, n) for n in line) for line in geometry.lines),
    )
    return simple(geometry=moved, runs=(replace(record, channels=channels),))


def refused(campaign: Campaign, path: Path, words: str) -> None:
    with pytest.raises(InputError, match=words):
        export_campaign(campaign, path)
    assert not list(path.parent.iterdir())


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("campaign", "place"),
    [
        (simple(name=HALF), "name"),
        (channel_changed(name=HALF), "run 3, name of channel 2"),
        (channel_changed(unit=HALF), "run 3, unit of channel 2"),
        (simple(notes={"sky": HALF}), "note 'sky'"),
        (simple(notes={HALF: "blue"}), "name of note 'a"),
        (run_changed(notes=("fine", HALF)), "run 3, note 2"),
        (run_changed(overloaded=(HALF,)), "run 3, overloaded"),
    ],
)
def test_half_a_character(tmp_path: Path, form: str, campaign: Campaign, place: str) -> None:
    """As it comes of file names whose bytes are not UTF-8; notes of a campaign.nc have an escape for it."""
    path = tmp_path / form
    if form == "x.nc" and "name of channel" not in place and "unit" not in place and place != "name":
        export_campaign(campaign, path)
        again = read_campaign(path)
        assert (again.notes, again.runs[0].notes) == (campaign.notes, campaign.runs[0].notes)
        return
    refused(campaign, path, rf"{form}: {place}.*: .* holds U\+DCE9, half a character.*\n  write .*'a\?b'")


@pytest.mark.parametrize("campaign", [simple(name=NUL), channel_changed(name=NUL), channel_changed(unit=NUL)])
def test_a_nul_in_a_name(tmp_path: Path, campaign: Campaign) -> None:
    """HDF5 has none; a sidecar has an escape for it, and a heading of text a blank."""
    with pytest.raises(InputError, match=r"x\.nc: .* holds a NUL.*\n  leave it out: 'ab'"):
        write_campaign(tmp_path / "x.nc", campaign)
    assert not list(tmp_path.iterdir())
    if campaign.runs[0].channels[1].unit == NUL:
        return
    for form in FORMS[1:]:
        again = open_campaign(str(export_campaign(campaign, tmp_path / form).sidecar))
        assert again.name == campaign.name
        assert again.runs[0].channels[1].name == campaign.runs[0].channels[1].name
    assert b"\0" not in (tmp_path / "x.csv").read_bytes()


@pytest.mark.parametrize(
    ("form", "largest"), [("x.uff", 10**10 - 1), ("x.mat", 2**53), ("x.nc", 2**63 - 1), ("x.csv", 2**63 - 1)]
)
def test_numbers_of_nodes(tmp_path: Path, form: str, largest: int) -> None:
    """As other programs read them; one more is told where that would be another number."""
    fits = numbered(largest, largest - 1)
    exported = export_campaign(fits, tmp_path / form)
    assert open_campaign(str(exported.sidecar or exported.files[0])).geometry.nodes == fits.geometry.nodes
    if form == "x.uff":
        # By columns, as FORTRAN reads them: pyuff joins lines, and takes ten digits for the end of the number before.
        rows = (tmp_path / form).read_bytes().partition(b"\n    15\n")[2].splitlines()[: len(fits.geometry.nodes)]
        assert tuple(int(row[:10]) for row in rows) == fits.geometry.nodes
        # Ten digits beside ten have no blank between.
        assert read_uff(tmp_path / form).geometry().lines == fits.geometry.lines
    if form == "x.mat":
        assert tuple(map(int, loadmat(tmp_path / form)["node"].ravel())) == fits.geometry.nodes
    if form != "x.csv":
        (tmp_path / "beyond").mkdir()
        refused(numbered(largest + 1), tmp_path / "beyond" / form, f"{form}: node {largest + 1}: .* up to {largest}\n")


def test_numbers_of_nodes_beside_frequency_responses(tmp_path: Path) -> None:
    campaign = numbered(10**10)
    dofs = (Dof.from_label("10000000000+Z"),)
    frf = FrequencyResponseSet(dofs, (Dof.from_label("9+Z"),), np.array([1.0, 2.0]), np.ones((1, 1, 2), complex), (1,))
    with pytest.raises(InputError, match=r"x\.uff: node 10000000000"):
        export_responses(frf, tmp_path / "x.uff", "wing", campaign.geometry)
    wide = replace(frf, values=frf.values.astype(np.clongdouble))
    for form in ("x.csv", "x.mat", "x.uff"):
        with pytest.raises(InputError, match=r"frequency responses of type .* without loss"):
            export_responses(wide, tmp_path / form, "wing", simple().geometry)
        with pytest.raises(InputError, match=r"name: .* half a character"):
            export_responses(frf, tmp_path / form, HALF, simple().geometry)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("samples", "words"),
    [
        (simple(np.longdouble).runs[0].samples / 3, r"run 3: samples of type .* without loss\n.*astype\(float\)"),
        (simple(np.int64).runs[0].samples + 2**60 + 1, r"run 3: samples are whole numbers beyond 2\*\*53"),
        (simple(complex).runs[0].samples, "run 3: samples are complex"),
        (simple(object).runs[0].samples, "run 3: samples are of type object"),
    ],
)
def test_samples_that_64_bit_do_not_hold(tmp_path: Path, form: str, samples: Any, words: str) -> None:
    if samples.dtype.kind == "f" and samples.dtype.itemsize == 8:
        pytest.skip("a long double is a double here")
    refused(run_changed(samples=samples), tmp_path / form, words)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", ["i2", "i4", "u4", "i8", "f2", "f4", ">f8", "?"])
def test_all_other_samples_come_back_as_they_were(tmp_path: Path, form: str, kind: str) -> None:
    """Whole numbers of 32 bits, which singles round, among them."""
    samples = simple(kind).runs[0].samples
    if kind in ("i4", "u4", "i8"):
        samples[0, :3] = 2**30 + 1
    exported = export_campaign(run_changed(samples=samples), tmp_path / form)
    again = open_campaign(str(exported.sidecar or exported.files[0])).runs[0].samples
    np.testing.assert_array_equal(again, samples.astype(float))


def test_an_archive_of_long_doubles(tmp_path: Path) -> None:
    """Which had been rounded, and those beyond doubles made infinite."""
    if np.dtype(np.longdouble).itemsize == 8:
        pytest.skip("a long double is a double here")
    np.savez(tmp_path / "x.npz", a=np.array([np.longdouble("1e400")]))
    with pytest.raises(InputError, match=r"x\.npz: numbers of array 'a' of type .* without loss"):
        read_npz(tmp_path / "x.npz", ["a"])


def test_names_of_files_that_are_not_utf_8(tmp_path: Path) -> None:
    """Of a Linux disk from another time: told before anything is written, and not by where a codec gave up."""
    odd = tmp_path / os.fsdecode(b"w\xe9.uff")
    try:
        odd.touch()
    except OSError:
        pytest.skip("this disk has names in UTF-8 alone")
    odd.unlink()
    with pytest.raises(InputError, match=r"its name 'w\\udce9\.uff' is not in UTF-8"):
        export_campaign(simple(), odd)
    assert not list(tmp_path.iterdir())
    export_campaign(simple(), tmp_path / "x.uff")
    (tmp_path / "x.uff").rename(odd)
    (tmp_path / "x.toml").unlink()
    with pytest.raises(InputError, match=r"its name 'w\\udce9\.uff' is not in UTF-8.*\n  rename it"):
        describe_uff([odd], tmp_path / "new.toml")
    assert list(tmp_path.iterdir()) == [odd]
