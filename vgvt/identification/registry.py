"""Finds identifiers by entry point (group ``vgvt.identifiers``) and makes one by name with settings."""

from __future__ import annotations

import dataclasses
import difflib
import types
import typing
import warnings
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from vgvt.data import InputError
from vgvt.data.plugin import lacking, one_of_each_name
from vgvt.identification.protocol import Identifier, Needs
from vgvt.identification.requirement import install_advice, missing_requirements

GROUP = "vgvt.identifiers"
_DECLARED = {"summary": str, "citation": str, "needs": Needs}


class PluginWarning(UserWarning):
    """An installed plugin could not be used."""


@dataclasses.dataclass(frozen=True, slots=True)
class Setting:
    """One setting of an identifier, for listings: its name, type in words, default and meaning."""

    name: str
    type: str
    default: str
    doc: str


def available_identifiers() -> dict[str, type]:
    """Every usable installed identifier class by name, in alphabetical order.

    A plugin that cannot be imported or is not an identifier is left out with a
    ``PluginWarning`` that names it; it never breaks the others. So is one of a name that a bundled
    identifier has, or another plugin of a package that comes first. One that requires a library
    which is not installed is left out without a word: ``absent_identifiers`` has it.
    """
    return {name: cls for name, cls in _installed().items() if not missing_requirements(cls)}


def absent_identifiers() -> dict[str, str]:
    """Identifiers that only lack a library, by name, and the command that installs it."""
    lacking = {name: missing_requirements(cls) for name, cls in _installed().items()}
    return {name: install_advice(missing) for name, missing in lacking.items() if missing}


def _installed() -> dict[str, type]:
    return one_of_each_name(entry_points(group=GROUP), _load, _warn)


def make_identifier(name: str, **settings: Any) -> Identifier:
    """The identifier registered as ``name`` with some settings changed.

    Settings given as text (from a command line or a file) become the type of
    the field. Raises InputError for an unknown name, an unknown setting or a
    value that does not fit, with what to write instead, or a library that is not installed.
    """
    cls = _named(name)
    if cls is None:
        raise InputError(f"identifier {name!r}", "no such identifier", _advice(name))
    missing = missing_requirements(cls)
    if missing:
        lacking = ", ".join(r.module for r in missing)
        raise InputError(f"identifier {name!r}", f"needs {lacking}, which is not installed", install_advice(missing))
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    for key in settings:
        if key not in fields:
            raise InputError(f"identifier {name!r}", f"no setting {key!r}", _did_you_mean(key, list(fields)))
    hints = typing.get_type_hints(cls)
    values = {key: _convert(name, key, value, hints[key]) for key, value in settings.items()}
    try:
        made: Identifier = cls(**values)
    except InputError:
        raise
    except (TypeError, ValueError) as error:
        raise InputError(f"identifier {name!r}", str(error), _settings_line(cls)) from error
    return made


def settings_of(cls: type) -> tuple[Setting, ...]:
    """The settings of an identifier class; their meaning is ``metadata={"doc": ...}`` of the field."""
    hints = typing.get_type_hints(cls)
    return tuple(
        Setting(f.name, _type_name(hints[f.name]), _default_of(f), str(f.metadata.get("doc", "")))
        for f in dataclasses.fields(cls)
        if f.init
    )


def _named(name: str) -> type | None:
    """The class registered as ``name``; plugins of other names are not even imported."""
    return one_of_each_name((p for p in entry_points(group=GROUP) if p.name == name), _load, _warn).get(name)


def _load(point: EntryPoint) -> type | None:
    try:
        loaded = point.load()
    except Exception as error:  # noqa: BLE001  whatever a third-party import raises must not stop the others
        why = f"{type(error).__name__}: {error}"
    else:
        why = lacking(loaded, point.name, "identify(campaign, band_hz)", _DECLARED)
        if not why:
            return typing.cast(type, loaded)
    _warn(f"identifier plugin {point.name!r} ({point.value}) is left out: {why}")
    return None


def _warn(what: str) -> None:
    # From one place whoever asks, so that a command that asks often says it once.
    warnings.warn(what, PluginWarning, stacklevel=1)


def _advice(name: str) -> str:
    """What to write instead of a name that there is not; ``era:order=16`` is how a bench names its entries."""
    known = list(available_identifiers())
    method, colon, settings = name.partition(":")
    if colon and method in known:
        apart = " ".join(f"--setting {pair.strip()}" for pair in settings.split(",") if "=" in pair)
        return f"settings come on their own: --identifier {method} {apart or '--setting KEY=VALUE'}"
    return _did_you_mean(name, known)


def _did_you_mean(word: str, known: list[str]) -> str:
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    guess = f"did you mean {close[0]!r}? " if close else ""
    return f"{guess}known: {', '.join(known) if known else 'none'}"


def _settings_line(cls: type) -> str:
    return "settings: " + ", ".join(f"{s.name} ({s.type}, default {s.default})" for s in settings_of(cls))


def _default_of(field: dataclasses.Field[Any]) -> str:
    if field.default is not dataclasses.MISSING:
        return str(field.default)
    if field.default_factory is not dataclasses.MISSING:
        return str(field.default_factory())
    return "required"


def _type_name(hint: Any) -> str:
    if typing.get_origin(hint) is typing.Literal:
        return " | ".join(map(str, typing.get_args(hint)))
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return " | ".join(_type_name(h) for h in typing.get_args(hint))
    return "none" if hint is type(None) else getattr(hint, "__name__", str(hint))


def _convert(name: str, key: str, value: Any, hint: Any) -> Any:
    """``value`` as the type of the field, InputError when no alternative of the type takes it."""
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    for one in typing.get_args(hint) if union else (hint,):
        try:
            return _as(value, one)
        except (TypeError, ValueError):
            continue
    raise InputError(f"identifier {name!r}", f"{key} = {value!r} is not {_type_name(hint)}", f"give {_type_name(hint)}")


def _as(value: Any, hint: Any) -> Any:
    if typing.get_origin(hint) is typing.Literal:
        if value in typing.get_args(hint):
            return value
        raise ValueError(value)
    if hint is type(None) or hint is None:
        if value is None or str(value).lower() == "none":
            return None
        raise ValueError(value)
    if hint is bool:
        if str(value).lower() in ("true", "false"):
            return str(value).lower() == "true"
        raise ValueError(value)
    if hint in (int, float):
        if isinstance(value, bool):
            raise TypeError(value)
        number = hint(value)
        if isinstance(value, float) and number != value:
            raise ValueError(value)
        return number
    if isinstance(hint, type) and not isinstance(value, hint):
        raise TypeError(value)
    return value
