"""Runs one identifier on one campaign and holds it to its contract."""

from __future__ import annotations

import dataclasses
from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, ChannelRole, InputError, ModalModel, Outcome, PluginError
from vgvt.data.plugin import whose_fault
from vgvt.identification.incomplete_shapes import unknown_parts
from vgvt.identification.protocol import Identifier, Needs
from vgvt.identification.requirement import install_advice, missing_requirements


class ContractError(PluginError):
    """An identifier returned a claim that breaks the contract: a mistake in the plugin, not in the input."""


def run_identifier(
    identifier: Identifier, campaign: Campaign, band_hz: tuple[float, float] | None = None
) -> ModalModel:
    """The identifier's claim on a campaign, stamped with the method's name, its settings and whether it uses the force.

    ``band_hz`` defaults to the excited band of the campaign. A method that
    needs a force is declined here when a run has none, and one that lacks a library. Raises InputError for a
    band that the records cannot hold, ContractError for a claim with modes
    outside the band, non-finite values or an empty claim without a reason, PluginError,
    which names the identifier, for whatever else one that is not bundled raises.
    """
    band = campaign.band_hz if band_hz is None else (float(band_hz[0]), float(band_hz[1]))
    _check_band(campaign, band)
    missing, lacking = _runs_without_force(campaign), missing_requirements(identifier)
    if lacking:
        advice = f"{identifier.name} needs {', '.join(r.module for r in lacking)}: {install_advice(lacking)}"
        model = ModalModel.empty(Outcome.DECLINED, (advice,))
    elif Needs.FORCE_REFERENCE in identifier.needs and missing:
        advice = f"{identifier.name} needs a force channel in every run; missing in run {', '.join(map(str, missing))}"
        model = ModalModel.empty(Outcome.DECLINED, (advice,))
    else:
        with whose_fault(identifier, f"identifier {identifier.name!r}", "identify"):
            model = identifier.identify(campaign, band)
    _check_claim(identifier.name, model, band)
    advice_band = _outside_excitation(campaign, band)
    return replace(
        model,
        method=identifier.name,
        settings=settings_text(identifier),
        advice=(*model.advice, *unknown_parts(model), *(() if advice_band is None else (advice_band,))),
        output_only=Needs.OUTPUT_ONLY in identifier.needs,
    )


def settings_text(identifier: object) -> dict[str, str]:
    """The settings of an identifier as text, by field name; TypeError for one that is not a dataclass."""
    if not dataclasses.is_dataclass(identifier) or isinstance(identifier, type):
        raise TypeError(f"{type(identifier).__name__} is not a dataclass; an identifier's fields are its settings")
    return {f.name: str(getattr(identifier, f.name)) for f in dataclasses.fields(identifier)}


def _check_band(campaign: Campaign, band: tuple[float, float]) -> None:
    low, high = band
    where = f"campaign {campaign.name!r}"
    excited = f"the excited band is {campaign.band_hz[0]:g} to {campaign.band_hz[1]:g} Hz"
    if not (np.isfinite(low) and np.isfinite(high) and 0 <= low < high):
        raise InputError(where, f"band {low:g} to {high:g} Hz is not 0 <= low < high", excited)
    nyquist = min(record.sample_rate_hz for record in campaign.runs) / 2
    if high > nyquist:
        raise InputError(where, f"band ends at {high:g} Hz, above half the sample rate, {nyquist:g} Hz", excited)
    if low >= campaign.band_hz[1] or high <= campaign.band_hz[0]:
        raise InputError(where, f"band {low:g} to {high:g} Hz lies outside the excitation", excited)


def _outside_excitation(campaign: Campaign, band: tuple[float, float]) -> str | None:
    low, high = campaign.band_hz
    if band[0] >= low and band[1] <= high:
        return None
    return (
        f"the band asked for reaches beyond the excited one, {low:g} to {high:g} Hz; modes outside it are weak claims"
    )


def _runs_without_force(campaign: Campaign) -> list[int]:
    return [r.run for r in campaign.runs if not any(c.role is ChannelRole.REFERENCE for c in r.channels)]


def _check_claim(name: str, model: object, band: tuple[float, float]) -> None:
    if not isinstance(model, ModalModel):
        raise ContractError(f"identifier {name!r} returned {type(model).__name__}, not a ModalModel")
    if len(model) == 0:
        if model.outcome is Outcome.FOUND or not model.advice:
            raise ContractError(f"identifier {name!r} claims no mode without saying why (outcome and advice)")
        return
    frequency, damping = model.natural_frequency_hz, model.damping_ratio
    if not (np.isfinite(frequency).all() and np.isfinite(damping).all() and np.isfinite(model.shapes).all()):
        raise ContractError(f"identifier {name!r} claims a mode with a frequency, damping or shape that is not finite")
    if (np.abs(damping) >= 1).any():
        raise ContractError(f"identifier {name!r} claims a mode with a damping ratio of 1 or more: it does not swing")
    if any((std < 0).any() for std in (model.natural_frequency_std_hz, model.damping_ratio_std) if std is not None):
        raise ContractError(f"identifier {name!r} states a standard deviation below zero")
    if frequency[0] < band[0] or frequency[-1] > band[1]:
        raise ContractError(f"identifier {name!r} claims modes outside the band {band[0]:g} to {band[1]:g} Hz")
