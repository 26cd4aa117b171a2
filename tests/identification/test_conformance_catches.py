"""The conformance suite fails the identifiers it was made to fail, each for the right reason."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from numpy import random as global_stream

from vgvt.data import Campaign, ModalModel
from vgvt.identification import Needs
from vgvt.identification.conformance import Check, checks
from vgvt.identification.example import Example
from vgvt_identifiers.quadrature import Quadrature


@dataclass(frozen=True)
class _Plugin:
    """Everything a plugin declares; each bad one below spoils one thing of a good method."""

    name: ClassVar[str] = "bad"
    summary: ClassVar[str] = "A plugin with a fault"
    citation: ClassVar[str] = "@misc{bad, title = {A plugin with a fault}}"
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """What the good method says."""
        return Quadrature().identify(campaign, band_hz)


@dataclass(frozen=True)
class ReadsTheTruth(_Plugin):
    """Looks the answer up, importing the reader only when it works."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Loads what knows the truth."""
        import vgvt.files.truth  # noqa: F401

        return Quadrature().identify(campaign, band_hz)


@dataclass(frozen=True)
class FailsFirst(_Plugin):
    """Gives up before the import that would tell on it."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Fails, and would load what knows the truth."""
        if campaign.runs:
            raise ArithmeticError("not today")
        return ReadsTheTruth().identify(campaign, band_hz)


@dataclass(frozen=True)
class ChangesItsInput(_Plugin):
    """Removes the mean of the records in place."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Spoils the samples for whoever comes next."""
        for record in campaign.runs:
            record.samples[...] -= record.samples.mean(axis=1, keepdims=True)
        return Quadrature().identify(campaign, band_hz)


@dataclass(frozen=True)
class Rolls(_Plugin):
    """Adds a little luck, of a generator seeded by the clock."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Another answer every time."""
        model = Quadrature().identify(campaign, band_hz)
        luck = np.random.default_rng(time.time_ns()).normal(scale=1e-9, size=len(model))
        return replace(model, damping_ratio=model.damping_ratio + luck)


@dataclass(frozen=True)
class DrawsFromTheGlobalStream(_Plugin):
    """Draws from numpy's global random stream and throws the number away."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The right answer, but everybody's random numbers move on."""
        global_stream.normal()  # noqa: NPY002
        return Quadrature().identify(campaign, band_hz)


@dataclass(frozen=True)
class IgnoresSigns(_Plugin):
    """Takes the magnitude of the quadrature response as the shape."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Shapes without nodes."""
        model = Quadrature().identify(campaign, band_hz)
        return replace(model, shapes=np.abs(model.shapes).astype(complex))


@dataclass(frozen=True)
class RenamesSensors(_Plugin):
    """Gives every shape along +Z, whatever the sensor's direction was."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Forgets the minus."""
        model = Quadrature().identify(campaign, band_hz)
        return replace(model, dofs=tuple(d.unsigned for d in model.dofs))


@dataclass(frozen=True)
class TrustsTheOrder(_Plugin):
    """Takes the first run for the one with the best signal."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """A frequency that depends on what came first."""
        model = Quadrature().identify(campaign, band_hz)
        bias = 1e-5 * campaign.runs[0].run
        return replace(model, natural_frequency_hz=model.natural_frequency_hz * (1 + bias))


@dataclass(frozen=True)
class HasAnAbsoluteThreshold(_Plugin):
    """Calls everything under a fixed level noise."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """Loses a mode when the unit is larger."""
        model = Quadrature().identify(campaign, band_hz)
        loudest = max(float(np.nanmax(np.abs(r.samples))) for r in campaign.runs)
        return model.select([0, 1]) if loudest > 100 and len(model) > 2 else model


@dataclass(frozen=True)
class KeepsQuiet(_Plugin):
    """Drops what was remarked on the channels."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The right modes without the warnings."""
        return replace(Quadrature().identify(campaign, band_hz), advice=("all is well",))


