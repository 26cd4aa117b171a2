"""The unit that a file states of a channel, held against the sidecar's."""

from __future__ import annotations

from vgvt.data import InputError, Quantity
from vgvt.files.sidecar import ChannelRow
from vgvt.files.unit_labels import same_unit, unit_of_label
from vgvt.files.units import unit_in_si


def check_unit_label(channel: ChannelRow, label: str, where: str) -> bool:
    """True where a label means a unit, which is then the sidecar's; InputError where it is another one."""
    labelled = unit_of_label(label)
    if labelled is None:
        return False
    kind, unit = labelled
    volts = channel.unit is None or channel.kind is Quantity.GENERAL
    right = kind is (Quantity.GENERAL if volts else channel.kind)
    if right and same_unit(unit_in_si(kind, unit), channel.v_per_sample if volts else channel.si_per_sample):
        return True
    raise InputError(
        where,
        f"the file says that its unit is {label!r}, the sidecar says {unit_in_words(channel)}",
        f"correct the unit, or give the sensitivity where the file holds volts; {override('unit')}",
    )


def unit_in_words(channel: ChannelRow) -> str:
    """What the sidecar says of a channel's samples."""
    return "volts (sensitivity)" if channel.unit is None else channel.unit


def override(what: str) -> str:
    """How to believe the sidecar of a channel against its file."""
    return f'where the file is wrong, write overrides = ["{what}"] in this channel'
