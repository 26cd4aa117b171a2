"""Campaigns and frequency responses as Universal Files: header, units, places, then a dataset 58 a function."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from vgvt._version import __version__
from vgvt.data import Campaign, Channel, Dof, FrequencyResponseSet, Geometry, Quantity, Record
from vgvt.files.uff.write import Axis, Function, function_58, header_151, lines_82, nodes_15, units_164_si

_TIME = Axis(17, "Time", "s")
_FREQUENCY = Axis(18, "Frequency", "Hz")
_NO_QUANTITY = Axis(1, "Coherence", "NONE")
_TIME_RESPONSE, _FREQUENCY_RESPONSE, _COHERENCE, _MULTIPLE_COHERENCE = 1, 4, 6, 26
_EVEN = 1e-6  # of the spacing of lines


def campaign_datasets(campaign: Campaign, text: bool) -> Iterator[bytes]:
    """Everything of a campaign that a Universal File can state, run after run; numbers as text or binary."""
    yield from _places(campaign.name, campaign.geometry)
    number = 0
    for record in campaign.runs:
        for channel, samples in zip(record.channels, record.samples, strict=True):
            number += 1
            yield function_58(_time_history(campaign, record, channel, samples), number, text)


def response_datasets(frf: FrequencyResponseSet, name: str, geometry: Geometry, text: bool) -> Iterator[bytes]:
    """Frequency responses, and coherence where it is known: ordinary, or multiple with several references."""
    yield from _places(name, geometry)
    functions = [*_responses(frf, name), *_coherences(frf, name)]
    for number, function in enumerate(functions, start=1):
        yield function_58(function, number, text)


def _places(name: str, geometry: Geometry) -> Iterator[bytes]:
    # Readers are known that fail where a binary function comes first.
    yield header_151(name, f"vgvt {__version__}")
    yield units_164_si()
    yield nodes_15(geometry)
    yield lines_82(geometry)


def _time_history(campaign: Campaign, record: Record, channel: Channel, samples: NDArray[np.floating]) -> Function:
    return Function(
        kind=_TIME_RESPONSE,
        identification=(channel.name, campaign.name, "", f"run {record.run}"),
        values=samples if samples.dtype == np.float32 else samples.astype(np.float64, copy=False),
        start=0.0,
        increment=1 / record.sample_rate_hz,
        response=channel.dof,
        reference=None,
        axis=_TIME,
        ordinate=_quantity(channel.quantity),
    )


def _quantity(quantity: Quantity) -> Axis:
    return Axis(int(quantity), quantity.name.replace("_", " ").capitalize(), quantity.si_unit or "NONE")


def _responses(frf: FrequencyResponseSet, name: str) -> Iterator[Function]:
    for response, row in zip(frf.responses, frf.values, strict=True):
        for reference, values in zip(frf.references, row, strict=True):
            yield _over_frequency(
                frf,
                _FREQUENCY_RESPONSE,
                (f"H {response}/{reference}", name),
                values,
                (response, reference),
                (_quantity(frf.quantity), _quantity(Quantity.EXCITATION_FORCE)),
            )


def _coherences(frf: FrequencyResponseSet, name: str) -> Iterator[Function]:
    if frf.coherence is None:
        return
    alone = len(frf.references) == 1
    kind = _COHERENCE if alone else _MULTIPLE_COHERENCE
    for response, row in zip(frf.responses, frf.coherence, strict=True):
        reference = frf.references[0] if alone else None
        # With all references together it is one and the same in every column.
        spoken = f"coherence {response}/{reference}" if alone else f"multiple coherence {response}"
        yield _over_frequency(frf, kind, (spoken, name), row[0], (response, reference), (_NO_QUANTITY, Axis()))


def _over_frequency(
    frf: FrequencyResponseSet,
    kind: int,
    identification: tuple[str, ...],
    values: NDArray[np.floating] | NDArray[np.complexfloating],
    dofs: tuple[Dof, Dof | None],
    axes: tuple[Axis, Axis],
) -> Function:
    lines = frf.frequency_hz
    steps = np.diff(lines)
    even = bool(steps.size) and float(np.ptp(steps)) <= _EVEN * float(steps[0])
    return Function(
        kind=kind,
        identification=identification,
        values=values,
        start=float(lines[0]) if lines.size else 0.0,
        increment=float(np.mean(steps)) if steps.size else 0.0,
        response=dofs[0],
        reference=dofs[1],
        axis=_FREQUENCY,
        ordinate=axes[0],
        denominator=axes[1],
        abscissa=None if even else lines,
    )
