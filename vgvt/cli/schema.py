"""``vgvt schema``: the JSON Schema of a scenario, for editors that complete and check TOML."""

from __future__ import annotations

from vgvt.cli.document import write_document
from vgvt.cli.options import JsonOption


def schema(as_json: JsonOption = False) -> int:
    """Print the JSON Schema of a scenario file (it is JSON with and without --json)."""
    from vgvt.scenario import scenario_json_schema

    write_document(scenario_json_schema())
    return 0
