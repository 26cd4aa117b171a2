"""Where measured data lie: VGVT_DATA, next to a checkout, or the user's own data folder."""

from __future__ import annotations

import os
from pathlib import Path

from vgvt.data import InputError

DATA_VARIABLE = "VGVT_DATA"


def user_data_folder() -> Path:
    """Where fetched data go when VGVT_DATA is not set: XDG_DATA_HOME/vgvt or ~/.local/share/vgvt.

    InputError where neither is known, as for a user without a home folder.
    """
    if base := os.environ.get("XDG_DATA_HOME"):
        return Path(base) / "vgvt"
    try:
        return Path.home() / ".local" / "share" / "vgvt"
    except RuntimeError:
        advice = f"set HOME, XDG_DATA_HOME or {DATA_VARIABLE} to a folder for them"
        raise InputError("measured data", "you have no home folder to keep them in", advice) from None


def default_data_folder() -> Path:
    """The folder that data sets are fetched into: VGVT_DATA where it is set, else the user's data folder."""
    return _named_folder() or user_data_folder()


def data_folders() -> tuple[Path, ...]:
    """Folders that are searched for data sets, in order; VGVT_DATA alone where it is set."""
    if named := _named_folder():
        return (named,)
    checkout = Path(__file__).resolve().parents[2]
    beside = (checkout.parent / "shared" / "data",) if (checkout / "pyproject.toml").is_file() else ()
    try:
        return (*beside, user_data_folder())
    except InputError:
        if beside:
            return beside  # what lies there is found without a home folder, too
        raise


def _named_folder() -> Path | None:
    """The folder that VGVT_DATA names; None where it names none."""
    given = os.environ.get(DATA_VARIABLE)
    if not given:
        return None
    try:
        return Path(given).expanduser()
    except RuntimeError:
        raise InputError(DATA_VARIABLE, f"{given}: there is no such home folder", "write the path in full") from None


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
