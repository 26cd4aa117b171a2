"""What is bundled and what is somebody else's: which of two plugins of one name counts, and whose fault one is."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import EntryPoint

from vgvt.data.errors import InputError

_BUNDLED = frozenset({"vgvt", "vgvt_identifiers", "vgvt_scoreboard"})


class PluginError(ValueError):
    """A plugin failed, or gave what it may not give: a mistake in it, not in the input. Exit status 1 of a command.

    A ValueError, so that whoever tries many variants goes on without one that fails as without one that is refused.
    """


def is_bundled(module: str) -> bool:
    """Whether a module comes with this program."""
    return module.partition(".")[0] in _BUNDLED


def package_of(point: EntryPoint) -> str:
    """The distribution that an entry point is of, by its name on a package index; its module where that is unknown."""
    return point.dist.name if point.dist is not None else point.module


def one_of_each_name(
    points: Iterable[EntryPoint], load: Callable[[EntryPoint], type | None], tell: Callable[[str], None]
) -> dict[str, type]:
    """The class by name, in alphabetical order: what is bundled before what is not, then by package.

    ``load`` gives None for what is of no use, and says so itself; ``tell`` is given a sentence for each class that
    has to make way for another one of its name.
    """
    points = tuple(points)
    alike = Counter(p.name for p in points)

    def order(p: EntryPoint) -> tuple[str, bool, str, str]:
        # The name of a package is in a file, and this is asked for often: only where names are the same.
        return p.name, not is_bundled(p.module), package_of(p) if alike[p.name] > 1 else "", p.value

    found: dict[str, tuple[type, EntryPoint]] = {}
    for point in sorted(points, key=order):
        loaded = load(point)
        if loaded is None:
            continue
        first, used = found.setdefault(point.name, (loaded, point))
        if first is not loaded:
            left_out = f"that of {package_of(point)} ({point.value}) is left out"
            advice = "give it another name, in the class and in its entry point"
            tell(f"two are called {point.name!r}: that of {package_of(used)} is used, {left_out}; {advice}")
    return {name: cls for name, (cls, _) in found.items()}


def lacking(cls: object, name: str, method: str, attributes: Mapping[str, type]) -> str:
    """What keeps a thing from being a plugin registered as ``name``, in words; empty where nothing does.

    ``method`` is its one method as it is called, like ``act(scenario, run)``, ``attributes`` are the types of those
    that the class itself must have.
    """
    if not (
        isinstance(cls, type)
        and dataclasses.is_dataclass(cls)
        and callable(getattr(cls, method.partition("(")[0], None))
    ):
        return f"it is not a dataclass with a method {method}"
    if cls.__dict__.get("name") != name:
        own = cls.__dict__.get("name")
        if own is None:
            return f"the class has no name of its own: write name: ClassVar[str] = {name!r}"
        return f"the class calls itself {own!r}"
    for attribute, kind in attributes.items():
        if not isinstance(getattr(cls, attribute, None), kind):
            return f"its class attribute {attribute!r} is missing, or no {kind.__name__}"
    return ""


def need_asserts() -> None:
    """InputError where Python leaves assert statements out: checks that are made of them would pass any plugin."""
    if not __debug__:
        problem = "assert statements are switched off, and the checks are made of them: they would pass anything"
        raise InputError("conformance checks", problem, "run Python without -O, and with PYTHONOPTIMIZE unset")


@contextmanager
def whose_fault(plugin: object, title: str, doing: str) -> Iterator[None]:
    """Raise PluginError, ``effect 'x' failed in act(run 0): KeyError: 'k'``, for what somebody else's plugin raises.

    ``title`` and ``doing`` are the words before and after "failed in". What says already what is wrong with the input
    passes, and so does a lack of memory; and whatever a bundled one raises, which is a mistake of this program's and
    to be seen as it is. ``plugin`` is the class where there is no object yet.
    """
    try:
        yield
    except (InputError, PluginError, MemoryError):
        raise
    except Exception as error:
        if is_bundled((plugin if isinstance(plugin, type) else type(plugin)).__module__):
            raise
        first_line = (str(error).strip().splitlines() or [""])[0]
        what = f"{type(error).__name__}: {first_line}" if first_line else type(error).__name__
        raise PluginError(f"{title} failed in {doing}: {what}") from error
