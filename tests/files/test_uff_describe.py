"""A sidecar written from Universal Files: it loads where they say it all, and says what they do not."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from uff_by_hand import DELIMITER, binary_58, head, lines_82, nodes_15, nodes_2411, text_58, units_164

from vgvt.data import Campaign, InputError
from vgvt.files import open_campaign
from vgvt.files.describe.draft import Description
from vgvt.files.uff.describe import describe_uff

PLACES = {node: (0.1 * node, 0.01 * node, 0.0) for node in (1, 2, 3, 4, 100)}
FORCE, ACC = (13, "N"), (12, "m/s2")
Row = tuple[tuple[int, int], tuple[int, str]]
ROVING: list[list[Row]] = [
    [((100, 3), FORCE), ((1, 3), ACC), ((2, 3), ACC)],
    [((100, 3), FORCE), ((3, 3), ACC), ((4, -3), ACC)],
]


def histories(runs: Sequence[Sequence[Row]], **fields: Any) -> str:
    """Time histories of some runs, each different from every other."""
    rows = [row for run in runs for row in run]
    samples = np.random.default_rng(len(rows)).standard_normal((len(rows), 400))
    return "".join(
        text_58(values, dof=dof, code=code, unit=unit, **fields)
        for values, (dof, (code, unit)) in zip(samples, rows, strict=True)
    )


def described(folder: Path, content: str | bytes, name: str = "bench.uff", **options: Any) -> tuple[Description, str]:
    """What is said of one file, and the sidecar's text."""
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    description = describe_uff([folder / name], folder / "bench.toml", **options)
    return description, (folder / "bench.toml").read_text(encoding="utf-8")


def labels(campaign: Campaign) -> list[list[str]]:
    return [[str(channel.dof) for channel in run.channels] for run in campaign.runs]


GEOMETRY = units_164(1000.0, 1.0) + nodes_2411(PLACES) + lines_82([1, 2, 0, 3, 4, 0, 100])


def test_a_file_that_says_it_all_is_read_as_it_is(tmp_path: Path) -> None:
    description, text = described(tmp_path, GEOMETRY + histories(ROVING), band_hz=(2.0, 30.0))
    campaign = open_campaign(tmp_path / "bench.toml")
    assert labels(campaign) == [["100+Z", "1+Z", "2+Z"], ["100+Z", "3+Z", "4-Z"]]
    assert [c.name for c in campaign.runs[0].channels] == ["force", "acc1", "acc2"]
    assert (campaign.name, campaign.band_hz, campaign.runs[0].sample_rate_hz) == ("bench", (2.0, 30.0), 100.0)
    np.testing.assert_allclose(campaign.geometry.position_m(4), [0.4e-3, 0.04e-3, 0.0])
    assert campaign.geometry.lines == ((1, 2), (3, 4))
    samples = np.random.default_rng(6).standard_normal((6, 400))
    np.testing.assert_allclose(campaign.runs[1].samples, samples[3:], rtol=1e-11)
    assert description.missing == ()
    assert description.remarks == ("bench.uff: taken as 2 runs of 3 time histories each, one behind the other",)
    assert "time histories 4 to 6 of the file" in text
    assert text.count("sha256") == 1
    assert text.count("CHECK:") == 1  # the axes


def test_a_band_that_nobody_gave_is_marked_as_a_guess(tmp_path: Path) -> None:
    """Ten periods in 4 s, and 100 Hz over 2.56."""
    description, text = described(tmp_path, GEOMETRY + histories(ROVING))
    assert description.band_hz == (2.5, 39.1)
    assert "CHECK: write the band that was excited" in text
    assert open_campaign(tmp_path / "bench.toml").band_hz == (2.5, 39.1)


def test_directions_are_written_along_aircraft_axes(tmp_path: Path) -> None:
    """The file's y points aft, its x to the left."""
    runs = [[((100, 2), FORCE), ((1, 1), ACC), ((2, -2), ACC), ((3, 3), ACC)]]
    described(tmp_path, GEOMETRY + histories(runs), axes=("y", "-x", "z"))
    campaign = open_campaign(tmp_path / "bench.toml")
    assert labels(campaign) == [["100+X", "1-Y", "2-X", "3+Z"]]
    np.testing.assert_allclose(campaign.geometry.position_m(1), [0.01e-3, -0.1e-3, 0.0])
    with pytest.raises(InputError, match=r"--axes: y x y are not the axes"):
        described(tmp_path, GEOMETRY + histories(runs), axes=("y", "x", "y"))


def test_a_hammer_that_roves(tmp_path: Path) -> None:
    runs = [[((node, 3), FORCE), ((100, 3), ACC)] for node in (1, 2, 3)]
    described(tmp_path, GEOMETRY + histories(runs))
    assert labels(open_campaign(tmp_path / "bench.toml")) == [[f"{node}+Z", "100+Z"] for node in (1, 2, 3)]


