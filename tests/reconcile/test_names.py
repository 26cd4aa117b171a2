"""The public names are functions and nouns in whatever order their homes are imported."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

import vgvt.reconcile


def test_a_name_is_never_the_module_that_holds_it() -> None:
    for name in vgvt.reconcile.__all__:
        import_module(f"vgvt.reconcile.{vgvt.reconcile._HOME_OF[name]}")
        assert not isinstance(getattr(vgvt.reconcile, name), ModuleType), name
