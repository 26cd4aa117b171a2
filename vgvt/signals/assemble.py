"""From the estimates of single responses to one labelled set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, FrequencyResponseSet, InputError
from vgvt.signals.plan import Plan

Key = tuple[Dof, tuple[Dof, ...]]
"""A response and the references of the runs that it was measured in."""


@dataclass(frozen=True, slots=True, eq=False)
class ResponseEstimate:
    """One response over all references of its runs, (R, L); None for what the estimator cannot tell."""

    first_run: int
    values: NDArray[np.complex128]
    variance: NDArray[np.float64] | None
    coherence: NDArray[np.float64] | None


@dataclass(frozen=True, slots=True, eq=False)
class _Cell:
    """One response for one reference, (L,)."""

    first_run: int
    values: NDArray[np.complex128]
    variance: NDArray[np.float64] | None
    coherence: NDArray[np.float64] | None


def assemble(
    where: str, estimates: Mapping[Key, ResponseEstimate], plan: Plan, remarks: tuple[str, ...]
) -> FrequencyResponseSet:
    """One set over all responses; a response that lacks a reference of the others is left out with a remark."""
    references = tuple(dict.fromkeys(r for _, refs in estimates for r in refs))
    rows: dict[Dof, dict[Dof, _Cell]] = {}
    for (dof, refs), estimate in estimates.items():
        for i, reference in enumerate(refs):
            if reference in rows.setdefault(dof, {}):
                raise InputError(
                    f"{where}, response {dof}",
                    f"measured with reference {reference} in different company from run to run",
                    "estimate the runs with other references separately",
                )
            rows[dof][reference] = _cell(estimate, i)
    complete = {dof: [row[r] for r in references] for dof, row in rows.items() if len(row) == len(references)}
    if not complete:
        raise InputError(
            where,
            f"no response was measured with all of the references {', '.join(map(str, references))}",
            "estimate each reference separately, from the runs that have it",
        )
    values = np.array([[cell.values for cell in row] for row in complete.values()])
    blank = int(np.isnan(values).any(axis=(0, 1)).sum())
    return FrequencyResponseSet(
        responses=tuple(complete),
        references=references,
        frequency_hz=plan.frequency_hz[plan.lines],
        values=values,
        runs=tuple(row[0].first_run for row in complete.values()),
        quantity=plan.quantity,
        variance=_stacked([[cell.variance for cell in row] for row in complete.values()]),
        coherence=_stacked([[cell.coherence for cell in row] for row in complete.values()]),
        remarks=(
            *remarks,
            *(f"{dof} left out: not measured with every reference" for dof in rows if dof not in complete),
            *([f"{blank} frequency lines without any force hold NaN"] if blank else []),
        ),
        added_decay_rad_per_s=plan.added_decay_rad_per_s,
    )


def _cell(estimate: ResponseEstimate, i: int) -> _Cell:
    return _Cell(
        estimate.first_run,
        estimate.values[i],
        None if estimate.variance is None else estimate.variance[i],
        None if estimate.coherence is None else estimate.coherence[i],
    )


def _stacked(rows: list[list[NDArray[np.float64] | None]]) -> NDArray[np.float64] | None:
    """(responses, references, L), or None unless every entry is known."""
    return None if any(a is None for row in rows for a in row) else np.array(rows)
