"""A sidecar and the Universal Files that it describes: where they contradict each other, it is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from uff_by_hand import DELIMITER, head, text_58, units_164

from vgvt.data import InputError
from vgvt.files import open_campaign

Edit = Callable[[str, str], Path]
Universal = Callable[..., Path]


def stated(**different: Any) -> Callable[..., str]:
    """A writer that states something else in the second column of either run (acc1)."""

    def write(values: np.ndarray, **fields: Any) -> str:
        return text_58(values, **fields | (different if fields["dof"][0] in (1, 3) else {}))

    return write


OVERRIDE = {"dof": 'overrides = ["dof"]', "quantity": 'overrides = ["quantity"]', "unit": 'overrides = ["unit"]'}


@pytest.mark.parametrize(
    ("different", "words", "overridden"),
    [
        ({"code": 13}, r"says excitation force .*the sidecar says acceleration\n.*correct the column", "quantity"),
        ({"code": 3}, r"says strain \(specific data type 3\)", "quantity"),
        ({"dof": (2, 3)}, r"measured at 2\+Z; the sidecar says 1\+Z", "dof"),
        ({"dof": (1, -3)}, r"measured at 1-Z; the sidecar says 1\+Z", "dof"),
        ({"dof": (1, 1)}, r"measured at 1\+X, which is 1-Y in aircraft axes; the sidecar says 1\+Z", "dof"),
        ({"unit": "m/s2"}, r"its unit is 'm/s2', the sidecar says volts \(sensitivity\)", "unit"),
        ({"unit": "mV"}, r"its unit is 'mV', the sidecar says volts", "unit"),
    ],
)
def test_a_sidecar_that_contradicts_the_file_is_told_and_may_override_it(
    universal: Universal, edited: Edit, different: dict[str, Any], words: str, overridden: str
) -> None:
    path = universal(stated(**different))
    with pytest.raises(InputError, match=rf"run1\.uff, time history 2 \(run 1, channel 'acc1'\): .*{words}") as caught:
        open_campaign(path)
    assert OVERRIDE[overridden] in caught.value.advice
    edited('name = "acc1"\n', f'name = "acc1"\n{OVERRIDE[overridden]}\n')
    assert len(open_campaign(path).runs) == 2


@pytest.mark.parametrize(
    "different", [{"code": 0}, {"code": 1}, {"dof": (0, 0)}, {"unit": "NONE"}, {"unit": "furlong"}]
)
def test_what_the_file_does_not_state_fits(universal: Universal, different: dict[str, Any]) -> None:
    assert len(open_campaign(universal(stated(**different))).runs) == 2


@pytest.mark.parametrize(
    ("different", "words"),
    [
        ({"increment": 0.005}, r"the file states 200 Hz \(an increment of 0\.005 s\), the sidecar 100 Hz"),
        ({"increment": 10.0, "abscissa_unit": "ms"}, r"states 0\.1 Hz \(an increment of 10 ms\)"),
        ({"increment": 0.0}, "states no rate"),
        ({"minimum": 0.01}, r"do not begin together: from 0 s to 0\.01 s"),
    ],
)
def test_a_rate_or_a_start_that_does_not_fit(
    universal: Universal, edited: Edit, different: dict[str, Any], words: str
) -> None:
    path = universal(stated(**different))
    with pytest.raises(InputError, match=words) as caught:
        open_campaign(path)
    assert caught.value.advice
    edited("sample_rate_hz = 100.0", 'sample_rate_hz = 100.0\noverrides = ["sample_rate_hz"]')
    assert open_campaign(path).runs[0].sample_rate_hz == 100.0


def late(values: np.ndarray, **fields: Any) -> str:
    """Ten hours after the recorder began, where five digits are 0.1 s; the force seems to begin by that earlier."""
    return text_58(values, minimum=35999.9 if fields["code"] == 13 else 36000.0, **fields)


@pytest.mark.parametrize("write", [stated(minimum=0.004), late])
def test_a_start_is_known_as_exactly_as_it_is_written(universal: Universal, write: Callable) -> None:
    assert len(open_campaign(universal(write)).runs) == 2


def test_an_abscissa_with_a_gap_is_refused(universal: Universal, edited: Edit) -> None:
    def write(values: np.ndarray, **fields: Any) -> str:
        time_s = np.arange(values.size) / 100.0
        time_s[250:] += 0.03
        pairs = "".join(f"{t:13.5E}{y:20.12E}\n" for t, y in zip(time_s, values, strict=True))
        return f"{DELIMITER}    58\n{head(values.size, spacing=0, **fields)}{pairs}{DELIMITER}"

    path = universal(write)
    with pytest.raises(InputError, match=r"steps by 0\.04 s from entry 250(.|\n)*cut the record there"):
        open_campaign(path)
    edited("sample_rate_hz = 100.0", 'sample_rate_hz = 100.0\noverrides = ["sample_rate_hz"]')
    assert len(open_campaign(path).runs) == 2


def test_channels_of_one_run_are_of_one_length_and_over_time(universal: Universal) -> None:
    path = universal(text_58)
    whole = (path.parent / "raw/run1.uff").read_text()
    shorter = text_58(np.zeros(499), dof=(2, 3), unit="V")
    (path.parent / "raw/run1.uff").write_text(whole[: whole.rindex(DELIMITER + "    58")] + shorter)
    with pytest.raises(InputError, match=r"run 1: the channels differ in length: .*'acc2': 499"):
        open_campaign(path)
    spectrum = text_58(np.zeros(500), dof=(2, 3), unit="V", abscissa=18)
    (path.parent / "raw/run1.uff").write_text(whole[: whole.rindex(DELIMITER + "    58")] + spectrum)
    with pytest.raises(InputError, match=r"time history 3 .*a function over frequency, and not over time"):
        open_campaign(path)


@pytest.mark.parametrize(
    ("runs", "edits", "words"),
    [
        (2, (), r"6 time histories, but the sidecar speaks of 3 .*\n.*of 2 runs in one file give each its index"),
        (1, (("columns = 3\n", ""), ("column = 3", "column = 4")), r"3 time histories, but channel 'acc2' .* column 4"),
        (2, (('"run1.uff"', '"run1.uff"\nindex = 3'),), r"no run 3 in a file of 2 runs\n.*index = 1 to 2"),
        (
            2,
            (("columns = 3", "columns = 4"), ('"run1.uff"', '"run1.uff"\nindex = 1')),
            "6 time histories, which do not make runs of 4 each",
        ),
        (
            1,
            (("column = 2\n", ""), ("acc1 = 1", "acc1 = 4")),
            r"no time history at 4\+Z for channel 'acc1'; .* 100\+Z, 1\+Z",
        ),
        (
            2,
            (("columns = 3\n", ""), ("column = 2\n", "")),
            r"2 time histories at 1\+Z \(columns 2, 5\)(.|\n)*the index of each run",
        ),
        (1, (("column = 2\n", 'variable = "2+Z"\n'),), "channels 'acc1' and 'acc2' are both .*time history 3"),
    ],
)
def test_channels_that_are_not_to_be_found(
    universal: Universal, edited: Edit, runs: int, edits: tuple[tuple[str, str], ...], words: str
) -> None:
    path = universal(text_58)
    first = path.parent / "raw/run1.uff"
    first.write_text(first.read_text() * runs)
    for old, new in edits:
        edited(old, new)
    with pytest.raises(InputError, match=words) as caught:
        open_campaign(path)
    assert "run1.uff, run 1" in caught.value.where
    assert caught.value.advice


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("columns = 3", 'columns = 3\nsamples = "data"', "records: Universal Files hold one time history a channel"),
        ("columns = 3", 'columns = 3\nchannels_are = "rows"', "leave out samples, time_s and channels_are"),
        ("column = 2", 'column = 2\nvariable = "1+Z"', "'acc1' has a column and a variable; *|\n.*leave one"),
        ("column = 2", 'variable = "up"', "not a degree of freedom: 'up'"),
        (
            "column = 2",
            'overrides = ["dof"]',
            r"'acc1' cannot be found by its DOF in a Universal File\n.*give its column",
        ),
        ('"run1.uff"', '"run1.uff"\nindex = 1', ""),
        ('format = "uff"', 'format = "csv"\noverrides = ["sample_rate_hz"]', "only Universal Files and TDMS state"),
        ("column = 2", 'column = 2\noverrides = ["name"]', "'dof', 'quantity' or 'unit'"),
    ],
)
def test_a_mistake_in_the_sidecar_of_universal_files(
    universal: Universal, edited: Edit, old: str, new: str, words: str
) -> None:
    path = universal(text_58)
    edited(old, new)
    if not words:
        edited("columns = 3\n", "")
        words = r"run 1 is one of several in a Universal File(.|\n)*columns = \.\.\. in \[records\]"
    with pytest.raises(InputError, match=words) as caught:
        open_campaign(path)
    assert str(caught.value).startswith(str(path))


def test_only_what_a_file_states_can_be_overridden(edited: Edit) -> None:
    with pytest.raises(InputError, match="channel 'acc1': a file of format mat states no unit that could be"):
        open_campaign(edited('name = "acc1"\n', 'name = "acc1"\noverrides = ["unit"]\n'))


@pytest.mark.parametrize("name", ["test.uff", "TEST.UNV"])
def test_a_universal_file_by_itself_is_told_how_to_begin(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(text_58([1.0, 2.0]))
    with pytest.raises(InputError, match=rf"vgvt data describe .*{name}"):
        open_campaign(tmp_path / name)


def test_the_units_of_the_file_say_nothing_of_a_rotation(universal: Universal, edited: Edit) -> None:
    path = universal(stated(unit="NONE", dof=(1, 5)))
    volts = 'direction = "+Z"\nsensitivity = "10 mV/g"\ngain = 100.0\nrange_v = 10.0'
    edited(volts, 'direction = "+RY"\nunit = "deg/s^2"\noverrides = ["dof"]')
    for k in (1, 2):
        file = path.parent / f"raw/run{k}.uff"
        file.write_text(units_164(1000.0, 1.0) + file.read_text())
    assert len(open_campaign(path).runs) == 2


@pytest.mark.parametrize(
    ("label", "unit", "fits"),
    [("NONE", "m/s^2", False), ("NONE", "mm/s^2", True), ("NONE", "g", False), ("furlong", "g", True)],
)
def test_the_units_of_the_file_hold_where_an_axis_has_no_label(
    universal: Universal, edited: Edit, label: str, unit: str, fits: bool
) -> None:
    path = universal(stated(unit=label))
    edited('sensitivity = "10 mV/g"\ngain = 100.0\nrange_v = 10.0', f'unit = "{unit}"')
    for k in (1, 2):
        file = path.parent / f"raw/run{k}.uff"
        file.write_text(units_164(1000.0, 1.0) + file.read_text())
    if fits:
        assert len(open_campaign(path).runs) == 2
        return
    with pytest.raises(
        InputError, match=rf"dataset 164\) it is in units of 0\.001 m/s\^2, the sidecar says {unit[:2]}"
    ):
        open_campaign(path)