def test_an_order_that_changes_is_followed_by_dofs(tmp_path: Path) -> None:
    """As of programs that sort by node."""
    runs = [
        [((1, 3), ACC), ((2, 3), ACC), ((3, 3), FORCE), ((3, 3), ACC)],
        [((3, 3), FORCE), ((3, 3), ACC), ((4, 3), ACC), ((100, 3), ACC)],
    ]
    description, text = described(tmp_path, GEOMETRY + histories(runs))
    campaign = open_campaign(tmp_path / "bench.toml")
    assert labels(campaign) == [["3+Z", "3+Z", "1+Z", "2+Z"], ["3+Z", "3+Z", "4+Z", "100+Z"]]
    assert "\ncolumn =" not in text
    assert any("changes from run to run" in remark for remark in description.remarks)
    samples = np.random.default_rng(8).standard_normal((8, 400))
    np.testing.assert_allclose(campaign.runs[0].samples, samples[[2, 3, 0, 1]], rtol=1e-11)
    np.testing.assert_allclose(campaign.runs[1].samples, samples[4:], rtol=1e-11)


def test_a_sensor_that_stays_is_one_channel_wherever_it_stands(tmp_path: Path) -> None:
    runs = [
        [((100, 3), FORCE), ((1, 3), ACC), ((4, 3), ACC)],
        [((100, 3), FORCE), ((4, 3), ACC), ((2, 3), ACC)],
    ]
    _, text = described(tmp_path, GEOMETRY + histories(runs))
    assert labels(open_campaign(tmp_path / "bench.toml")) == [["100+Z", "4+Z", "1+Z"], ["100+Z", "4+Z", "2+Z"]]
    assert 'dof = "4+Z"' in text


def test_a_file_a_run(tmp_path: Path) -> None:
    (tmp_path / "raw").mkdir()
    files = [tmp_path / f"raw/run{k}.unv" for k in (1, 2)]
    for run, file in zip(ROVING, files, strict=True):
        file.write_text(GEOMETRY + histories([run]))
    describe_uff(files, tmp_path / "mine.toml")
    content = tomllib.loads((tmp_path / "mine.toml").read_text())
    assert content["records"]["folder"] == "raw"
    assert [run["file"] for run in content["run"]] == ["run1.unv", "run2.unv"]
    assert not any("index" in run for run in content["run"])
    assert labels(open_campaign(tmp_path / "mine.toml")) == [["100+Z", "1+Z", "2+Z"], ["100+Z", "3+Z", "4-Z"]]
    with pytest.raises(InputError, match=r"run1\.unv: is given twice"):
        describe_uff([files[0], files[0]], tmp_path / "twice.toml")
    files[1].write_text(GEOMETRY.replace("D-02", "D-03") + histories([ROVING[1]]))
    with pytest.raises(InputError, match=r"run2\.unv: node 1 is at another place"):
        describe_uff(files, tmp_path / "moved.toml")


def test_runs_that_cannot_be_told_are_refused_unless_their_size_is_given(tmp_path: Path) -> None:
    """Here all channels moved between the runs, so that no DOF comes again; and there one run lacks a channel."""
    moved = [[((1, 3), FORCE), ((2, 3), ACC)], [((3, 3), FORCE), ((4, 3), ACC)]]
    description, _ = described(tmp_path, GEOMETRY + histories(moved))
    assert description.remarks == ("bench.uff: taken as one run",)
    described(tmp_path, GEOMETRY + histories(moved), columns=2)
    assert labels(open_campaign(tmp_path / "bench.toml")) == [["1+Z", "2+Z"], ["3+Z", "4+Z"]]
    uneven = GEOMETRY + histories([ROVING[0], ROVING[1][:2]])
    with pytest.raises(InputError, match="its 5 time histories do not make runs alike"):
        described(tmp_path, uneven)
    with pytest.raises(InputError, match="5 time histories do not make runs of 3 each"):
        described(tmp_path, uneven, columns=3)


def test_channels_that_do_not_belong_together_are_refused(tmp_path: Path) -> None:
    """Two accelerometers at one place, in an order that changes: with --columns the runs are told, not the channels."""
    one: list[Row] = [((100, 3), FORCE), ((1, 3), ACC), ((1, 3), ACC)]
    with pytest.raises(InputError, match=r"bench\.uff, time histories 1 to 3: the order .* changes from run to run"):
        described(tmp_path, GEOMETRY + histories([one, [one[1], one[0], ((2, 3), (11, "m/s"))]]), columns=3)
    with pytest.raises(InputError, match="DOFs do not tell which channel is which"):
        described(tmp_path, GEOMETRY + histories([one[:2], [((0, 0), ACC), one[0]]]), columns=2)


