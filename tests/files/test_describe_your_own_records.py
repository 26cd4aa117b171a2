"""The how-to 'Describe your own records': its example works as printed, and it names every key."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from vgvt.files.sidecar import Axes, ChannelRow, Nodes, Records, RunRow, Sidecar
from vgvt.files.units import QUANTITIES, UNITS


@pytest.fixture(scope="module")
def page(repository_root: Path) -> str:
    """The text of the how-to."""
    return (repository_root / "docs/how-to/describe-your-own-records.md").read_text(encoding="utf-8")


def test_the_example_opens(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (example,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (code,) = re.findall(r"```{code-block} python\n(.*?)```", page, re.DOTALL)
    folder = tmp_path / "my-test"
    (folder / "raw").mkdir(parents=True)
    (folder / "my-test.toml").write_text(example, encoding="utf-8")
    for k in (1, 2):
        samples = np.random.default_rng(k).standard_normal((2000, 3))
        scipy.io.savemat(folder / f"raw/run{k}.mat", {"data": samples, "t": np.arange(2000) / 1000.0})
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code, names)
    campaign = names["campaign"]
    assert names["frf"].values.shape[:2] == (4, 1)
    assert [str(d) for d in campaign.response_dofs] == ["1+Z", "2+Z", "3+Z", "4-Z"]
    np.testing.assert_allclose(campaign.geometry.position_m(100), [25 * 0.0254, 4.5 * 0.0254, 0])
    assert campaign.runs[0].channels[1].sensitivity_v_per_unit == pytest.approx(1 / 9.80665)


@pytest.mark.parametrize("table", [Sidecar, Records, Axes, Nodes, ChannelRow, RunRow])
def test_every_key_is_explained(page: str, table: type) -> None:
    missing = [k for k in table.model_fields if not re.search(rf"(?<![\w_]){k}(?![\w_])", page)]
    # 'traps' and 'dataset' serve the campaigns that come with the program.
    assert set(missing) <= {"traps", "dataset"}


def test_every_unit_is_listed(page: str) -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", page, re.MULTILINE))
    for name, quantity in QUANTITIES.items():
        assert set(re.findall(r"`([^`]+)`", rows[name])) == set(UNITS[quantity]) - {"m/s²"}
