"""The code that a bench's results come from, as one short text: what is kept counts as long as that is the same."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path

from vgvt._version import __version__
from vgvt.bench.entry import Entry

_LIBRARIES = ("numpy", "scipy", "mujoco")
_NO_PART = {"cli", "view", "lab", "reconcile", "planning"}  # of vgvt: they come after the bench


def fingerprint(entries: Sequence[Entry]) -> str:
    """Version of vgvt and a hash over the sources of simulation, scoreboard, plugins and libraries' versions.

    Of the libraries count numpy and the like, and those that an entry requires, whether installed or not. A method
    that was edited is another method, whatever its version says: its old results must not be taken for the new ones.
    """
    names = {entry.identifier for entry in entries}
    points = [p for p in entry_points(group="vgvt.identifiers") if p.name in names]
    plugins = {p.value.partition(":")[0].partition(".")[0] for p in (*points, *entry_points(group="vgvt.effects"))}
    parts = [sources_hash(name) for name in sorted(plugins | {"vgvt", "vgvt_scoreboard"})]
    parts += [f"{name} {_version(name)}" for name in _LIBRARIES]
    parts += sorted({part for point in points for part in _required(point)})
    return f"{__version__}+{hashlib.sha256('; '.join(parts).encode()).hexdigest()[:16]}"


@functools.cache
def sources_hash(package: str) -> str:
    """A hash over the .py files of an importable package or module, without importing it; empty where there are none.

    Read once a process.
    """
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        spec = None
    if spec is None:
        return ""
    folders = [Path(place) for place in spec.submodule_search_locations or ()]
    files = [(path.relative_to(folder), path) for folder in folders for path in sorted(folder.rglob("*.py"))]
    if not folders and spec.origin is not None and spec.origin.endswith(".py"):
        files = [(Path(spec.origin).relative_to(Path(spec.origin).parent), Path(spec.origin))]
    digest = hashlib.sha256()
    for name, path in files:
        if package == "vgvt" and name.parts[0] in _NO_PART:
            continue
        digest.update(f"{name.as_posix()}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _required(point: EntryPoint) -> list[str]:
    """The libraries that a plugin requires, each with what is installed of it; or why it cannot be asked."""
    try:
        plugin = point.load()
    except Exception as error:  # noqa: BLE001  whatever an import raises: its rows will say that it is no use
        return [f"{point.value} {type(error).__name__}"]
    return [f"{required.module} {_installed(required.module)}" for required in getattr(plugin, "requires", ())]


def _installed(module: str) -> str:
    """What is installed of a module: the versions of the packages that bring it, and its sources; empty for nothing."""
    packages = sorted(set(packages_distributions().get(module.partition(".")[0], ())))
    return " ".join(filter(None, (*(f"{name} {_version(name)}" for name in packages), sources_hash(module))))


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return ""
