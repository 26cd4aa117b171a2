"""Under ``python -O`` there is no assert: the suites for authors of plugins judge nothing rather than pass anything."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from vgvt.data import InputError, plugin
from vgvt.effects import conformance as of_declarations
from vgvt.identification import conformance as of_identifiers
from vgvt.simulation import effect_conformance as of_effects


def compiled_without_assert(module: ModuleType) -> dict[str, Any]:
    """What a module defines where Python leaves assert out, which it does as it compiles."""
    names: dict[str, Any] = {"__name__": module.__name__}
    source = Path(str(module.__file__)).read_text(encoding="utf-8")
    exec(compile(source, str(module.__file__), "exec", optimize=1), names)
    return names


def test_the_suites_refuse_to_judge(monkeypatch: pytest.MonkeyPatch) -> None:
    refuse = compiled_without_assert(plugin)["need_asserts"]
    for module in (of_identifiers, of_declarations):
        monkeypatch.setattr(module, "need_asserts", refuse)
    for checks in (of_identifiers.checks, of_declarations.declaration_checks, of_effects.checks):
        with pytest.raises(InputError, match="assert statements are switched off") as told:
            checks()
        assert "PYTHONOPTIMIZE unset" in told.value.advice


def test_with_assert_they_judge() -> None:
    plugin.need_asserts()
    assert of_identifiers.checks() and of_effects.checks()
