"""Watches what an identifier reaches for while it works, through Python's audit events.

An audit hook can be neither removed nor seen by the code that it watches. It is no sandbox
against a hostile program; it is a witness against a method that peeks.
"""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from vgvt.identification.isolation import FORBIDDEN

_STARTS_PROCESS = {"subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.forkpty"}
_TALKS = {"socket.connect", "socket.bind"}
_CODE = {".py", ".pyc", ".pyd", ".so", ".dll", ".dylib", ".pth", ".nbi", ".nbc"}
# Python, and numba, keep what they have compiled under such a name until all of it is there.
_COMPILED = re.compile(r"\.pyc\.\d+$|\.nb[ic]\.tmp\.\w+$")
_SYSTEM = ("/proc", "/sys", "/dev", "/etc", "/usr/share", "/usr/lib")
_SEALED = {"sealed", "truth.nc", "scenario.toml"}


class Watch:
    """Remembers what was reached for and not allowed; ``start`` cannot be undone within the process.

    ``allowed`` are folders whose files may be read: those of the task. Code may be read from
    anywhere, and so may what lies in the installation of Python and the system's own folders.
    """

    def __init__(self, allowed: tuple[Path, ...]) -> None:
        self.misdeeds: list[str] = []
        installation = (Path(sys.prefix), Path(sys.base_prefix), Path(sys.exec_prefix))
        self._allowed = tuple(os.path.realpath(p) for p in (*allowed, *installation)) + _SYSTEM

    def start(self) -> None:
        """Watch from now on."""
        _watch_hdf5()
        # Asked once and remembered: libraries ask for it when they are imported, and it starts a process.
        platform.processor()
        sys.addaudithook(self._hook)

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "import":
            module = str(arguments[0])
            if any(module == f or module.startswith(f + ".") for f in FORBIDDEN):
                self._note(f"imports {module}")
        elif event in ("open", "vgvt.open"):
            self._look(arguments[0])
        elif event in _STARTS_PROCESS:
            self._note(f"starts another process ({arguments[0]})" if arguments else "starts another process")
        elif event in _TALKS:
            self._note("uses the network")

    def _look(self, path: Any) -> None:
        if not isinstance(path, str | bytes | os.PathLike):
            return  # an open file descriptor
        text = os.fsdecode(path)
        full = os.path.realpath(text)
        parts = set(Path(full).parts)
        if parts & _SEALED:
            self._note(f"reads {text}")
        elif not (full.startswith(self._allowed) or _is_code(full) or _is_harmless(full)):
            self._note(f"reads {text}, which it was not given")

    def _note(self, misdeed: str) -> None:
        if misdeed not in self.misdeeds:
            self.misdeeds.append(misdeed)


def _is_code(path: str) -> bool:
    return Path(path).suffix in _CODE or _COMPILED.search(path) is not None


def _is_harmless(path: str) -> bool:
    """Folders are no files; what is said about installed packages is no secret, nor is matplotlib's list of fonts."""
    file = Path(path)
    fonts = file.name.startswith("fontlist-v") and file.suffix == ".json" and file.parent.name == "matplotlib"
    return file.is_dir() or file.parent.suffix in (".dist-info", ".egg-info") or fonts


def _watch_hdf5() -> None:
    """HDF5 opens files in C, where no audit event is raised: raise one for it."""
    import h5py

    def audited(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(name: Any, *arguments: Any, **more: Any) -> Any:
            sys.audit("vgvt.open", os.fsdecode(name) if isinstance(name, bytes) else name)
            return function(name, *arguments, **more)

        return call

    h5py.h5f.open = audited(h5py.h5f.open)
