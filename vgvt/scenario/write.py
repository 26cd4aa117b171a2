"""A scenario as TOML text: complete, explicit, and the same scenario when read again."""

from __future__ import annotations

from vgvt.files.toml_text import toml_text
from vgvt.scenario.model import Scenario


def to_toml(scenario: Scenario) -> str:
    """The resolved scenario, defaults included, as TOML 1.0 text that loads to an equal scenario.

    One that effects have hung items on hinges of has no such text: a file cannot write ``airframe.hinged``.
    """
    exclude = None if scenario.airframe.hinged else {"airframe": {"hinged"}}
    return toml_text(scenario.model_dump(exclude_none=True, exclude=exclude))
