"""What every test shares: one BLAS thread, packages with plugins, and the measured campaign where it exists."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

# Before numpy loads: contended BLAS threads slow small matrices by orders of magnitude.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(_name, "1")

ROOT = Path(__file__).resolve().parents[1]
CAMPAIGN = "hati-2015-09-24"


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Tests run in this process, unless several are asked for: pytest-benchmark refuses where they were shared out."""
    if not config.getoption("numprocesses", None):
        config.option.dist = "no"


@pytest.fixture(scope="session")
def repository_root() -> Path:
    """The root of the checkout."""
    return ROOT


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """Puts a package in place as pip leaves it: a module of a source text, and entry points to what it holds.

    ``install("package", source, "vgvt.effects", {"name": "Class"})``; the module is called as the package.
    """
    modules: list[str] = []

    def put(package: str, source: str, group: str, points: dict[str, str]) -> None:
        site = tmp_path / f"site-{package}"
        metadata = site / f"{package}-1.dist-info"
        metadata.mkdir(parents=True)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1\n")
        lines = [f"{name} = {package}:{attribute}\n" for name, attribute in points.items()]
        (metadata / "entry_points.txt").write_text(f"[{group}]\n{''.join(lines)}")
        (site / f"{package}.py").write_text(source)
        monkeypatch.syspath_prepend(site)
        importlib.invalidate_caches()
        modules.append(package)

    yield put
    for module in modules:
        sys.modules.pop(module, None)


@pytest.fixture(scope="session")
def measured_folder() -> Path:
    """Folder of the measured Hati campaign; the test is skipped where it is absent."""
    stated = os.environ.get("VGVT_DATA")
    places = [Path(stated), Path(stated) / CAMPAIGN] if stated else []
    places.append(ROOT.parent / "shared" / "data" / CAMPAIGN)
    for place in places:
        if (place / "raw").is_dir() or any(place.glob("hati_*.npz")):
            return place
    pytest.skip(f"the measured campaign is absent: set VGVT_DATA to the folder that holds {CAMPAIGN}")
