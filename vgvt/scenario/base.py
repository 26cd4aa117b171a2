"""The strict frozen base of every table in a scenario."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# Strict numbers: TOML has types of its own, so "130" in quotes or true is a slip to point out, not a number.
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Whole = Annotated[int, Field(strict=True)]
Switch = Annotated[bool, Field(strict=True)]
Point = tuple[Finite, Finite, Finite]


class MisfitError(ValueError):
    """Values that do not fit together: at which key below the table, what is wrong, what to write."""

    def __init__(self, key: tuple[str | int, ...], problem: str, advice: str) -> None:
        self.key = key
        self.problem = problem
        self.advice = advice
        super().__init__(f"{'.'.join(map(str, key))} {problem}; {advice}")


class Table(BaseModel):
    """A frozen table that refuses unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False, use_attribute_docstrings=True)
