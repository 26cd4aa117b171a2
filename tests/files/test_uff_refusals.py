"""What a Universal File cannot give is told: which time history, what is wrong with it and what to do."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from uff_by_hand import DELIMITER, binary_58, head, lines_82, nodes_15, nodes_2411, numbers, text_58, units_164

from vgvt.data import InputError
from vgvt.files.uff.read import read_uff, require_histories

SHORT = np.array([1.5, -2.5, 3.5, -4.5, 5.5])


def written(folder: Path, content: str | bytes) -> Path:
    path = folder / "test.uff"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "the file is empty"),
        (" \n\n", "blank lines alone"),
        ("time,acc\n0,1\n", r"not a Universal File: it begins with 'time,acc'\n.*columns 5 and 6"),
        (DELIMITER, "truncated"),
        (DELIMITER + "  text\n" + DELIMITER, "'  text' stands where a dataset's number belongs"),
        (nodes_15({1: (0, 0, 0)}) + "what is this\n", r"after dataset 1 .*'what is this' stands between two datasets"),
        (nodes_15({1: (0, 0, 0)}), r"no functions \(datasets 58\)\n.*export the time histories"),
        (
            text_58(SHORT, function=4, abscissa=18) * 2 + text_58(SHORT, function=6),
            r"no time histories .*2 of frequency response function, 1 of coherence\n.*that they were made from",
        ),
        (text_58(SHORT, function=0), r"1 of general or unknown function\n(.|\n)*function type .* is to be 1"),
        (text_58(SHORT, ordinate=3), r"time history 1: damaged: ordinate data type 3"),
        (text_58(SHORT, dof=(1, 9)), r"time history 1: damaged: '1 9' is no response node and direction"),
        (units_164(0.0, 1.0), r"dataset 1 of the file \(164\): damaged"),
        (lines_82([1, 2]).replace("  2 ", "  x "), r"dataset 1 of the file \(82\): damaged"),
        (nodes_2411({1: (0, 0, 0)}) + nodes_15({1: (0, 1, 0)}), "node 1 has two positions"),
        (binary_58(SHORT)[:-7] + b"x    -1\n", r"\(58b\): damaged: the 40 bytes .* not followed by the line -1"),
    ],
)
def test_a_file_that_holds_no_time_histories_says_what_it_holds(tmp_path: Path, content: Any, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        file = read_uff(written(tmp_path, content))
        file.geometry()
        require_histories(file)
    assert str(tmp_path / "test.uff") in caught.value.where
    assert caught.value.advice


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (text_58(SHORT, ordinate=6), "complex numbers, and a time history has real ones"),
        (text_58(SHORT).replace("-2.5", "-x.5"), "something that is no number"),
        (DELIMITER + "    58\n" + head(5) + numbers(SHORT[:4]) + DELIMITER, "4 numbers where its header says 5"),
        (DELIMITER + "    58\n" + head(4) + numbers(SHORT) + DELIMITER, "5 numbers where its header says 4"),
        (DELIMITER + "    58\n" + head(4) + numbers([*SHORT[:4]] + [0] * 4) + DELIMITER, "8 numbers"),
        (binary_58(SHORT, floats=1), r"floating-point format 1 are not those of IEEE numbers(.|\n)*as text"),
    ],
)
def test_samples_that_cannot_be_read_are_told(tmp_path: Path, content: Any, words: str) -> None:
    (history,) = read_uff(written(tmp_path, content)).histories
    with pytest.raises(InputError, match=rf"test\.uff, time history 1: .*{words}"):
        history.samples()


def campaign_text(write: Callable) -> bytes:
    """Geometry, units and three short time histories."""
    parts = [units_164(1.0, 1.0), nodes_2411({1: (0.0, 1.0, 2.0)}), *(write(SHORT, dof=(k, 3)) for k in (1, 2, 3))]
    return b"".join(part.encode() if isinstance(part, str) else part for part in parts)


@pytest.mark.parametrize("write", [text_58, binary_58, partial(binary_58, gap=b"\n")])
def test_a_file_that_ends_anywhere_is_told_or_holds_fewer_time_histories(tmp_path: Path, write: Callable) -> None:
    """Between two datasets a file that was cut off is a whole one: the sidecar's columns and hashes are for that."""
    whole = campaign_text(write)
    between = 0
    for length in range(len(whole) - 1):
        try:
            file = read_uff(written(tmp_path, whole[:length]))
        except InputError as error:
            assert error.advice
            continue
        assert len(file.histories) < 3
        between += 1
        for history in file.histories:
            np.testing.assert_array_equal(history.samples(), SHORT)
    assert between <= 4 * len("\n     ")  # the blanks of a line that closes or opens a dataset


@pytest.mark.parametrize("write", [text_58, binary_58])
def test_one_wrong_byte_never_ends_in_anything_but_words(tmp_path: Path, write: Callable) -> None:
    whole = campaign_text(write)
    refused = 0
    for at in range(len(whole)):
        damaged = bytearray(whole)
        damaged[at] ^= 0x55
        try:
            file = read_uff(written(tmp_path, bytes(damaged)))
            file.geometry()
            for history in file.histories:
                history.samples()
                history.abscissa_s()
        except InputError as error:
            assert error.advice
            refused += 1
    assert refused > 0.1 * len(whole)


def test_a_line_that_looks_like_the_end_in_other_columns_is_none(tmp_path: Path) -> None:
    """A colour of -1 ends a line of dataset 2411; sample values begin with -1."""
    nodes = nodes_2411({1: (-1.0, -1.0, -1.0)}, color=-1)
    file = read_uff(written(tmp_path, nodes + text_58([-1.0, -1.0]).replace("E+00", "    ")))
    assert file.geometry().nodes[1].position == (-1.0, -1.0, -1.0)
    np.testing.assert_array_equal(file.histories[0].samples(), [-1.0, -1.0])


def test_binary_numbers_may_look_like_the_end(tmp_path: Path) -> None:
    """The size of binary numbers tells where they end, not what their bytes spell."""
    spelt = np.frombuffer(b"\n    -1\n\n    -1\n", dtype="<f8")
    (history,) = read_uff(written(tmp_path, binary_58(spelt))).histories
    np.testing.assert_array_equal(history.samples(), spelt)
