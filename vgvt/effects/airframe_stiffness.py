"""The airframe with all of its stiffness, or damping, scaled: what ageing, warmth and moisture do.

All is what the airframe states, or has been given: sections, roots and carry-through. Left alone are the suspension,
what effects hang on the airframe or tie two places of it with (absorbers, hinges of control surfaces, cables), and of
the law of a root's joint its k3, friction and play, and the spring that such an effect gives to a rigid root.
"""

from __future__ import annotations

from vgvt.data import InputError
from vgvt.scenario.airframe import Airframe, Beam, Damping

_COLUMNS = ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "in_plane_stiffness_n_m2")
_ROOTS = ("root_bending_stiffness_n_m_per_rad", "root_torsional_stiffness_n_m_per_rad")


def with_stiffness_scaled(airframe: Airframe, factor: float) -> Airframe:
    """EI, GJ and root springs of every beam and the carry-through times ``factor``; modal damping ratios stay.

    InputError unless positive.
    """
    _require_positive(factor, "stiffness")
    body, name = airframe.body, "carry_through_stiffness_n_m_per_rad"
    own = getattr(body, name)
    between = body if own is None else body.model_copy(update={name: own * factor})
    return airframe.model_copy(update={"beam": tuple(_scaled(beam, factor) for beam in airframe.beam), "body": between})


def with_damping_scaled(airframe: Airframe, factor: float) -> Airframe:
    """Every modal damping ratio times ``factor``. InputError unless positive."""
    _require_positive(factor, "damping")
    damping = airframe.damping
    changed: Damping = damping.model_copy(
        update={
            "damping_ratio": damping.damping_ratio * factor,
            "modal": tuple(ratio * factor for ratio in damping.modal),
        }
    )
    return airframe.model_copy(update={"damping": changed})


def _scaled(beam: Beam, factor: float) -> Beam:
    columns = {name: getattr(beam.stations, name) for name in _COLUMNS}
    stations = beam.stations.model_copy(
        update={name: tuple(v * factor for v in column) for name, column in columns.items() if column is not None}
    )
    roots = {name: getattr(beam, name) for name in _ROOTS}
    springs = {name: spring * factor for name, spring in roots.items() if spring is not None}
    return beam.model_copy(update={"stations": stations, **springs})


def _require_positive(factor: float, what: str) -> None:
    if not factor > 0:
        raise InputError(
            f"effect on the airframe's {what}",
            f"it would be {factor:g} times what it was",
            "Write a smaller change: fractions, so 0.02 is 2 %.",
        )
