"""What is written, read by programs that know nothing of vgvt: pyuff, scipy's MAT reader, Python's csv."""

from __future__ import annotations

import csv
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import scipy.io
from rich_campaign import rich_campaign, single_precision

from vgvt.data import Campaign, Dof, FrequencyResponseSet
from vgvt.files.export.campaign import export_campaign
from vgvt.files.export.responses import export_responses
from vgvt.files.uff.read import read_uff

FORMS = [("x.uff", False), ("x.unv", True)]


def sets_of(path: Path) -> list[dict[str, Any]]:
    read = pyuff.UFF(str(path)).read_sets()
    return read if isinstance(read, list) else [read]


@pytest.mark.parametrize(("name", "text"), FORMS)
@pytest.mark.parametrize("single", [False, True])
def test_pyuff_reads_a_campaign(tmp_path: Path, name: str, text: bool, single: bool) -> None:
    campaign = single_precision(rich_campaign()) if single else rich_campaign()
    export_campaign(campaign, tmp_path / name, text=text)
    header, units, nodes, *rest = sets_of(tmp_path / name)
    assert [header["type"], units["type"], nodes["type"]] == [151, 164, 15]
    assert (units["length"], units["force"]) == (1.0, 1.0)
    assert nodes["node_nums"] == list(campaign.geometry.nodes)
    places = np.column_stack([nodes[axis] for axis in "xyz"])
    np.testing.assert_allclose(places, campaign.geometry.positions_m, rtol=1e-5)
    lines, functions = rest[:2], rest[2:]
    assert [[int(n) for n in line["nodes"] if n] for line in lines] == [[1, 2, 3], [4, 9]]
    channels = [(run, k) for run in campaign.runs for k in range(5)]
    assert [function["type"] for function in functions] == [58] * 10
    for function, (run, k) in zip(functions, channels, strict=True):
        channel, samples = run.channels[k], run.samples[k].astype(float)
        np.testing.assert_allclose(function["data"], samples, rtol=1e-12 if text else 0, atol=0)
        np.testing.assert_allclose(function["x"], run.time_s, rtol=1e-5)
        dof = (0, 0) if channel.dof is None else (channel.dof.node, int(channel.dof.direction))
        assert (function["rsp_node"], function["rsp_dir"]) == dof
        assert (function["func_type"], function["binary"]) == (1, 0 if text else 1)
        assert function["abscissa_spec_data_type"] == 17
        assert function["ordinate_spec_data_type"] == int(channel.quantity)
        assert function["ordinate_axis_units_lab"].strip() == channel.unit
        assert function["id4"].strip() == f"run {run.run}"
        assert function["ord_data_type"] == (2 if single and not text else 4)


def responses(lines: np.ndarray, *, references: int = 1) -> FrequencyResponseSet:
    generator = np.random.default_rng(4)
    shape = (2, references, lines.size)
    coherence = np.broadcast_to(generator.random((2, 1, lines.size)), shape)
    return FrequencyResponseSet(
        responses=(Dof.from_label("1+Z"), Dof.from_label("3-RX")),
        references=(Dof.from_label("9+Z"), Dof.from_label("2-X"))[:references],
        frequency_hz=lines,
        values=generator.standard_normal(shape) + 1j * generator.standard_normal(shape),
        runs=(7, 3),
        coherence=coherence,
    )


EVEN = np.arange(20, 200) * 0.125
UNEVEN = np.array([2.0, 2.5, 3.125, 4.0])


def as_uff(folder: Path, frf: FrequencyResponseSet, name: str, text: bool) -> list[dict[str, Any]]:
    export_responses(frf, folder / name, "wing", rich_campaign().geometry, text=text)
    return [one for one in sets_of(folder / name) if one["type"] == 58]


