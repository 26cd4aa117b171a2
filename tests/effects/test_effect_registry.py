"""Finding effects: a bundled name is not to be taken, and one that is no effect is left out under its own name."""

from __future__ import annotations

import warnings

import pytest

from vgvt.data import InputError, PluginError
from vgvt.effects import available_effects, make_effect
from vgvt.effects.acting import acted, action_of
from vgvt.effects.conformance import with_effect
from vgvt.effects.registry import EffectPluginWarning
from vgvt.scenario import load_scenario
from vgvt.simulation.assembly import plans

SOURCE = """
from dataclasses import dataclass
from typing import ClassVar

from vgvt.effects import Action, Family, parameter


@dataclass(frozen=True)
class Added:
    name: ClassVar[str] = "added"
    summary: ClassVar[str] = "Somebody's own"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "none"
    confused_with: ClassVar[tuple[str, ...]] = ()
    separating_test: ClassVar[str] = "none"
    reference: ClassVar[str] = "none"
    size_kg: float = parameter("kg", 0.1, 1.0, "size", neutral=0.0)

    def act(self, scenario, run):
        return Action()
"""
ACT = "        return Action()\n"


def spoiled(old: str, new: str) -> str:
    """The source with one thing changed."""
    assert SOURCE.count(old) == 1, old
    return SOURCE.replace(old, new)


@pytest.fixture
def added(install):
    """Installs the effect, with one thing changed, in package ``mike``."""
    return lambda *change: install("mike", spoiled(*change) if change else SOURCE, "vgvt.effects", {"added": "Added"})


def test_one_that_is_as_it_should_be_is_found_without_a_word(added) -> None:
    added()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = available_effects()
    assert found["added"].__module__ == "mike"
    assert list(found) == sorted(found)


@pytest.mark.parametrize("package", ["aaa", "zzz"])
def test_a_bundled_name_is_not_to_be_taken(install, package: str) -> None:
    """Whether its module comes before or behind the bundled one in the alphabet."""
    install(package, spoiled('"added"', '"channel-gain"'), "vgvt.effects", {"channel-gain": "Added"})
    told = rf"'channel-gain': that of vgvt is used, that of {package} \({package}:Added\) is left out"
    with pytest.warns(EffectPluginWarning, match=told):
        assert available_effects()["channel-gain"].__module__ == "vgvt.effects.channel_gain"


def test_of_two_packages_with_one_name_the_first_counts_and_both_are_named(install) -> None:
    for package in ("zulu", "mike"):
        install(package, SOURCE, "vgvt.effects", {"added": "Added"})
    told = r"'added': that of mike is used, that of zulu \(zulu:Added\) is left out"
    with pytest.warns(EffectPluginWarning, match=told):
        assert available_effects()["added"].__module__ == "mike"


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (("import dataclass\n", "import dataclass\nimport no_such_package\n"), "No module named 'no_such_package'"),
        (("@dataclass(frozen=True)\n", ""), r"it is not a dataclass with a method act\(scenario, run\)"),
        (("def act(", "def do("), r"it is not a dataclass with a method act\(scenario, run\)"),
        (('"added"', '"other"'), "the class calls itself 'other'"),
        (("    summary:", "    motto:"), "class attribute 'summary' is missing, or no str"),
        (("Family.ACQUISITION", "'acquisition'"), "class attribute 'family' is missing, or no Family"),
        (("    linear: ClassVar[bool] = True\n", ""), "class attribute 'linear' is missing, or no bool"),
        (("    signature:", "    mark:"), "class attribute 'signature' is missing, or no str"),
        (("tuple[str, ...]] = ()", "str] = 'hum'"), "class attribute 'confused_with' is missing, or no tuple"),
        (("    separating_test:", "    test:"), "class attribute 'separating_test' is missing, or no str"),
        (("    reference:", "    book:"), "class attribute 'reference' is missing, or no str"),
        (("size_kg: float =", "size_kg: float\n    other: float ="), "its field 'size_kg' has no default"),
        (("size_kg: float", "size_kg: 'Flaot'"), "NameError: name 'Flaot' is not defined"),
    ],
)
def test_one_that_is_no_effect_is_left_out_with_its_name(added, change: tuple[str, str], why: str) -> None:
    added(*change)
    with pytest.warns(EffectPluginWarning, match=rf"'added' \(mike:Added\) is left out: .*{why}"):
        found = available_effects()
    assert "added" not in found and "channel-gain" in found


@pytest.mark.parametrize(
    ("act", "why"),
    [
        ("return {}['k']", "KeyError: 'k'"),
        ("return None", "TypeError: it gave NoneType, not an Action"),
        ("raise ValueError('shapes do not fit')", "ValueError: shapes do not fit"),
        ("raise RuntimeError", "RuntimeError$"),
    ],
)
def test_what_fails_in_one_is_said_to_be_its_fault(added, act: str, why: str) -> None:
    added(ACT, f"        {act}\n")
    effect = make_effect("added", "test", size_kg=0.5)
    with pytest.raises(PluginError, match=rf"^effect 'added' failed in act\(run 1\): {why}"):
        action_of(effect, load_scenario("quick"), 1)
    with pytest.raises(PluginError, match="effect 'added' failed"):
        acted((effect,), load_scenario("quick"), 0)
    with pytest.raises(PluginError, match="effect 'added' failed"):
        plans(with_effect(load_scenario("quick"), effect))


def test_what_one_says_of_the_input_is_no_fault_of_its_own(added) -> None:
    added(ACT, "        from vgvt.data import InputError\n        raise InputError('effect added', 'no such sensor')\n")
    with pytest.raises(InputError, match="no such sensor"):
        action_of(make_effect("added", "test"), load_scenario("quick"), 0)


def test_a_fault_of_a_bundled_effect_is_seen_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    effect = make_effect("channel-gain", "test", gain_error=0.1)
    monkeypatch.setattr(type(effect), "act", lambda *_: {}["k"])
    with pytest.raises(KeyError, match="k"):
        action_of(effect, load_scenario("quick"), 0)
    monkeypatch.setattr(type(effect), "act", lambda *_: None)
    with pytest.raises(TypeError, match="gave NoneType"):
        action_of(effect, load_scenario("quick"), 0)


def test_names_of_packages_are_read_only_where_two_have_one_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are in files, and a fit asks for the known effects at every structure."""
    before = available_effects()
    monkeypatch.setattr("vgvt.data.plugin.package_of", lambda point: pytest.fail(f"asked for the package of {point}"))
    assert available_effects() == before
