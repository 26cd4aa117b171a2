"""Where measured data lie: VGVT_DATA, next to a checkout, or the user's own data folder."""

from __future__ import annotations

import os
from pathlib import Path

from vgvt.data import InputError

DATA_VARIABLE = "VGVT_DATA"


def user_data_folder() -> Path:
    """Where fetched data go when VGVT_DATA is not set: XDG_DATA_HOME/vgvt or ~/.local/share/vgvt."""
    base = os.environ.get("XDG_DATA_HOME")
    return (Path(base) if base else Path.home() / ".local" / "share") / "vgvt"


def default_data_folder() -> Path:
    """The folder that data sets are fetched into: VGVT_DATA where it is set, else the user's data folder."""
    given = os.environ.get(DATA_VARIABLE)
    return Path(given).expanduser() if given else user_data_folder()


def data_folders() -> tuple[Path, ...]:
    """Folders that are searched for data sets, in order; VGVT_DATA alone where it is set."""
    given = os.environ.get(DATA_VARIABLE)
    if given:
        return (Path(given).expanduser(),)
    checkout = Path(__file__).resolve().parents[2]
    beside = (checkout.parent / "shared" / "data",) if (checkout / "pyproject.toml").is_file() else ()
    return (*beside, user_data_folder())


def find_dataset(dataset: str, holds: str) -> Path:
    """The folder of a data set: the first place where the file ``holds`` (relative to it) exists.

    A searched folder may contain the data set or be it. InputError lists the places.
    """
    folders = data_folders()
    for folder in folders:
        for candidate in (folder / dataset, folder):
            if (candidate / holds).is_file():
                return candidate
    raise InputError(
        dataset,
        f"its records are not on this machine (looked for {holds} in {', '.join(str(f) for f in folders)})",
        f"fetch them with `vgvt data get {dataset}`, or set {DATA_VARIABLE} to the folder that contains {dataset}",
    )
