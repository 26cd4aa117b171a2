"""Finding identifiers: a broken plugin warns with its name, a wrong name or setting says what was meant."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from typing import ClassVar, Literal

import pytest

from vgvt.data import InputError
from vgvt.identification import (
    Needs,
    PluginWarning,
    Requirement,
    absent_identifiers,
    available_identifiers,
    make_identifier,
    settings_of,
)
from vgvt.identification import registry as registry_module


@dataclass(frozen=True)
class Sample:
    """An identifier with one setting of every kind."""

    name: ClassVar[str] = "sample"
    summary: ClassVar[str] = "for tests"
    citation: ClassVar[str] = "@misc{sample, title = {Sample}}"
    needs: ClassVar[Needs] = Needs.FRFS
    order: int = 4
    width_hz: float | None = None
    weighted: bool = True
    kind: Literal["real", "complex"] = "real"

    def __post_init__(self) -> None:
        if self.order < 1:
            raise ValueError("order must be at least 1")

    def identify(self, campaign: object, band_hz: tuple[float, float]) -> None:
        """Never called here."""


@dataclass(frozen=True)
class Adapter:
    name: ClassVar[str] = "adapter"
    summary: ClassVar[str] = "for tests"
    citation: ClassVar[str] = "@misc{adapter, title = {Adapter}}"
    needs: ClassVar[Needs] = Needs.FRFS
    requires: ClassVar[tuple[Requirement, ...]] = (
        Requirement("dataclasses", "python"),
        Requirement("no_such_package.part", "somewhere[else]"),
    )

    def identify(self, campaign: object, band_hz: tuple[float, float]) -> None:
        """Never called here."""


@pytest.fixture
def plugins(monkeypatch: pytest.MonkeyPatch) -> list[EntryPoint]:
    """The entry points that the registry sees; a test appends to them."""
    points = [EntryPoint("sample", f"{__name__}:Sample", registry_module.GROUP)]
    monkeypatch.setattr(registry_module, "entry_points", lambda group: list(points))
    monkeypatch.setattr(EntryPoint, "load", _load)
    return points


def _load(point: EntryPoint) -> object:
    """The test module has no importable name, so its class is handed out directly."""
    if point.value.endswith(":Sample"):
        return Sample
    if point.value.endswith(":Adapter"):
        return Adapter
    if point.value.endswith(":number"):
        return 7
    raise ImportError(f"No module named {point.value.partition(':')[0]!r}")


def test_the_bundled_method_is_found() -> None:
    assert "quadrature" in available_identifiers()


def test_a_plugin_that_cannot_be_imported_warns_with_its_name_and_leaves_the_others(plugins: list[EntryPoint]) -> None:
    plugins.append(EntryPoint("broken", "no_such_package:Thing", registry_module.GROUP))
    with pytest.warns(PluginWarning, match=r"'broken' \(no_such_package:Thing\).*No module named"):
        found = available_identifiers()
    assert found == {"sample": Sample}


def test_a_plugin_that_is_no_identifier_is_left_out(plugins: list[EntryPoint]) -> None:
    plugins.append(EntryPoint("number", "somewhere:number", registry_module.GROUP))
    with pytest.warns(PluginWarning, match="'number'.*not a dataclass with a method identify"):
        assert list(available_identifiers()) == ["sample"]


def test_the_same_plugin_listed_twice_is_no_quarrel(plugins: list[EntryPoint]) -> None:
    plugins.append(plugins[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert available_identifiers() == {"sample": Sample}


PLUGIN = """
from dataclasses import dataclass
from typing import ClassVar
from vgvt.identification import Needs

@dataclass(frozen=True)
class Method:
    name: ClassVar[str] = "{name}"
    summary: ClassVar[str] = "another one"
    citation: ClassVar[str] = "@misc{{none, title = {{None}}}}"
    needs: ClassVar[Needs] = Needs.FRFS

    def identify(self, campaign, band_hz):
        raise KeyError("k")
