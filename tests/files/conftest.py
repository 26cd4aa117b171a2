"""A small campaign, and a small set of record files with a sidecar that describes them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Geometry, Quantity, Record

SIDECAR = """
name = "bench-beam"
band_hz = [2.0, 40.0]

[records]
format = "mat"
folder = "raw"
sample_rate_hz = 100.0
samples = "data"
time_s = "t"
columns = 3

[axes]
unit = "mm"
aft = "y"
right = "-x"
up = "z"
nose = [10.0, 0.0, 0.0]

[nodes]
node = [1, 2, 3, 4, 100]
x = [-990.0, -490.0, 510.0, 1010.0, 10.0]
y = [200.0, 100.0, 100.0, 200.0, 50.0]

[[channel]]
name = "force"
column = 1
quantity = "force"
role = "reference"
dof = "100+Z"
sensitivity = "0.5 V/lb"

[[channel]]
name = "acc1"
column = 2
quantity = "acceleration"
role = "response"
direction = "+Z"
sensitivity = "10 mV/g"
gain = 100.0
range_v = 10.0

[[channel]]
name = "acc2"
column = 3
quantity = "acceleration"
role = "response"
direction = "+Z"
sensitivity = "1 V/g"

[[run]]
run = 1
file = "run1.mat"
nodes = { acc1 = 1, acc2 = 2 }

[[run]]
run = 2
file = "run2.mat"
nodes = { acc1 = 3, acc2 = "4-Z" }
"""


@pytest.fixture
def volts() -> np.ndarray:
    """Samples (2 runs, 500, 3) as a converter gave them."""
    return np.random.default_rng(0).standard_normal((2, 500, 3))


@pytest.fixture
def bench(tmp_path: Path, volts: np.ndarray) -> Path:
    """A folder with bench.toml and raw/run1.mat, raw/run2.mat; returns the sidecar's path."""
    (tmp_path / "raw").mkdir()
    time = np.arange(500) / 100.0
    for k, samples in enumerate(volts, start=1):
        scipy.io.savemat(tmp_path / "raw" / f"run{k}.mat", {"data": samples, "t": time, "label": "words"})
    path = tmp_path / "bench.toml"
    path.write_text(SIDECAR, encoding="utf-8")
    return path


@pytest.fixture
def edited(bench: Path) -> Callable[[str, str], Path]:
    """The sidecar with one piece of text replaced."""

    def edit(old: str, new: str) -> Path:
        text = bench.read_text(encoding="utf-8")
        assert old in text
        bench.write_text(text.replace(old, new), encoding="utf-8")
        return bench

    return edit


@pytest.fixture
def campaign() -> Campaign:
    """Two runs that differ in channel count, precision and notes."""
    generator = np.random.default_rng(1)
    force = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof.from_label("9+Z"), range_v=60.0)
    drive = Channel("drive", Quantity.GENERAL, ChannelRole.DRIVE)
    acc = [
        Channel(f"a{k}", Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof.from_label(f"{k}-Z"), "m/s^2", 0.1)
        for k in (1, 2)
    ]
    return Campaign(
        name="made up",
        geometry=Geometry(
            (1, 2, 9), generator.standard_normal((3, 3)), ((1, 2),), (generator.standard_normal((4, 3)),)
        ),
        runs=(
            Record(1, 2000.0, (drive, force, *acc), generator.standard_normal((4, 3000)), ("a1",), ("né",)),
            Record(4, 2000.0, (force, acc[0]), generator.standard_normal((2, 2500)).astype(np.float32)),
        ),
        band_hz=(1, 35),
        notes={"aircraft": "none, “made up”"},
    )


CHANNELS = ((100, 13), (1, 12), (2, 12)), ((100, 13), (3, 12), (4, 12))
"""Node and specific data type of each column of the bench's two runs, along +z; the very last one along -z."""


@pytest.fixture
def universal(bench: Path, volts: np.ndarray, edited: Callable[[str, str], Path]) -> Callable[..., Path]:
    """The bench in Universal Files: ``universal(write)`` makes raw/run1.uff, raw/run2.uff of what write gives.

    ``write(values, dof=, code=, unit=)`` gives one dataset as text or bytes. Returns the sidecar's path.
    """

    def write_with(write: Callable[..., str | bytes]) -> Path:
        edited('format = "mat"', 'format = "uff"')
        edited('samples = "data"\ntime_s = "t"\n', "")
        edited(".mat", ".uff")
        for run, channels in enumerate(CHANNELS):
            content = b""
            for k, (node, code) in enumerate(channels):
                direction = -3 if (run, k) == (1, 2) else 3
                dataset = write(volts[run][:, k], dof=(node, direction), code=code, unit="V")
                content += dataset.encode() if isinstance(dataset, str) else dataset
            (bench.parent / f"raw/run{run + 1}.uff").write_bytes(content)
        return bench

    return write_with
