"""An ``[[effect]]`` table: the name of an effect and its parameters, checked when the effect is looked up."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, model_validator

from vgvt.scenario.base import Table


class EffectTable(Table):
    """A departure from the ideal test that the scenario switches on; ``vgvt list effects`` names them all."""

    model_config = ConfigDict(frozen=True, extra="allow", strict=False, use_attribute_docstrings=True)

    name: str
    """Name of the effect; every other key is one of its parameters."""

    @property
    def parameters(self) -> dict[str, object]:
        """The other keys and their values."""
        return dict(self.__pydantic_extra__ or {})

    @model_validator(mode="after")
    def _plain_values(self) -> Self:
        for key, value in self.parameters.items():
            if not isinstance(value, bool | int | float | str):
                raise ValueError(f"{key} must be a number, a word or true/false, got {value!r}")
        return self
