"""A name must take away what one place explains: where that stays as it was, something else acts there.

A free force at one place that explains nearly all of a residual is the signature of a single interface. An effect that
takes part of the misfit and leaves the same place to explain nearly all of the rest has bent towards it, not found it.
"""

from __future__ import annotations

from vgvt.reconcile.evidence.localise import Localisation

# Of the residual: a single interface explains more, several at once leave each place less.
_NEARLY_ALL = 0.8
# An effect that takes this much of what held-out data were missed by is right but inexact: what is left sits where
# it does.
_MOST = 0.75


def left_where_it_was(before: Localisation, after: Localisation, missed_before: float, missed_after: float) -> bool:
    """Whether one place explains nearly all, without a name and with it, and the name takes less than most.

    ``missed_before`` and ``missed_after`` are what held-out data are missed by beyond noise, in χ² per degree of
    freedom.
    """
    if not before.places or missed_after <= (1 - _MOST) * missed_before:
        return False
    place = before.places[0]
    still = {p.label: p.explained for p in after.places}.get(place.label, 0.0)
    return place.explained >= _NEARLY_ALL and still >= _NEARLY_ALL
