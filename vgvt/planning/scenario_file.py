"""A plan as a scenario file that extends the one it came from: only what differs is written down."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from vgvt.scenario.model import Scenario

_LINE = 110


def plan_toml(base: Scenario, extends: str, plan: Scenario, name: str, summary: str) -> str:
    """TOML text of a scenario ``name`` that, extending ``extends`` (``base``), is ``plan``."""
    before, after = (s.model_dump(mode="json", exclude_none=True) for s in (base, plan))
    head = {"extends": extends, "name": name, "summary": summary, "seed": plan.seed}
    tables = {
        key: changed
        for key, value in after.items()
        if isinstance(value, Mapping) and (changed := _differences(before.get(key, {}), value))
    }
    lines = [f"{key} = {_value(value)}" for key, value in head.items()]
    for key, table in tables.items():
        lines += _table(table, key)
    known = {json.dumps(e, sort_keys=True) for e in before["effect"]}
    for effect in (e for e in after["effect"] if json.dumps(e, sort_keys=True) not in known):
        lines += ["", "[[effect]]", *(f"{key} = {_value(value)}" for key, value in effect.items())]
    return "\n".join(lines) + "\n"


def _differences(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, Any]:
    changed: dict[str, Any] = {}
    for key, value in after.items():
        if isinstance(value, Mapping):
            inner = _differences(before.get(key, {}), value)
            if inner:
                changed[key] = inner
        elif before.get(key) != value:
            changed[key] = value
    return changed


def _table(table: Mapping[str, Any], path: str) -> list[str]:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    lines = ["", f"[{path}]", *(f"{key} = {_value(value)}" for key, value in plain.items())] if plain else []
    for key, value in table.items():
        if isinstance(value, Mapping):
            lines += _table(value, f"{path}.{key}")
    return lines


def _value(value: Any) -> str:
    """A plain value as TOML, whose texts, numbers and lists JSON writes alike."""
    if isinstance(value, list) and value and len(json.dumps(value)) > _LINE:
        rows: list[str] = []
        for entry in value:
            text = f"{_value(entry)}, "
            if rows and len(rows[-1]) + len(text) <= _LINE - 2:
                rows[-1] += text
            else:
                rows.append(text)
        return "[\n" + "".join(f"  {row.rstrip()}\n" for row in rows) + "]"
    return json.dumps(value, ensure_ascii=False)
