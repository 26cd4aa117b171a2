"""Do a campaign and a scenario speak of the same test? Said before anything is computed, with what to write."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, Direction, Dof, InputError, Quantity, Record
from vgvt.files.units import UNITS
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points
from vgvt.scenario.rig import UNRECORDED_NOTE
from vgvt.signals.impact import NOTE as IMPACTS_NOTE

Array = NDArray[np.float64]
FEWEST_LINES = 32
"""Lines of the band that a record must tell apart: twice as many as one local model of a channel's noise takes."""
# Further apart than this is another point, not a badly placed sensor.
_ANOTHER_POINT_M = 0.10
# Nearer than this may be one place, written in whole centimetres by one of the two.
_SAME_PLACE_M = 0.01
# A scenario's shaker stands below its point and pushes up.
_PUSHES = Direction.PLUS_Z
# So many points are told, and the others counted.
_TOLD = 4
_DRIVE_SD, _DRIVE_AT_LEAST_M = 5.0, 0.02
_MEASURES = {
    ChannelRole.RESPONSE: (Quantity.ACCELERATION,),
    ChannelRole.REFERENCE: (Quantity.EXCITATION_FORCE, Quantity.REACTION_FORCE),
}


def check_suitable(campaign: Campaign, scenario: Scenario) -> None:
    """InputError unless points, directions, drive point and kind of excitation of both are the same.

    And unless every run holds accelerations and a force, in SI, for long enough, and was driven.
    """
    check_excitation(scenario)
    _check_shaken(campaign)
    _check_beginning(campaign)
    _check_forces(campaign)
    check_quantities(campaign)
    _check_lengths(campaign)
    _check_points(campaign, scenario)
    _check_drive(campaign, scenario)


def remarks(campaign: Campaign, scenario: Scenario) -> tuple[str, ...]:
    """What is odd about a pair, and may be meant: another aircraft by name, as far as the records name one.

    And points that the two have at other places, if not so far apart that they are others.
    """
    return (*_other_aircraft(campaign, scenario), *_other_places(campaign, scenario))


def _other_aircraft(campaign: Campaign, scenario: Scenario) -> tuple[str, ...]:
    said, name = campaign.notes.get("aircraft", ""), scenario.airframe.name
    here, there = _words(name), _words(said)
    if here <= there or there <= here:
        return ()
    return (
        f"the records are of {said}, and scenario {scenario.name} is of {name}: all that differs between the two will "
        "be taken for something that is missing",
    )


def _other_places(campaign: Campaign, scenario: Scenario) -> tuple[str, ...]:
    """The points that a campaign has elsewhere than its scenario: which of the two is wrong only a tape can say."""
    apart = [
        f"{node} at ({_written(there)}), not ({_written(here)}) m"
        for node, there, here, away in _places_apart(campaign, scenario)
        if away > _SAME_PLACE_M
    ]
    if not apart:
        return ()
    more = f" and {len(apart) - _TOLD} more" if len(apart) > _TOLD else ""
    return (
        f"{campaign.name} has node {'; node '.join(apart[:_TOLD])}{more}, as scenario {scenario.name} has: the "
        "scenario's places are taken, and what that misses will be taken for something that is missing",
    )


def _places_apart(campaign: Campaign, scenario: Scenario) -> list[tuple[int, Array, Array, float]]:
    """Each point that both know: its node, where campaign and scenario have it, (2,) or (3,), and how far apart.

    All in metres. Height counts where a sensor measures across the vertical, as rotations move nothing up or down by
    it, and where records state any: many geometries, and a sidecar without z, have none.
    """
    geometry = campaign.geometry
    across = {d.node for d in campaign.response_dofs if d.unsigned.direction is not Direction.PLUS_Z}
    tall = bool(np.any(geometry.positions_m[:, 2:]))
    places = {p.dof.node: np.array(p.position_m) for p in sensor_points(scenario)}
    found = []
    for node in dict.fromkeys(d.node for d in campaign.response_dofs):
        if node in geometry.nodes and node in places:
            counted = 3 if tall and node in across else 2
            there, here = geometry.position_m(node)[:counted], places[node][:counted]
            found.append((node, there, here, float(np.linalg.norm(there - here))))
    return found


def _written(place_m: Array) -> str:
    return ", ".join(f"{c:.3f}" for c in place_m)


def _words(text: str) -> set[str]:
    return set(re.findall(r"\w+", text.casefold()))


def banded(campaign: Campaign, band_hz: tuple[float, float] | None) -> Campaign:
    """The campaign with another band to judge by; InputError for one that it was not excited in."""
    from dataclasses import replace

    if band_hz is None:
        return campaign
    return replace(campaign, band_hz=within_excited(band_hz, campaign.band_hz, campaign.name))


