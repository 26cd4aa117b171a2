"""The bundled scenarios: text files that come with the package."""

from __future__ import annotations

import difflib
from pathlib import Path

from vgvt.data.errors import InputError

_PACKAGE = Path(__file__).parents[1]
_SPOILED = "spoiled-"


def library_folder() -> Path:
    """Where the bundled scenarios lie: inside an installed package, or ``scenarios/`` of a checkout."""
    for folder in (_PACKAGE / "_scenarios", _PACKAGE.parent / "scenarios"):
        if folder.is_dir():
            return folder
    raise InputError(
        str(_PACKAGE / "_scenarios"), "the bundled scenarios are missing", "Install the package again; it ships them."
    )


def bundled_scenarios() -> tuple[str, ...]:
    """Names of the bundled scenarios in alphabetical order, the spoiled ones left out."""
    return tuple(sorted(path.stem for path in library_folder().glob("*.toml")))


def spoiled_scenarios() -> tuple[str, ...]:
    """Names of the small scenarios that each show one effect, and of the clean one behind them, in alphabetical order.

    They are bundled like the others; the effect NAME has spoiled-NAME, in the file spoiled/NAME.toml.
    """
    return tuple(sorted(_SPOILED + path.stem for path in (library_folder() / "spoiled").glob("*.toml")))


def bundled_path(name: str, where: str | None = None) -> Path:
    """The file of a bundled scenario, spoiled ones too; InputError with the nearest names for an unknown one.

    ``where`` is the place that names it, for the message.
    """
    names, spoiled = bundled_scenarios(), spoiled_scenarios()
    if name in names:
        return library_folder() / f"{name}.toml"
    if name in spoiled:
        return library_folder() / "spoiled" / f"{name.removeprefix(_SPOILED)}.toml"
    near = difflib.get_close_matches(name.lower(), (*names, *spoiled), n=2, cutoff=0.5)
    guess = f"Did you mean {' or '.join(near)}? " if near else ""
    raise InputError(
        where or name,
        "there is no bundled scenario of this name" if where is None else f"there is no bundled scenario {name!r}",
        f"{guess}Bundled are {', '.join(names)}; name a scenario of your own by its path, like ./mine.toml.",
    )
