"""What an identifier needs installed beside vgvt: an adapter to another library is no use without it."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Requirement:
    """A module that an identifier imports when it works, and the package that brings it, as pip takes it.

    An identifier class lists its own as ``requires: ClassVar[tuple[Requirement, ...]]``.
    """

    module: str
    package: str

    @property
    def present(self) -> bool:
        """Whether the module can be found; it is not imported, only the packages around it are."""
        try:
            return importlib.util.find_spec(self.module) is not None
        except ModuleNotFoundError:  # of a package around it
            return False


def missing_requirements(identifier: object) -> tuple[Requirement, ...]:
    """What an identifier, or its class, requires and this installation lacks."""
    return tuple(r for r in getattr(identifier, "requires", ()) if not r.present)


def install_advice(missing: tuple[Requirement, ...]) -> str:
    """The command that installs what is missing."""
    return "pip install " + " ".join(dict.fromkeys(f"'{r.package}'" for r in missing))