def within_excited(band_hz: tuple[float, float], excited_hz: tuple[float, float], name: str) -> tuple[float, float]:
    """A band cut to the one that ``name`` excites; InputError for no band, and where they share nothing."""
    low, high = band_hz
    if not 0 <= low < high:
        raise InputError("--band", f"{low:g} {high:g} is not a band", "write LOW and HIGH in Hz")
    if high <= excited_hz[0] or low >= excited_hz[1]:
        raise InputError(
            "--band",
            f"{low:g} to {high:g} Hz lies outside the {excited_hz[0]:g} to {excited_hz[1]:g} Hz that {name} excites",
            f"write a band within {excited_hz[0]:g} and {excited_hz[1]:g}",
        )
    return max(low, excited_hz[0]), min(high, excited_hz[1])


def check_excitation(scenario: Scenario) -> None:
    """InputError for a scenario of a hammer or several shakers, and for records that begin while something rings."""
    late_s = scenario.excitation.before_record_s
    if late_s > 0:
        raise _begun_late(f"scenario {scenario.name}: excitation.unrecorded_s", f"is {late_s:g}")
    if scenario.further_shaker or scenario.excitation.kind == "impact":
        raise InputError(
            f"scenario {scenario.name}",
            "has several shakers or a hammer, and reconcile takes one shaker at a fixed point",
            "write a scenario with a single [shaker], and give the runs that it drove",
        )


def _check_shaken(campaign: Campaign) -> None:
    """InputError for a campaign whose notes say that a hammer struck."""
    excitation = campaign.notes.get("excitation", "")
    said = excitation.strip().casefold()
    # A sidecar's note is in its author's words: "impact, …" as a simulation says, or "modal hammer, …".
    struck = said.startswith("impact") or ("hammer" in said and "shaker" not in said)
    if IMPACTS_NOTE not in campaign.notes and not struck:
        return
    note = "excitation" if excitation else IMPACTS_NOTE
    raise InputError(
        f"{campaign.name}, note {note!r}",
        f"says that a hammer struck: {campaign.notes[note]}; reconcile takes one shaker at a fixed point",
        "give the runs that a shaker drove, or mend the note if it is wrong",
    )


def _check_beginning(campaign: Campaign) -> None:
    late_s = campaign.notes.get(UNRECORDED_NOTE)
    if late_s is not None:
        raise _begun_late(campaign.name, f"was recorded from {late_s} s after the shaker's start")


def _begun_late(where: str, what: str) -> InputError:
    return InputError(
        where,
        f"{what}: what rings when a record begins was set ringing by a force that it does not hold, and reconcile "
        "predicts records that begin at rest",
        "reconcile records that were started before the shaker, from a scenario without unrecorded_s",
    )


def _check_forces(campaign: Campaign) -> None:
    references = set(campaign.reference_dofs)
    if not references:
        raise InputError(
            campaign.name,
            "has no force channel",
            "give a campaign with measured forces, or mark the force as reference",
        )
    for record in campaign.runs:
        if all(channel.role is not ChannelRole.REFERENCE for channel in record.channels):
            raise InputError(
                f"{campaign.name}, run {record.run}",
                "has no force channel",
                "mark its force as reference, or leave this run out",
            )
        _check_driven(campaign, record)
    if not campaign.response_dofs:
        raise InputError(campaign.name, "has no response channel", "give a campaign with measured accelerations")
    # The sign may differ: that is a gauge read the other way round, not another drive point.
    if len({d.unsigned for d in references}) > 1:
        raise InputError(
            campaign.name,
            f"was driven at {len(references)} points: {_listed(references)}",
            "reconcile the runs of each drive point on their own, with a scenario for each",
        )


def _check_driven(campaign: Campaign, record: Record) -> None:
    for channel, samples in zip(record.channels, record.samples, strict=True):
        if channel.role is ChannelRole.REFERENCE and float(np.ptp(samples)) == 0:
            raise InputError(
                f"{campaign.name}, run {record.run}, channel {channel.name}",
                f"is {float(samples[0]):g} N throughout: a run that nothing drove has no A/F",
                "repair the record, or leave this run out",
            )


