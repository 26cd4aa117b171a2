"""What effects do, as a hash: an answer belongs to the effect that was tried, not to the next one of that name.

Whoever writes an effect tries it, edits it and tries again, in the same folder and under the same name and version.
"""

from __future__ import annotations

import dataclasses
import hashlib
import inspect
import re
import sys
from collections.abc import Mapping
from types import CodeType, FunctionType
from typing import Any

import numpy as np
from pydantic import BaseModel

from vgvt.effects.registry import available_effects
from vgvt.scenario.model import Scenario

# Where an object lies in memory is another place in every process.
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def code_of(effects: Mapping[str, type], scenario: Scenario) -> str:
    """Hash of the effects by name, and of those that a scenario has in its tables: the same in every process.

    It covers the source of the modules that classes and their bases are in, and the classes themselves. Of what these
    modules import nothing is asked.
    """
    known = available_effects()
    declared = {table.name: known[table.name] for table in scenario.effect if table.name in known}
    found = hashlib.sha256()
    for name, cls in sorted((declared | dict(effects)).items()):
        found.update(repr((name, _class(cls))).encode())
    return found.hexdigest()


def _class(cls: type) -> list[Any]:
    """A class with its bases: their modules' source, their fields and their own code.

    Source alone does not tell two classes apart that one function makes; a class that was typed in has none.
    """
    parts: list[Any] = []
    for base in cls.__mro__:
        if base.__module__ not in ("builtins", "typing"):
            own = {name: _told(value) for name, value in vars(base).items() if _is_code(name, value)}
            parts.append((base.__qualname__, _source(base.__module__), sorted(own.items())))
    fields = dataclasses.fields(cls) if dataclasses.is_dataclass(cls) else ()
    return [*parts, *((f.name, str(f.type), _told(f.default), _told(dict(f.metadata))) for f in fields)]


def _is_code(name: str, value: Any) -> bool:
    """Whether a member of a class says what it does, and is no note of Python's, nor a store that fills as it runs."""
    return isinstance(value, FunctionType) or not (name.startswith("__") or isinstance(value, dict | list | set))


def _source(module: str) -> str:
    try:
        return inspect.getsource(sys.modules[module])
    except (KeyError, OSError, TypeError):
        return ""


def _told(value: Any, within: tuple[FunctionType, ...] = ()) -> Any:
    """A value as what has the same text in every process; ``within`` functions that may hold each other.

    What an object shows of itself is not all that it is: of those that hold values these are told.
    """
    if isinstance(value, classmethod | staticmethod):
        return _told(value.__func__, within)
    if isinstance(value, property):
        return [_told(f, within) for f in (value.fget, value.fset, value.fdel)]
    if isinstance(value, FunctionType):
        if value in within:
            return value.__qualname__
        held = [c.cell_contents for c in value.__closure__ or () if _filled(c)]
        kept = (value.__code__, *held, *(value.__defaults__ or ()), value.__kwdefaults__ or {})
        return [_told(k, (*within, value)) for k in kept]
    if isinstance(value, CodeType):
        return [value.co_code.hex(), value.co_names, [_told(c) for c in value.co_consts]]
    if isinstance(value, Mapping):
        return [(str(k), _told(v, within)) for k, v in value.items()]
    if isinstance(value, tuple | list):
        return [_told(v, within) for v in value]
    if isinstance(value, set | frozenset):
        return sorted(repr(_told(v, within)) for v in value)
    names: list[str] | None = None
    if isinstance(value, BaseModel):
        names = [*type(value).model_fields]
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        names = [f.name for f in dataclasses.fields(value)]
    if names is not None:
        return [type(value).__qualname__, *(_told(getattr(value, name), within) for name in names)]
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return [str(value.dtype), value.shape, value.tobytes().hex()]
    return _ADDRESS.sub("", repr(value))


def _filled(cell: Any) -> bool:
    try:
        cell.cell_contents  # noqa: B018  asked for what it raises
    except ValueError:
        return False
    return True
