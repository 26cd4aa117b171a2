"""The strict frozen base of every table in a scenario."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo
from pydantic.json_schema import SkipJsonSchema

# Strict numbers: TOML has types of its own, so "130" in quotes or true is a slip to point out, not a number.
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Whole = Annotated[int, Field(strict=True)]
Node = Annotated[int, Field(ge=0, strict=True)]
"""Number of a point: a campaign's labels, like ``12+Z``, have no room for a sign of its own."""
Switch = Annotated[bool, Field(strict=True)]
Point = tuple[Finite, Finite, Finite]


class MisfitError(ValueError):
    """Values that do not fit together: at which key below the table, what is wrong, what to write.

    ``instead`` tells the same misfit at the other keys that make it: a file may have written one of them alone.
    """

    def __init__(
        self, key: tuple[str | int, ...], problem: str, advice: str, instead: tuple[MisfitError, ...] = ()
    ) -> None:
        self.key = key
        self.problem = problem
        self.advice = advice
        self.instead = instead
        super().__init__(f"{'.'.join(map(str, key))} {problem}; {advice}")


class Table(BaseModel):
    """A frozen table that refuses unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False, use_attribute_docstrings=True)


def written_fields(table: type[Table]) -> dict[str, FieldInfo]:
    """The fields that a file can write; those that ``SkipJsonSchema`` marks are for effects alone."""
    fields = table.model_fields.items()
    return {key: field for key, field in fields if not any(type(m) is SkipJsonSchema for m in field.metadata)}