@pytest.mark.parametrize(("name", "text"), FORMS)
@pytest.mark.parametrize("lines", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_pyuff_reads_frequency_responses(tmp_path: Path, name: str, text: bool, lines: np.ndarray) -> None:
    frf = responses(lines)
    functions = as_uff(tmp_path, frf, name, text)
    assert [function["func_type"] for function in functions] == [4, 4, 6, 6]
    for k, function in enumerate(functions):
        expected = frf.values[k, 0] if k < 2 else frf.coherence[k - 2, 0]
        np.testing.assert_allclose(function["data"], expected, rtol=1e-11 if text else 0, atol=0)
        np.testing.assert_allclose(function["x"], lines, rtol=1e-5 if text else 1e-9)
        assert (function["rsp_node"], function["rsp_dir"]) == ((1, 3), (3, -4))[k % 2]
        assert (function["ref_node"], function["ref_dir"]) == (9, 3)
        assert function["abscissa_spec_data_type"] == 18
        assert function["abscissa_axis_units_lab"].strip() == "Hz"
    for function in functions[:2]:
        assert (function["ordinate_spec_data_type"], function["orddenom_spec_data_type"]) == (12, 13)
        assert (function["ordinate_axis_units_lab"].strip(), function["orddenom_axis_units_lab"].strip()) == (
            "m/s^2",
            "N",
        )
    assert read_uff(tmp_path / name).other_functions == "2 of frequency response function, 2 of coherence"


def test_coherence_with_several_references_is_multiple(tmp_path: Path) -> None:
    frf = responses(EVEN, references=2)
    functions = as_uff(tmp_path, frf, "x.uff", False)
    assert [function["func_type"] for function in functions] == [4, 4, 4, 4, 26, 26]
    assert [function["ref_node"] for function in functions] == [9, 2, 9, 2, 0, 0]
    np.testing.assert_array_equal(functions[3]["data"], frf.values[1, 1])
    np.testing.assert_array_equal(functions[5]["data"], frf.coherence[1, 0])
    without = replace(frf, coherence=None)
    assert [function["func_type"] for function in as_uff(tmp_path, without, "y.uff", False)] == [4] * 4


def test_names_that_the_format_cannot_hold(tmp_path: Path) -> None:
    campaign = rich_campaign()
    export_campaign(replace(campaign, name="\n   -1\n" + "x" * 100), tmp_path / "x.uff", text=True)
    assert max(map(len, (tmp_path / "x.uff").read_text("ascii").splitlines())) == 80
    header, *rest = sets_of(tmp_path / "x.uff")
    assert header["model_name"].strip() == "-1 " + "x" * 77
    assert len(rest) == 14
    assert [one["id1"].strip() for one in rest if one["type"] == 58][5:8] == ["drive", "force, left", "a2 ?"]


class GermanMarch(datetime):
    """A clock in a program that has set a German locale, as those with windows do."""

    @classmethod
    def now(cls, tz: object = None) -> GermanMarch:
        return cls(2027, 3, 7, 8, 9, 10)

    def strftime(self, form: str) -> str:
        return super().strftime(form.replace("%b", "Mär"))


def test_the_date_is_in_the_words_of_the_format_in_any_locale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vgvt.files.uff.write.datetime", GermanMarch)
    export_campaign(rich_campaign(), tmp_path / "x.uff", text=True)
    header = sets_of(tmp_path / "x.uff")[0]
    assert (header["date_db_created"].strip(), header["time_db_created"].strip()) == ("07-MAR-27", "08:09:10")


def loaded(path: Path) -> dict[str, Any]:
    return dict(scipy.io.loadmat(path, simplify_cells=True))


def test_matlab_finds_a_run(tmp_path: Path) -> None:
    campaign: Campaign = rich_campaign()
    exported = export_campaign(campaign, tmp_path / "x.mat")
    assert [path.name for path in exported.files] == ["x-run7.mat", "x-run3.mat"]
    found, run = loaded(exported.files[0]), campaign.runs[0]
    np.testing.assert_array_equal(found["samples"], run.samples.T)
    np.testing.assert_array_equal(found["time_s"], run.time_s)
    assert (found["sample_rate_hz"], found["run"], found["campaign"]) == (1652.5, 7, campaign.name)
    assert list(found["channel"]) == [channel.name for channel in run.channels]
    assert list(found["unit"]) == ["V", "N", "m/s^2", "m/s", "m"]
    assert list(found["role"]) == ["drive", "reference", "response", "response", "response"]
    assert list(found["quantity"])[:3] == ["general", "excitation_force", "acceleration"]
    assert [str(dof) if len(dof) else "" for dof in found["dof"]] == ["", "9+Z", "1+Z", "3-RX", "4S"]
    assert list(found["node"]) == [1, 2, 3, 4, 9]
    np.testing.assert_array_equal(found["position_m"], campaign.geometry.positions_m)
    assert [list(line) for line in found["lines"]] == [[1, 2, 3], [4, 9]]
    assert list(found["band_hz"]) == [0.1, 35.25]
    assert "aircraft: none, “made up”" in list(found["notes"])
    raw = scipy.io.loadmat(exported.files[0])
    assert raw["samples"].shape == (300, 5) and raw["channel"].shape == (5, 1) and raw["time_s"].shape == (300, 1)
    single = export_campaign(single_precision(campaign), tmp_path / "y.mat")
    assert loaded(single.files[0])["samples"].dtype == np.float32


def test_matlab_finds_frequency_responses(tmp_path: Path) -> None:
    frf = responses(EVEN, references=2)
    export_responses(frf, tmp_path / "x.mat", "wing", rich_campaign().geometry)
    found = loaded(tmp_path / "x.mat")
    np.testing.assert_array_equal(found["frf"], frf.values.transpose(2, 0, 1))
    np.testing.assert_array_equal(found["coherence"], frf.coherence.transpose(2, 0, 1))
    np.testing.assert_array_equal(found["frequency_hz"], EVEN)
    assert (list(found["response"]), list(found["reference"])) == (["1+Z", "3-RX"], ["9+Z", "2-X"])
    assert (found["unit"], found["quantity"], list(found["run"])) == ("(m/s^2)/N", "acceleration", [7, 3])
    assert "variance" not in found


def table(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="", encoding="utf-8") as stream:
        heading, *rows = csv.reader(stream)
    return heading, np.array(rows, dtype=float)


def test_a_table_has_a_heading_and_every_digit(tmp_path: Path) -> None:
    campaign = rich_campaign()
    renamed = tuple(replace(c, name="two\nlines") if c.name == "vel" else c for c in campaign.runs[0].channels)
    campaign = replace(campaign, runs=(replace(campaign.runs[0], channels=renamed),))
    export_campaign(campaign, tmp_path / "x.csv")
    heading, numbers = table(tmp_path / "x.csv")
    assert heading == [
        "time [s]",
        "drive [V]",
        "force, left 9+Z [N]",
        "a1 1+Z [m/s^2]",
        "two lines 3-RX [m/s]",
        "disp 4S [m]",
    ]
    np.testing.assert_array_equal(numbers[:, 1:], campaign.runs[0].samples.T)
    np.testing.assert_allclose(numbers[:, 0], campaign.runs[0].time_s, rtol=1e-11)


def test_a_table_of_frequency_responses(tmp_path: Path) -> None:
    frf = responses(UNEVEN)
    export_responses(frf, tmp_path / "x.csv", "wing", rich_campaign().geometry)
    heading, numbers = table(tmp_path / "x.csv")
    assert heading[:4] == [
        "frequency [Hz]",
        "real 1+Z/9+Z [(m/s^2)/N]",
        "imag 1+Z/9+Z [(m/s^2)/N]",
        "coherence 1+Z/9+Z",
    ]
    np.testing.assert_array_equal(numbers[:, 0], UNEVEN)
    np.testing.assert_array_equal(numbers[:, 4] + 1j * numbers[:, 5], frf.values[1, 0])
    np.testing.assert_array_equal(numbers[:, 6], frf.coherence[1, 0])
    export_responses(replace(frf, coherence=None), tmp_path / "y.csv", "wing", rich_campaign().geometry)
    assert len(table(tmp_path / "y.csv")[0]) == 5
