"""Write the reference of the scenario's keys from its schema: ``python docs/make_scenario_keys.py``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.command_line import BEGIN_AGAIN, parser_of, worked_off

from vgvt.files.atomically import replacing
from vgvt.scenario import Scenario
from vgvt.scenario.base import Table, written_fields
from vgvt.scenario.vocabulary import inner_table, unit_of

PAGE = Path(__file__).parent / "reference" / "scenario-keys.md"

_HEAD = """# The keys of a scenario

Written by `python docs/make_scenario_keys.py` from the schema; edit the texts in `vgvt/scenario/`, not this page.

Every key ends in its unit. Numbers are SI; positions are aircraft axes: x aft from the nose, y right, z up. A key
without a default must be there; one that is *left out* by default means what its text says. A file that begins with
`extends` gives only what differs ([how](../how-to/write-your-own-scenario.md)). `vgvt schema` prints the same as JSON
Schema.
"""

_BOUNDS = {"exclusiveMinimum": "> {:g}", "minimum": "≥ {:g}", "exclusiveMaximum": "< {:g}", "maximum": "≤ {:g}"}
_KINDS = {"number": "number", "integer": "whole number", "boolean": "true or false", "string": "text"}


def tables() -> dict[type[Table], list[str]]:
    """Every table of the schema in the order of a file, with the headings under which it stands."""
    found: dict[type[Table], list[str]] = {}

    def walk(table: type[Table], heading: str, path: str) -> None:
        found.setdefault(table, []).append(heading)
        for key, field in written_fields(table).items():
            inner = inner_table(field.annotation)
            if inner is not None:
                here = f"{path}.{key}".lstrip(".")
                walk(inner, f"[[{here}]]" if _is_array(field.annotation) else f"[{here}]", here)

    walk(Scenario, "The top of the file", "")
    return found


def keys_page() -> str:
    """The whole page as Markdown: one section a table, one row a key."""
    lines = [_HEAD]
    for table, headings in tables().items():
        title = ", ".join(f"`{h}`" if h.startswith("[") else h for h in headings)
        lines += [f"## {title}", "", " ".join((table.__doc__ or "").split()).replace("``", "`"), ""]
        lines += ["| key | type | unit | default | meaning |", "|---|---|---|---|---|"]
        lines += _rows(table)
        lines.append("")
        if table.model_config.get("extra") == "allow":
            lines += ["The other keys are the effect's own: [the effects](effects.md).", ""]
    return "\n".join(lines).rstrip() + "\n"


def _rows(table: type[Table]) -> list[str]:
    properties = table.model_json_schema()["properties"]
    rows = []
    for key, field in written_fields(table).items():
        inner, entry = inner_table(field.annotation), properties[key]
        form = f"table{'s' if _is_array(field.annotation) else ''}" if inner else _form(entry)
        meaning = " ".join((field.description or "").split()).replace("``", "`")
        cells = (f"`{key}`", form, unit_of(key), _default(entry, field.is_required()), meaning)
        rows.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return rows


def _is_array(annotation: Any) -> bool:
    return str(annotation).startswith("tuple")


def _form(entry: dict[str, Any]) -> str:
    """What may be written, in words, from a property of the JSON Schema."""
    if "anyOf" in entry:
        return " or ".join(_form(option) for option in entry["anyOf"] if option.get("type") != "null")
    if "enum" in entry:
        return " or ".join(f'`"{value}"`' for value in entry["enum"])
    if "const" in entry:
        return f"`{entry['const']}`"
    if entry["type"] == "array":
        return _list_form(entry)
    bounds = [words.format(entry[limit]) for limit, words in _BOUNDS.items() if limit in entry]
    return " ".join([_KINDS[entry["type"]], ", ".join(bounds)]).strip()


def _list_form(entry: dict[str, Any]) -> str:
    if "prefixItems" in entry:
        return f"{len(entry['prefixItems'])} × {_form(entry['prefixItems'][0])}"
    inner = _form(entry["items"])
    least = f", at least {entry['minItems']}" if entry.get("minItems") else ""
    return f"list of ({inner}){least}" if " " in inner else f"list of {inner}{least}"


def _default(entry: dict[str, Any], required: bool) -> str:
    if required:
        return ""
    value = entry.get("default")
    if value is None:
        return "*left out*"
    if isinstance(value, dict):
        return "*its defaults*"
    if value in ("", []):
        return "*none*"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else str(value)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, on which there is nothing to choose."""
    return parser_of(__doc__).parse_args(words)


def fill() -> None:
    """Write the page."""
    with replacing(PAGE) as part:
        part.write_text(keys_page(), encoding="utf-8")


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    arguments(words)
    return worked_off(fill, BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
