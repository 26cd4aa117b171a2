"""Time histories in Universal Files: the numbers of their npz twin, however they are written."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
from uff_by_hand import DELIMITER, binary_58, head, lines_82, nodes_2411, numbers, text_58, units_164

from vgvt.data import Campaign, Dof
from vgvt.files import open_campaign
from vgvt.files.uff.read import read_uff

Edit = Callable[[str, str], Path]
Universal = Callable[..., Path]
TIME = np.arange(500) / 100.0


@pytest.fixture
def twin(bench: Path, volts: np.ndarray, edited: Edit) -> Campaign:
    """The same campaign read from npz; the sidecar is left as it was."""
    text = bench.read_text(encoding="utf-8")
    for k in (1, 2):
        np.savez(bench.parent / f"raw/run{k}.npz", data=volts[k - 1], t=TIME)
    edited('format = "mat"', 'format = "npz"')
    campaign = open_campaign(edited(".mat", ".npz"))
    bench.write_text(text, encoding="utf-8")
    return campaign


def with_pyuff(folder: Path, values: np.ndarray, *, binary: int, double: bool, **stated: Any) -> bytes:
    """One dataset 58 as pyuff writes it; a short dataset leads, since a binary one that comes first is broken."""
    path = folder / "one.uff"
    file = pyuff.UFF(str(path))
    file.write_sets(pyuff.prepare_164(1, "SI", 1, 1.0, 1.0, 1.0, 0.0), "overwrite")
    before = path.stat().st_size
    dataset = pyuff.prepare_58(
        binary=binary,
        func_type=1,
        rsp_node=stated["dof"][0],
        rsp_dir=stated["dof"][1],
        ref_node=0,
        ref_dir=0,
        ord_data_type=4 if double else 2,
        abscissa_spacing=1,
        abscissa_spec_data_type=17,
        ordinate_spec_data_type=stated["code"],
        ordinate_axis_units_lab=stated["unit"],
        orddenom_spec_data_type=0,
        z_axis_spec_data_type=0,
        data=values,
        x=TIME,
    )
    file.write_sets(dataset, "add", force_double=double)
    return path.read_bytes()[before:]


FORMS = {
    "text, double": (text_58, 1e-12),
    "text, single": (partial(text_58, ordinate=2), 1e-5),
    "binary, double": (binary_58, 0.0),
    "binary, single": (partial(binary_58, ordinate=2), 3e-7),
    "binary, double, big-endian": (partial(binary_58, order=">"), 0.0),
    "binary, single, big-endian": (partial(binary_58, order=">", ordinate=2), 3e-7),
    "binary, a line end before the closing line": (partial(binary_58, gap=b"\n"), 0.0),
    "binary, single, a line end of Windows there": (partial(binary_58, gap=b"\r\n", ordinate=2), 3e-7),
    "text, line ends of Windows": (lambda *a, **k: text_58(*a, **k).replace("\n", "\r\n"), 1e-12),
    "text, every line filled up with blanks": (
        lambda *a, **k: "".join(f"{line:80s}\n" for line in text_58(*a, **k).splitlines()),
        1e-12,
    ),
    "text, exponents with a D": (lambda v, **k: DELIMITER + "    58\n" + head(len(v), **k)
                                 + numbers(v).replace("E", "D") + DELIMITER, 1e-12),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_the_numbers_are_those_of_the_npz_twin(universal: Universal, twin: Campaign, form: str) -> None:
    write, accuracy = FORMS[form]
    read = open_campaign(universal(write))
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_allclose(one.samples, other.samples, rtol=accuracy, atol=0)
        assert one.channels == other.channels
        assert one.sample_rate_hz == other.sample_rate_hz
        assert one.samples.dtype == (np.float32 if "single" in form else np.float64)


# pyuff leaves the file open to which it appends binary numbers.
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(("binary", "double", "accuracy"), [(0, True, 1e-11), (0, False, 1e-5), (1, True, 0.0)])
def test_what_pyuff_writes_reads_the_same(
    universal: Universal, twin: Campaign, tmp_path: Path, binary: int, double: bool, accuracy: float
) -> None:
    read = open_campaign(universal(partial(with_pyuff, tmp_path, binary=binary, double=double)))
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_allclose(one.samples, other.samples, rtol=accuracy, atol=0)


@pytest.mark.parametrize("write", [text_58, binary_58])
def test_pyuff_reads_the_same_of_what_is_written_by_hand(tmp_path: Path, write: Callable) -> None:
    """Writer and reader of these tests are then not each other's only judge."""
    values = np.random.default_rng(3).standard_normal(50)
    dataset = write(values, dof=(17, -2), code=13, unit="N", increment=0.5, minimum=3.0)
    path = tmp_path / "hand.uff"
    path.write_bytes(units_164(1.0, 1.0).encode() + (dataset if isinstance(dataset, bytes) else dataset.encode()))
    theirs = pyuff.UFF(str(path)).read_sets([1])
    (ours,) = read_uff(path).histories
    np.testing.assert_array_equal(ours.samples(), theirs["data"])
    assert (ours.response, ours.quantity_code, ours.unit) == (Dof.from_label("17-Y"), 13, "N")
    assert (theirs["rsp_node"], theirs["rsp_dir"], theirs["ordinate_spec_data_type"]) == (17, -2, 13)
    assert (ours.form.minimum, ours.form.increment) == (theirs["abscissa_min"], theirs["abscissa_inc"]) == (3.0, 0.5)


