"""What holds arrays says in a few lines what it is: nobody reads thousands of numbers at a prompt."""

from __future__ import annotations

import dataclasses
import inspect
from importlib import import_module

PACKAGES = ("vgvt.data", "vgvt.simulation", "vgvt.signals", "vgvt.reconcile")


def shows_every_field(cls: type) -> bool:
    """Whether a class has the text that ``dataclass`` makes, which wraps a function of its own."""
    return hasattr(cls.__repr__, "__wrapped__")


def holds_arrays(cls: type) -> bool:
    """True for a dataclass that is compared by identity: arrays have no equality that is one answer."""
    return dataclasses.is_dataclass(cls) and "__eq__" not in vars(cls)


def public_classes() -> list[type]:
    modules = [import_module(package) for package in PACKAGES]
    return [value for module in modules for name in module.__all__ if inspect.isclass(value := getattr(module, name))]


def test_what_holds_arrays_has_a_short_text_of_its_own() -> None:
    found = [cls for cls in public_classes() if holds_arrays(cls)]
    assert len(found) > 15
    long = [cls.__qualname__ for cls in found if shows_every_field(cls)]
    assert not long, f"give it a __repr__ by vgvt.data.shown: {', '.join(long)}"


def test_the_check_can_tell() -> None:
    @dataclasses.dataclass(frozen=True, eq=False)
    class Long:
        values: tuple[float, ...]

    @dataclasses.dataclass(frozen=True, eq=False)
    class Short:
        values: tuple[float, ...]

        def __repr__(self) -> str:
            return "<Short>"

    assert holds_arrays(Long) and holds_arrays(Short)
    assert shows_every_field(Long) and not shows_every_field(Short)
