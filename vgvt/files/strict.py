"""Strict TOML tables: unknown keys are refused and every mistake is told with its key path."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Table(BaseModel):
    """A frozen table that refuses unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False, use_attribute_docstrings=True)


_T = TypeVar("_T", bound=Table)


def load_table(path: Path, model: type[_T]) -> _T:
    """A TOML file as a checked table; InputError names the file, the line or key path, and what to write."""
    try:
        with path.open("rb") as stream:
            content = tomllib.load(stream)
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(str(path), f"not valid TOML: {error}", "mend the line named") from error
    try:
        return model.model_validate(content)
    except ValidationError as error:
        lines = [_explain(model, detail["loc"], detail["type"], detail["msg"]) for detail in error.errors()]
        where, problem, advice = lines[0]
        rest = "".join(f"\n  also {w}: {p}; {a}" if a else f"\n  also {w}: {p}" for w, p, a in lines[1:6])
        more = f"\n  and {len(lines) - 6} more" if len(lines) > 6 else ""
        raise InputError(f"{path}, {where}", problem, advice + rest + more) from error


def _explain(model: type[Table], location: tuple[Any, ...], kind: str, message: str) -> tuple[str, str, str]:
    where = _key_path(location)
    if kind == "extra_forbidden":
        known = _keys_at(model, location[:-1])
        return where, "unknown key", choose_one_of(str(location[-1]), known) if known else "leave it out"
    if kind == "missing":
        return where, "is missing", f"write {location[-1]} = ..."
    problem, _, advice = message.removeprefix("Value error, ").partition("; ")
    return where, problem, advice


def _key_path(location: tuple[Any, ...]) -> str:
    """``run[3].nodes``: entries of arrays of tables are counted from 1, as people do."""
    path = ""
    for step in location:
        path += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if path else str(step)
    return path or "the file as a whole"


def _keys_at(model: type[Table], location: tuple[Any, ...]) -> tuple[str, ...]:
    """The keys of the table at a place in the model; empty where that is no table."""
    table: Any = model
    for step in location:
        if isinstance(step, int):
            continue
        if not (isinstance(table, type) and issubclass(table, Table)) or step not in table.model_fields:
            return ()
        annotation = table.model_fields[step].annotation
        table = next((a for a in (annotation, *getattr(annotation, "__args__", ())) if isinstance(a, type)), None)
    return tuple(table.model_fields) if isinstance(table, type) and issubclass(table, Table) else ()