@dataclass(frozen=True)
class SeesModesEverywhere(_Plugin):
    """Claims a mode in the middle of any band."""

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """One mode, always."""
        dofs = campaign.response_dofs
        return ModalModel(np.array([sum(band_hz) / 2]), np.array([0.01]), np.ones((1, len(dofs)), complex), dofs)


@dataclass
class IsNotFrozen:
    """A dataclass that can change under way."""

    name: ClassVar[str] = "loose"
    summary: ClassVar[str] = "Not frozen"
    citation: ClassVar[str] = "@misc{loose, title = {Loose}}"
    needs: ClassVar[Needs] = Needs.FRFS

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """What the good method says."""
        return Quadrature().identify(campaign, band_hz)


CAUGHT = [
    (ReadsTheTruth, "imports_nothing_that_knows_the_truth", "vgvt.files.truth"),
    (ChangesItsInput, "leaves_its_input_alone", "were changed"),
    (Rolls, "is_deterministic", "differ in damping_ratio"),
    (DrawsFromTheGlobalStream, "is_deterministic", "global random stream"),
    (IgnoresSigns, "finds_three_separated_modes", "MAC"),
    (RenamesSensors, "follows_the_sign_of_a_sensor", "3-Z"),
    (TrustsTheOrder, "ignores_the_order_of_the_runs", "frequencies move"),
    (HasAnAbsoluteThreshold, "ignores_the_gain_of_the_sensors", "3 modes become 2"),
    (KeepsQuiet, "survives_a_dead_channel", "does not name it"),
    (KeepsQuiet, "survives_a_channel_that_is_not_finite", "does not name it"),
    (SeesModesEverywhere, "survives_a_band_of_few_lines", "where there is no mode"),
    (SeesModesEverywhere, "claims_nothing_unflagged_from_noise", "pure noise"),
    (IsNotFrozen, "is_a_frozen_dataclass_that_says_what_it_is", "frozen"),
]


@pytest.mark.parametrize(("plugin", "check", "reason"), CAUGHT, ids=lambda v: getattr(v, "__name__", str(v)))
def test_a_bad_plugin_is_caught_for_the_right_reason(plugin: type, check: str, reason: str) -> None:
    by_name = {str(c): c for c in checks()}
    with pytest.raises(AssertionError, match=reason):
        by_name[check](plugin())


def test_signs_are_caught_by_the_sign_check_too() -> None:
    """|Im H| of a sensor turned over is read back with the wrong sign."""
    check = next(c for c in checks() if str(c) == "follows_the_sign_of_a_sensor")
    with pytest.raises(AssertionError, match="shapes change"):
        check(IgnoresSigns())


def test_a_plugin_that_imports_the_truth_at_once_is_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = Path(__file__).read_text(encoding="utf-8")
    (tmp_path / "greedy_plugin.py").write_text(source.replace("import sys\n", "import sys\nimport mujoco\n", 1))
    monkeypatch.syspath_prepend(tmp_path)
    import importlib

    greedy = importlib.import_module("greedy_plugin")
    try:
        check = next(c for c in checks() if str(c) == "imports_nothing_that_knows_the_truth")
        with pytest.raises(AssertionError, match="mujoco"):
            check(greedy._Plugin())
    finally:
        sys.modules.pop("greedy_plugin", None)


def test_a_plugin_that_fails_before_it_is_seen_whole_has_not_passed() -> None:
    """What it would have loaded after the failure nobody knows."""
    check = next(c for c in checks() if str(c) == "imports_nothing_that_knows_the_truth")
    with pytest.raises(RuntimeError, match=r"fails in a process of its own.*not today"):
        check(FailsFirst())


def test_checks_have_names_and_say_what_they_hold() -> None:
    names = [str(c) for c in checks()]
    assert len(set(names)) == len(names)
    assert all(isinstance(c, Check) and c.says.endswith(".") for c in checks())


def test_the_example_is_hard_enough_to_tell_signs_apart() -> None:
    """Every shape of the example changes sign, or a method without signs would pass."""
    shapes = Example().modes().shapes.real
    assert np.all((shapes.min(axis=1) < -0.2) & (shapes.max(axis=1) > 0.2))
