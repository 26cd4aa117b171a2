"""The scenario's schema for editors and other programs."""

from __future__ import annotations

from typing import Any

from vgvt.scenario.inheritance import OWN_WORDS
from vgvt.scenario.model import Scenario
from vgvt.scenario.vocabulary import unit_of


def scenario_json_schema(*, extending: bool = False) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a complete scenario file, or of one that extends another.

    Descriptions are those of the schema with the unit that a key's ending states.
    """
    schema = Scenario.model_json_schema()
    tables = [schema, *schema["$defs"].values()]
    for table in tables:
        for key, entry in table.get("properties", {}).items():
            if unit := unit_of(key):
                entry["description"] = f"{entry.get('description', '')} Unit: {unit}.".strip()
    # One [shaker], or several [[shaker]].
    shaker = schema["properties"]["shaker"]
    one = {"$ref": shaker.pop("$ref")}
    shaker["anyOf"] = [one, {"type": "array", "items": one, "minItems": 1}]
    if extending:
        for table in tables:
            table.pop("required", None)
        schema["properties"]["extends"] = {
            "type": "string",
            "description": "Bundled name or relative path of the scenario that this one differs from.",
        }
        schema["required"] = ["extends", *(word for word in OWN_WORDS if word != "lesson")]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