def test_numbers_that_touch_are_read_in_their_columns(tmp_path: Path) -> None:
    """Exponents of three digits leave no blank before a minus sign."""
    values = np.array([-1.25, -2.5, 3.0, -4.0, -5.0, -6.0, -7.5])
    rows = ["".join(f"{value:12.5E}".replace("E+", "E+0") for value in part) for part in (values[:6], values[6:])]
    assert "1.25000E+000-2.5" in rows[0]
    path = tmp_path / "touch.uff"
    path.write_text(f"{DELIMITER}    58\n{head(7, ordinate=2)}" + "\n".join(rows) + f"\n{DELIMITER}")
    np.testing.assert_array_equal(read_uff(path).histories[0].samples(), values)


def test_a_last_line_may_be_filled_up_with_zeros(tmp_path: Path) -> None:
    path = tmp_path / "filled.uff"
    path.write_text(f"{DELIMITER}    58\n{head(5)}{numbers([1, 2, 3, 4, 5, 0, 0, 0])}{DELIMITER}")
    np.testing.assert_array_equal(read_uff(path).histories[0].samples(), [1, 2, 3, 4, 5])


@pytest.mark.parametrize("write", [text_58, binary_58])
def test_samples_that_are_not_finite_are_noted(universal: Universal, volts: np.ndarray, write: Callable) -> None:
    volts[0, 20:25, 2] = np.nan
    record = open_campaign(universal(write)).runs[0]
    assert record.notes == ("acc2: 5 of 500 samples are not finite",)
    assert np.isnan(record.samples[2, 20:25]).all()


def uneven(values: np.ndarray, time_s: np.ndarray = TIME, **stated: Any) -> str:
    """A dataset 58 that writes its abscissa out, as 2(E13.5,E20.12)."""
    pairs = [f"{t:13.5E}{y:20.12E}" for t, y in zip(time_s, values, strict=True)]
    rows = "".join("".join(pairs[k : k + 2]) + "\n" for k in range(0, len(pairs), 2))
    return f"{DELIMITER}    58\n{head(len(values), spacing=0, increment=0.0, **stated)}{rows}{DELIMITER}"


def test_an_abscissa_that_is_written_out_may_be_even(universal: Universal, twin: Campaign) -> None:
    read = open_campaign(universal(uneven))
    np.testing.assert_allclose(read.runs[1].samples, twin.runs[1].samples, rtol=1e-12)


@pytest.mark.parametrize("by_column", [True, False])
def test_several_runs_in_one_file(universal: Universal, edited: Edit, twin: Campaign, by_column: bool) -> None:
    raw = universal(text_58).parent / "raw"
    if not by_column:
        without_columns(edited)
    geometry = units_164(1000.0, 1.0) + nodes_2411({1: (0.0, -1.0, 2.0)}, color=-1) + lines_82([1, 1])
    function = text_58([1.0, 2.0], function=4, abscissa=18)
    parts = [geometry.encode(), (raw / "run1.uff").read_bytes(), function.encode(), (raw / "run2.uff").read_bytes()]
    (raw / "all.uff").write_bytes(b"".join(parts))
    for k in (1, 2):
        edited(f'"run{k}.uff"', f'"all.uff"\nindex = {k}')
    read = open_campaign(raw.parent / "bench.toml")
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_allclose(one.samples, other.samples, rtol=1e-12)


def without_columns(edited: Edit) -> Path:
    for k in (1, 2):
        edited(f"column = {k}\n", "")
    return edited("column = 3\n", "")


def test_channels_without_a_column_are_found_by_their_dof(
    universal: Universal, edited: Edit, twin: Campaign, volts: np.ndarray
) -> None:
    """Also where the order changes from run to run, and where the force sits under an accelerometer."""
    universal(text_58)
    path = without_columns(edited)
    edited("acc2 = 2", "acc2 = 100")
    stated = (
        [((100, 3), 12, 2), ((1, 3), 12, 1), ((100, 3), 13, 0)],
        [((4, -3), 12, 2), ((100, 3), 13, 0), ((3, 3), 12, 1)],
    )
    for run, rows in enumerate(stated):
        texts = [text_58(volts[run][:, k], dof=dof, code=code, unit="V") for dof, code, k in rows]
        (path.parent / f"raw/run{run + 1}.uff").write_text("".join(texts))
    read = open_campaign(path)
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_allclose(one.samples, other.samples, rtol=1e-12)


def test_a_channel_may_name_the_dof_that_the_file_states(universal: Universal, edited: Edit, twin: Campaign) -> None:
    edited("column = 1\n", 'variable = "100+Z"\n')
    read = open_campaign(universal(text_58))
    np.testing.assert_allclose(read.runs[1].samples[0], twin.runs[1].samples[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("record", "node"),
    [
        ("    1         0    0         0 12+Z              12   3 NONE               0   0", 12),
        ("    1         0    0         0 12+Z               12   3 NONE               0   0", 12),  # one column off
        (" 1 0 0 0 NONE 12 3 NONE 0 0", 12),
        ("    1         1    1         0 PWL Mic           12   3                   -1   0", 12),
        ("    1         1    1         0                   12   3", 12),
        ("    1         0    0         0 NONE", None),
    ],
)
def test_a_dof_is_read_as_programs_write_it(tmp_path: Path, record: str, node: int | None) -> None:
    path = tmp_path / "one.uff"
    lines = text_58([1.0, 2.0]).splitlines(keepends=True)
    path.write_text("".join([*lines[:7], record + "\n", *lines[8:]]))
    assert read_uff(path).histories[0].response == (None if node is None else Dof.from_label("12+Z"))
