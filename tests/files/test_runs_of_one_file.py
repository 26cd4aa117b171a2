"""Several runs in one file: what the sidecar says of each of them is checked, not of the first alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.files import open_campaign
from vgvt.files.manifest import file_sha256

Edit = Callable[[str, str], Path]
TIME = np.arange(500) / 100.0


@pytest.fixture
def together(edited: Edit, bench: Path, volts: np.ndarray) -> Path:
    """The bench with both runs in raw/all.npz, along the first axis; returns the archive."""
    edited('format = "mat"', 'format = "npz"')
    for k in (1, 2):
        edited(f'file = "run{k}.mat"', f'file = "all.npz"\nindex = {k}')
    archive = bench.parent / "raw/all.npz"
    np.savez(archive, data=volts, t=TIME)
    return archive


def test_one_time_axis_may_serve_all_runs(together: Path, bench: Path, volts: np.ndarray) -> None:
    plain = open_campaign(bench)
    assert [r.samples.shape for r in plain.runs] == [(3, 500)] * 2
    for axis in (TIME[:, None], TIME[None, :]):
        np.savez(together, data=volts, t=axis)
        np.testing.assert_array_equal(open_campaign(bench).runs[1].samples, plain.runs[1].samples)


@pytest.mark.parametrize("more", [(), (None,)])
def test_a_time_axis_a_run_is_read_by_the_run(together: Path, bench: Path, volts: np.ndarray, more: tuple) -> None:
    both = np.stack([TIME, TIME + 60.0])[(..., *more)]
    np.savez(together, data=volts, t=both)
    assert [r.sample_rate_hz for r in open_campaign(bench).runs] == [100.0, 100.0]
    np.savez(together, data=volts, t=both * np.array([1.0, 0.5]).reshape(2, *[1] * (both.ndim - 1)))
    with pytest.raises(InputError, match=r"run 2: the time axis says 200 Hz, the sidecar says 100 Hz"):
        open_campaign(bench)
    np.savez(together, data=volts, t=np.stack([TIME] * 3))
    open_campaign(bench)


def test_a_time_axis_that_no_run_has_is_refused(together: Path, edited: Edit, bench: Path, volts: np.ndarray) -> None:
    np.savez(together, data=np.concatenate([volts, volts]), t=np.stack([TIME, TIME]))
    edited("index = 2", "index = 4")
    with pytest.raises(InputError, match=r"run 2: no time axis of run 4 in an array of shape \(2, 500\)"):
        open_campaign(bench)
    np.savez(together, data=np.concatenate([volts, volts]), t=np.zeros((4, 500, 2)))
    with pytest.raises(InputError, match=r"shape \(4, 500, 2\) is no time axis"):
        open_campaign(bench)


def test_the_rate_of_every_run_is_checked(together: Path, edited: Edit, bench: Path) -> None:
    edited("index = 2", "index = 2\nsample_rate_hz = 200.0")
    with pytest.raises(InputError, match=r"all\.npz, run 2: the time axis says 100 Hz, the sidecar says 200 Hz"):
        open_campaign(bench)


def test_the_hash_of_every_run_is_checked(together: Path, edited: Edit, bench: Path) -> None:
    right = file_sha256(together)
    edited("index = 1", f'index = 1\nsha256 = "{right}"')
    edited("index = 2", f'index = 2\nsha256 = "{right}"')
    open_campaign(bench)
    edited(f'index = 2\nsha256 = "{right}"', f'index = 2\nsha256 = "{right[::-1]}"')
    with pytest.raises(InputError, match=r"not the file that the sidecar describes(.|\n)*\(run 2\)"):
        open_campaign(bench)


def test_a_file_is_read_and_hashed_once(
    together: Path, edited: Edit, bench: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from vgvt.files import measured_records

    calls: list[str] = []

    def counted(name: str) -> None:
        plain = getattr(measured_records, name)

        def call(*given: object) -> object:
            calls.append(name)
            return plain(*given)

        monkeypatch.setattr(measured_records, name, call)

    counted("read_npz")
    counted("file_sha256")
    for k in (1, 2):
        edited(f"index = {k}", f'index = {k}\nsha256 = "{file_sha256(together)}"')
    open_campaign(bench)
    assert sorted(calls) == ["file_sha256", "read_npz"]