def check_quantities(campaign: Campaign) -> None:
    """InputError unless every response is an acceleration and every reference a force, in SI: A/F is what is compared.

    A velocity would be taken for an acceleration that is off by the frequency, a g for a gain of ten.
    """
    for record in campaign.runs:
        for channel in record.channels:
            wanted = _MEASURES.get(channel.role)
            if wanted is None:
                continue
            where = f"{campaign.name}, run {record.run}, channel {channel.name}"
            name = wanted[0].name.lower().replace("_", " ")
            if channel.quantity not in wanted:
                raise InputError(
                    where,
                    f"measures {channel.quantity.name.lower().replace('_', ' ')}, and as a {channel.role.value} "
                    f"reconcile takes {name} alone",
                    f"bring its samples to {wanted[0].si_unit}, or take the channel out of the campaign; a quantity "
                    "that is stated wrongly is mended in the sidecar",
                )
            scale = UNITS.get(channel.quantity, {}).get(channel.unit)
            if channel.unit != channel.quantity.si_unit and scale != 1:
                how = "bring its samples" if scale is None else f"multiply its samples by {scale:.7g} to bring them"
                raise InputError(
                    where,
                    f"is in {channel.unit}, and {name} is taken in {channel.quantity.si_unit}",
                    f"{how} to {channel.quantity.si_unit}, and state that as its unit",
                )


def _check_lengths(campaign: Campaign) -> None:
    low, high = campaign.band_hz
    for record in campaign.runs:
        seconds = record.samples.shape[1] / record.sample_rate_hz
        own = int((high - low) * seconds)
        if own < FEWEST_LINES:
            raise InputError(
                f"{campaign.name}, run {record.run}",
                f"is {seconds:.3g} s long, which tells {own} lines from {low:g} to {high:g} Hz apart, and "
                f"{FEWEST_LINES} are needed",
                "give the whole record, widen --band, or leave this run out",
            )


def _check_points(campaign: Campaign, scenario: Scenario) -> None:
    grid = scenario.accelerometers.grid
    nodes = set(grid.node)
    measured = campaign.response_dofs
    shared = [d for d in measured if d.node in nodes]
    where = f"scenario {scenario.name}: accelerometers.grid"
    if not shared:
        raise InputError(
            where,
            f"shares no response point with {campaign.name}: that measured {_listed(measured)}, this has nodes "
            f"{', '.join(map(str, grid.node[:8]))}{', …' if len(grid.node) > 8 else ''}",
            "write the campaign's nodes into node, with their places in x_m and y_m",
        )
    missing = [d for d in measured if d.node not in nodes]
    if missing:
        raise InputError(
            where,
            f"has no node {', '.join(str(d.node) for d in missing[:8])}, which {campaign.name} measured",
            "give the scenario a point for every channel of the campaign",
        )
    stated = dict(zip(grid.node, grid.direction or ("+Z",) * len(grid.node), strict=True))
    for d in measured:
        direction = stated[d.node].upper()
        # The sign may differ: that is a channel read the other way round, not another motion.
        if str(d)[-1] != direction[-1]:
            raise InputError(
                where,
                f"measures node {d.node} along {direction}, but the campaign measured {d}",
                f"write the campaign's direction for node {d.node} in direction",
            )
    _check_places(campaign, scenario)


def _check_places(campaign: Campaign, scenario: Scenario) -> None:
    for node, there, here, away in _places_apart(campaign, scenario):
        if away > _ANOTHER_POINT_M:
            put = ", ".join(f"{name} = {c:.3f}" for name, c in zip("xyz", here, strict=False))
            raise InputError(
                f"scenario {scenario.name}: accelerometers.grid",
                f"puts node {node} at {put} m, {away:.2f} m from where {campaign.name} has it ({_written(there)})",
                f"write the same places, in metres aft of the nose{', ' if here.size == 3 else ' and '}to the right"
                f"{' and up' if here.size == 3 else ''}",
            )


def _check_drive(campaign: Campaign, scenario: Scenario) -> None:
    drive = campaign.reference_dofs[0]
    if drive.unsigned.direction is not _PUSHES:
        raise InputError(
            f"{campaign.name}, force at {drive}",
            f"was measured along {drive.direction.label}, and the shaker of scenario {scenario.name} pushes along "
            f"{_PUSHES.label}",
            f"reconcile runs that were driven along z; a direction that is stated wrongly is mended in the sidecar: "
            f"{drive.node}+Z, or {drive.node}-Z for a gauge that reads the other way round",
        )
    if drive.node not in campaign.geometry.nodes:
        return
    there, here = campaign.geometry.position_m(drive.node), np.array(scenario.shaker.position_m)
    # It pushes up: how high its point is turns nothing.
    away = float(np.hypot(*(there - here)[:2]))
    if away > max(_DRIVE_AT_LEAST_M, _DRIVE_SD * scenario.tolerances.drive_point_m):
        x, y, z = (float(v) for v in there)
        raise InputError(
            f"scenario {scenario.name}: shaker.position_m",
            f"is {away:.3f} m from the drive point of {campaign.name}",
            f"write position_m = [{x:.4g}, {y:.4g}, {z:.4g}], or a larger tolerances.drive_point_m if it is uncertain",
        )


def _listed(dofs: set[Dof] | tuple[Dof, ...]) -> str:
    names = [str(d) for d in dofs]
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
