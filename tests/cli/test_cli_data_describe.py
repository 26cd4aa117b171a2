"""``vgvt data describe``, and what follows it: the modes of a campaign in Universal Files are those of its npz twin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tdms_by_nptdms import rows_of, write_tdms
from uff_by_hand import binary_58, nodes_2411, text_58, units_164

from vgvt.data import Campaign


def plate_in_one_file(campaign: Campaign, *, binary: bool) -> bytes:
    """Every run of the campaign, one behind the other."""
    write = binary_58 if binary else text_58
    places = {
        node: tuple(map(float, position))
        for node, position in zip(campaign.geometry.nodes, campaign.geometry.positions_m, strict=True)
    }
    content = (units_164(1.0, 1.0) + nodes_2411(places)).encode()
    for run in campaign.runs:
        for channel, samples in zip(run.channels, run.samples, strict=True):
            assert channel.dof is not None
            dataset = write(
                np.asarray(samples, dtype=float),
                dof=(channel.dof.node, int(channel.dof.direction)),
                code=int(channel.quantity),
                unit="NONE",
                increment=1 / run.sample_rate_hz,
            )
            content += dataset if isinstance(dataset, bytes) else dataset.encode()
    return content


@pytest.mark.parametrize("binary", [True, False])
def test_the_modes_are_those_of_the_npz_twin(vgvt, tmp_path: Path, plate_campaign: Campaign, binary: bool) -> None:
    (tmp_path / "plate.uff").write_bytes(plate_in_one_file(plate_campaign, binary=binary))
    assert vgvt("data", "describe", "plate.uff", "--band", 3, 20).status == 0
    channels = range(len(plate_campaign.runs[0].channels))
    np.savez("plate.npz", data=np.array([[run.samples[k] for k in channels] for run in plate_campaign.runs]))
    text = Path("plate.toml").read_text()
    (hashed,) = (line for line in text.splitlines() if line.startswith("sha256"))
    text = text.replace(hashed, "").replace('"plate.uff"', '"plate.npz"')
    Path("twin.toml").write_text(
        text.replace('format = "uff"', 'format = "npz"\nsamples = "data"\nchannels_are = "rows"')
    )
    read, twin = (vgvt("identify", name, "--json").document for name in ("plate.toml", "twin.toml"))
    assert read["outcome"] == "found"
    assert [mode["frequency_hz"] for mode in read["modes"]] == pytest.approx([6.3, 13.7], rel=5e-3)
    for one, other in zip(read["modes"], twin["modes"], strict=True):
        accuracy = 0 if binary else 1e-8
        for key in ("frequency_hz", "damping_ratio"):
            assert one[key] == pytest.approx(other[key], rel=accuracy, abs=0)
        assert [point["dof"] for point in one["shape"]] == [point["dof"] for point in other["shape"]]
        shapes = [[complex(p["real"], p["imag"]) for p in mode["shape"]] for mode in (one, other)]
        np.testing.assert_allclose(shapes[0], shapes[1], rtol=0, atol=accuracy * np.abs(shapes[1]).max())


SMALL = nodes_2411({1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0)}) + "".join(
    text_58([1.0, -2.0] * 100, dof=(1, 3), code=code, unit=unit) for code, unit in ((13, "N"), (12, "g"))
)


@pytest.fixture
def small(vgvt, tmp_path: Path) -> Path:
    path = tmp_path / "small.uff"
    path.write_text(SMALL)
    return path


def test_one_object_that_says_what_was_found(vgvt, small: Path) -> None:
    document = vgvt("data", "describe", small, "--json").document
    assert document["sidecar"] == str(small.with_suffix(".toml"))
    assert document["band_hz"] == [3.91, 39.1]
    assert document["runs"] == [
        {"run": 1, "file": str(small), "index": None, "first": 1, "last": 2, "samples": 200, "sample_rate_hz": 100.0}
    ]
    assert document["channels"][1] == {
        "name": "acc",
        "role": "response",
        "quantity": "acceleration",
        "unit": "g",
        "column": 2,
        "variable": None,
        "dofs": ["1+Z"],
    }
    assert document["missing"] == []
    assert document["remarks"] == ["small.uff: taken as one run"]


def test_words_that_say_how_to_go_on(vgvt, small: Path) -> None:
    result = vgvt("data", "describe", "small.uff", "--axes", "y", "-x", "z")
    assert result.status == 0
    assert "small.uff: taken as one run" in result.out
    assert "small.toml describes 1 run of 2 channels" in result.out
    assert "vgvt inspect small.toml" in result.out
    assert vgvt("inspect", "small.toml").status == 0
    small.write_text(SMALL.replace("N    ", "?    "))
    result = vgvt("data", "describe", small, "--force")
    assert result.status == 0
    assert "still to be written in it: force: its unit (the file says '?')" in result.out
    assert vgvt("inspect", "small.toml").status == 2


def test_a_sidecar_that_is_there_stays_until_it_may_go(vgvt, small: Path) -> None:
    sidecar = small.with_suffix(".toml")
    sidecar.write_text("mine")
    result = vgvt("data", "describe", small, "--json")
    assert result.status == 2
    assert result.document["error"]["where"] == str(sidecar)
    assert "--force" in result.document["error"]["advice"]
    assert sidecar.read_text() == "mine"
    assert vgvt("data", "describe", small, "--out", "other/place.toml").status == 0
    assert vgvt("inspect", "other/place.toml").status == 0
    assert vgvt("data", "describe", small, "--force").status == 0
    assert sidecar.read_text() != "mine"


def test_a_tdms_file_has_gaps_for_its_places(vgvt, tmp_path: Path) -> None:
    rows = rows_of(np.random.default_rng(2).standard_normal((400, 2)), ("F", "A1"), unit_string="N")
    write_tdms(tmp_path / "log.tdms", {"Log": rows})
    document = vgvt("data", "describe", "log.tdms", "--json").document
    assert document["sidecar"] == "log.toml"
    assert document["runs"] == [
        {"run": 1, "file": "log.tdms", "index": None, "first": 1, "last": 2, "samples": 400, "sample_rate_hz": 100.0}
    ]
    assert document["channels"][0] == {
        "name": "F",
        "role": "reference",
        "quantity": "force",
        "unit": "N",
        "column": None,
        "variable": "F",
        "dofs": [None],
    }
    result = vgvt("data", "describe", "log.tdms", "--force")
    assert "still to be written in it: positions of the nodes" in result.out
    gaps = vgvt("inspect", "log.toml")
    assert gaps.status == 2
    assert "channel[1]: give either dof" in gaps.err
    # The list of channels is as long as it must be, whatever is wrong with each.
    assert "more entries" not in gaps.err
    Path("cut.tdms").write_bytes(Path("log.tdms").read_bytes()[:-9])
    result = vgvt("data", "describe", "cut.tdms", "--json")
    assert result.status == 2
    assert "cut.tdms, segment 1 of the file: truncated" in result.document["error"]["message"]
    assert not Path("cut.toml").exists()


def test_several_files_are_described_under_the_name_of_their_folder(vgvt, small: Path) -> None:
    folder = small.parent / "march"
    folder.mkdir()
    for k in (1, 2):
        (folder / f"run{k}.uff").write_text(SMALL)
    document = vgvt("data", "describe", "march/run1.uff", "march/run2.uff", "--json").document
    assert document["sidecar"] == "march/march.toml"
    assert len(vgvt("inspect", "march/march.toml", "--json").document["runs"]) == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("missing.uff",), "cannot be read"),
        (("run1.TDMS",), "run1.TDMS: cannot be read"),
        (("run1.tdms", "small.uff"), "small.uff: is not of the kind of run1.tdms"),
        (("small.uff", "--out", "small.txt"), r"write --out small.toml"),
        (("small.uff", "--band", 20, 3), "--band: 20 3 is no band"),
        (("small.uff", "--axes", "x", "x", "z"), "--axes: x x z are not the axes"),
        (("small.uff", "--columns", 3, "--out", "new/place.toml"), "2 time histories do not make runs of 3 each"),
        ((), "Missing argument"),
        ((".",), ".: is a folder"),
        (("small.uff", "--out", "."), ".: is a folder"),
    ],
)
def test_bad_input_is_told_and_nothing_is_written(vgvt, small: Path, arguments: tuple, words: str) -> None:
    result = vgvt("data", "describe", *arguments, "--json")
    assert result.status == 2
    assert words in result.document["error"]["message"]
    assert [path.name for path in small.parent.iterdir()] == ["small.uff"]


@pytest.mark.parametrize("name", ["half.nc", "half.tdms", "half.uff"])
@pytest.mark.parametrize("options", [(), ("--out", "half.toml")])
def test_what_is_no_record_is_said_before_where_its_sidecar_goes(vgvt, name: str, options: tuple[str, ...]) -> None:
    Path(name).write_bytes(b"\x89HDF\r\n")
    Path("half.toml").write_text("mine")
    result = vgvt("data", "describe", name, *options)
    assert result.status == 2
    assert f"{name}: not a {'TDMS' if name.endswith('tdms') else 'Universal'} File".lower() in result.err.lower()
    assert "set another format" not in result.err
    assert Path("half.toml").read_text() == "mine"


def test_help_names_it(vgvt) -> None:
    assert "describe" in vgvt("data", "--help").out
    assert "describe" in vgvt("data").err