def test_runs_of_other_lengths_are_other_runs(tmp_path: Path) -> None:
    """Without a reference that comes again; and each has its own sample rate."""
    runs = [[((1, 3), FORCE), ((2, 3), ACC)], [((3, 3), FORCE), ((4, 3), ACC)]]
    content = GEOMETRY + histories(runs[:1]) + histories(runs[1:], increment=0.005)
    described(tmp_path, content)
    campaign = open_campaign(tmp_path / "bench.toml")
    assert [run.sample_rate_hz for run in campaign.runs] == [100.0, 200.0]


@pytest.mark.parametrize(
    ("increment", "rate_hz"),
    [(1 / 51200, 51200.0), (1 / 2048, 2048.0), (1 / 256, 256.0), (1 / 1652.5, 1652.5), (0.5, 2.0), (1 / 3, 3.0)],
)
def test_a_rate_is_written_as_exactly_as_it_was_meant(tmp_path: Path, increment: float, rate_hz: float) -> None:
    """1/51200 s is 1.95312E-05 in a header, which by itself would be 51200.13 Hz."""
    described(tmp_path, GEOMETRY + histories([ROVING[0]], increment=increment))
    assert open_campaign(tmp_path / "bench.toml").runs[0].sample_rate_hz == rate_hz


def test_an_abscissa_that_is_written_out_has_a_rate(tmp_path: Path) -> None:
    rows = "".join(f"{k / 2048:13.5E}{(-1) ** k:20.12E}\n" for k in range(300))
    heads = [head(300, dof=(node, 3), code=code, unit=unit, spacing=0) for (node, _), (code, unit) in ROVING[0][:2]]
    described(tmp_path, GEOMETRY + "".join(f"{DELIMITER}    58\n{one}{rows}{DELIMITER}" for one in heads))
    assert open_campaign(tmp_path / "bench.toml").runs[0].sample_rate_hz == 2048.0


def test_a_unit_comes_from_the_label_else_from_the_file(tmp_path: Path) -> None:
    """Of volts nobody states the sensitivity, and of an unknown label nobody knows the size."""
    rows: list[Row] = [((100, 3), (13, "NONE")), ((1, 3), (12, "g")), ((2, 3), (12, "NONE")), ((3, 3), (0, "in/s2"))]
    described(tmp_path, units_164(1000.0, 1000.0) + nodes_2411(PLACES) + histories([rows]))
    channels = tomllib.loads((tmp_path / "bench.toml").read_text())["channel"]
    assert [channel["unit"] for channel in channels] == ["mN", "g", "mm/s^2", "in/s^2"]
    assert channels[3]["quantity"] == "acceleration"
    rows = [((100, 3), (13, "NONE")), ((1, 3), (12, "V")), ((2, 3), (12, "bananas")), ((3, 3), (0, "NONE"))]
    description, text = described(tmp_path, nodes_15(PLACES) + histories([rows]))
    assert description.missing == (
        "force: its unit (the file does not state it)",
        "acc1: its sensitivity, since the file holds volts",
        "acc2: its unit (the file says 'bananas')",
        "channel: its quantity, which the file does not state",
        "channel: its unit (the file does not state it)",
    )
    assert text.count("MISSING:") == 5
    with pytest.raises(InputError, match=r"bench\.toml, channel"):
        open_campaign(tmp_path / "bench.toml")


def test_the_unit_of_a_rotation_is_no_length(tmp_path: Path) -> None:
    """The file is in millimetres; angles have no factor there, so that only a label tells."""
    rows: list[Row] = [
        ((100, 3), (13, "NONE")),
        ((1, 3), (12, "NONE")),
        ((2, 5), (12, "NONE")),
        ((3, 5), (12, "rad/s2")),
    ]
    description, _ = described(tmp_path, units_164(1000.0, 1000.0) + nodes_2411(PLACES) + histories([rows]))
    assert description.missing == ("acc2: its unit (the file does not state it)",)
    channels = tomllib.loads((tmp_path / "bench.toml").read_text())["channel"]
    assert [channel.get("unit") for channel in channels] == ["mN", "mm/s^2", None, "rad/s^2"]


def test_what_is_missing_can_be_filled_in(tmp_path: Path) -> None:
    """A logger that knows neither nodes nor units: the gaps are written, and the sidecar loads."""
    content = "".join(text_58([1.0, 2.0] * 100, dof=(0, 0), code=1, unit=unit) for unit in ("N", "m/s2"))
    description, text = described(tmp_path, content)
    assert description.missing == (
        "force: its DOF, which the file does not state",
        "acc: its DOF, which the file does not state",
        "positions of the nodes",
    )
    for node in (7, 8):
        text = text.replace("# dof =  # MISSING", f'dof = "{node}+Z"  # WAS', 1)
    text = text.replace("# node = [1]  # MISSING", "node = [7, 8]")
    for axis in "xyz":
        text = text.replace(f"# {axis} = [0.0]  # MISSING", f"{axis} = [0.0, 1.0]  # WAS")
    (tmp_path / "bench.toml").write_text(text)
    assert labels(open_campaign(tmp_path / "bench.toml")) == [["7+Z", "8+Z"]]


