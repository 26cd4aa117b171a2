"""What every test shares: one BLAS thread, and the measured campaign where it exists."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

# Before numpy loads: contended BLAS threads slow small matrices by orders of magnitude.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(_name, "1")

ROOT = Path(__file__).resolve().parents[1]
CAMPAIGN = "hati-2015-09-24"


@pytest.fixture(scope="session")
def repository_root() -> Path:
    """The root of the checkout."""
    return ROOT


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