"""


def test_a_bundled_name_is_not_to_be_taken(install) -> None:
    """By a package whose module comes before that of the bundled ones in the alphabet, too."""
    install("aaa", PLUGIN.format(name="quadrature"), "vgvt.identifiers", {"quadrature": "Method"})
    told = r"'quadrature': that of vgvt is used, that of aaa \(aaa:Method\) is left out"
    with pytest.warns(PluginWarning, match=told):
        assert available_identifiers()["quadrature"].__module__ == "vgvt_identifiers.quadrature"
    with pytest.warns(PluginWarning, match=told):
        assert type(make_identifier("quadrature")).__module__ == "vgvt_identifiers.quadrature"


def test_of_two_packages_with_one_name_the_first_counts_and_both_are_named(install) -> None:
    for package in ("zulu", "mike"):
        install(package, PLUGIN.format(name="peaks"), "vgvt.identifiers", {"peaks": "Method"})
    told = r"'peaks': that of mike is used, that of zulu \(zulu:Method\) is left out"
    with pytest.warns(PluginWarning, match=told):
        assert available_identifiers()["peaks"].__module__ == "mike"
    with pytest.warns(PluginWarning, match=told):
        assert type(make_identifier("peaks")).__module__ == "mike"


@pytest.mark.parametrize(
    ("spoiled", "why"),
    [
        (("summary: ClassVar[str]", "motto: ClassVar[str]"), "class attribute 'summary' is missing, or no str"),
        (("needs: ClassVar[Needs] = Needs.FRFS", "needs: ClassVar[str] = 'force'"), "'needs' is missing, or no Needs"),
        (('"peaks"', '"troughs"'), "the class calls itself 'troughs'"),
    ],
)
def test_one_that_does_not_say_what_it_is_is_left_out(install, spoiled: tuple[str, str], why: str) -> None:
    install("mike", PLUGIN.format(name="peaks").replace(*spoiled), "vgvt.identifiers", {"peaks": "Method"})
    with pytest.warns(PluginWarning, match=rf"'peaks' \(mike:Method\) is left out: .*{why}"):
        found = available_identifiers()
    assert "peaks" not in found and "quadrature" in found


def test_an_unknown_name_is_answered_with_the_nearest(plugins: list[EntryPoint]) -> None:
    with pytest.raises(InputError, match="did you mean 'sample'"):
        make_identifier("sampel")


def test_an_unknown_setting_is_answered_with_the_nearest(plugins: list[EntryPoint]) -> None:
    with pytest.raises(InputError, match=r"no setting 'ordre'.*\n.*did you mean 'order'"):
        make_identifier("sample", ordre=3)


def test_settings_given_as_text_become_the_type_of_their_field(plugins: list[EntryPoint]) -> None:
    made = make_identifier("sample", order="6", width_hz="0.5", weighted="false", kind="complex")
    assert made == Sample(order=6, width_hz=0.5, weighted=False, kind="complex")
    assert make_identifier("sample", width_hz="none") == Sample()


@pytest.mark.parametrize(
    "setting", [{"order": "four"}, {"order": 2.5}, {"kind": "imaginary"}, {"weighted": "maybe"}, {"order": 0}]
)
def test_a_value_that_does_not_fit_is_bad_input(plugins: list[EntryPoint], setting: dict[str, object]) -> None:
    with pytest.raises(InputError, match=next(iter(setting))):
        make_identifier("sample", **setting)


def test_one_that_lacks_a_library_is_left_out_without_a_warning(plugins: list[EntryPoint]) -> None:
    plugins.append(EntryPoint("adapter", f"{__name__}:Adapter", registry_module.GROUP))
    assert list(available_identifiers()) == ["sample"]
    assert absent_identifiers() == {"adapter": "pip install 'somewhere[else]'"}
    with pytest.raises(InputError, match=r"needs no_such_package\.part, which is not installed"):
        make_identifier("adapter")


def test_settings_are_listed_with_type_and_default(plugins: list[EntryPoint]) -> None:
    listed = {s.name: (s.type, s.default) for s in settings_of(Sample)}
    assert listed == {
        "order": ("int", "4"),
        "width_hz": ("float | none", "None"),
        "weighted": ("bool", "True"),
        "kind": ("real | complex", "real"),
    }


def test_every_setting_of_a_bundled_identifier_is_explained() -> None:
    for name, cls in available_identifiers().items():
        bare = [s.name for s in settings_of(cls) if cls.__module__.startswith("vgvt_identifiers") and not s.doc]
        assert not bare, f"{name}: settings without metadata doc: {bare}"