def test_positions_that_are_missing_are_named(tmp_path: Path) -> None:
    description, text = described(tmp_path, nodes_15({1: (0, 0, 0), 2: (0, 1, 0)}) + histories(ROVING))
    assert description.missing == ("positions of nodes 3, 4, 100",)
    assert "CHECK: the file does not say (dataset 164)" in text
    assert "states no position of nodes [3, 4, 100]" in text


def test_what_is_left_out_is_said(tmp_path: Path) -> None:
    rows: list[Row] = [*ROVING[0], ((3, 3), (3, "strain")), ((1, 3), (8, "mm"))]
    content = GEOMETRY + lines_82([1, 77]) + histories([rows]) + text_58([1.0, 2.0], function=4, abscissa=18)
    description, text = described(tmp_path, content)
    said = "\n".join(description.remarks)
    assert "left out column 4: strain is not among the quantities" in said
    assert "left out column 5: acc1 is a response at the same DOF" in said
    assert "left out 1 of frequency response function" in said
    assert "left out trace lines through nodes that have no position: 1" in said
    assert all(f"# {remark}." in text for remark in description.remarks)
    assert labels(open_campaign(tmp_path / "bench.toml")) == [["100+Z", "1+Z", "2+Z"]]


def test_without_a_force_it_is_said_that_there_is_none(tmp_path: Path) -> None:
    description, _ = described(tmp_path, GEOMETRY + histories([ROVING[0][1:]]))
    assert "no time history is a force: frequency responses need one" in description.remarks


def local_system(x_point: tuple[float, float, float], origin: float = 0.0) -> str:
    """Dataset 18: system 5, by its origin, a point on +x and one in the plane of x and z."""
    values = [origin, 0.0, 0.0, *x_point, origin, 0.0, 1.0]
    texts = [f"{value:13.5E}" for value in values]
    record = f"{5:10d}{0:10d}{0:10d}{8:10d}{1:10d}\nlocal\n{''.join(texts[:6])}\n{''.join(texts[6:])}\n"
    return DELIMITER + f"{18:6d}\n" + record + DELIMITER


@pytest.mark.parametrize(("x_point", "turned"), [((1.0, 0.0, 0.0), False), ((0.0, 1.0, 0.0), True)])
def test_directions_along_local_axes_are_marked(
    tmp_path: Path, x_point: tuple[float, float, float], turned: bool
) -> None:
    content = local_system(x_point) + nodes_15(PLACES, displacement_system=5) + histories([ROVING[0]])
    description, text = described(tmp_path, content)
    assert (
        any("CHECK: directions at nodes 100, 1, 2 are along local" in remark for remark in description.remarks)
        is turned
    )
    assert ("along local coordinate systems" in text) is turned


def test_positions_in_a_local_system_are_refused(tmp_path: Path) -> None:
    """Dataset 2411 numbers its systems from 1, which is the global one where the file does not define it."""
    system = local_system((1.5, 0.0, 0.0), origin=0.5).replace("         5         0", "         1         0")
    with pytest.raises(InputError, match=r"nodes 1, 2, 3, 4, 100 are given in a local coordinate system\n.*global"):
        described(tmp_path, system + GEOMETRY + histories([ROVING[0]]))
    assert not (tmp_path / "bench.toml").exists()


def test_a_damaged_record_leaves_no_sidecar_and_the_old_one_as_it_was(tmp_path: Path) -> None:
    described(tmp_path, GEOMETRY + histories([ROVING[0]]))
    before = (tmp_path / "bench.toml").read_text()
    damaged = GEOMETRY + histories([ROVING[0]])
    at = damaged.rindex("E-01")
    with pytest.raises(InputError, match=r"bench\.uff, time history 3: damaged"):
        described(tmp_path, damaged[:at] + "X" + damaged[at + 1 :])
    assert (tmp_path / "bench.toml").read_text() == before
    assert {path.name for path in tmp_path.iterdir()} == {"bench.toml", "bench.uff"}


def test_names_of_files_are_only_names(tmp_path: Path) -> None:
    name = 'a "b" \n[run]\\ é.uff'
    described(tmp_path, (GEOMETRY + histories(ROVING)).encode() + binary_58([1.0], function=4), name)
    assert labels(open_campaign(tmp_path / "bench.toml"))[1] == ["100+Z", "3+Z", "4-Z"]
