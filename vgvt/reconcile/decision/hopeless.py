"""Whether names that may still come can take what is left: they come best first, and there are only so many."""

from __future__ import annotations

from vgvt.reconcile.evidence.confirmation import shares_taken
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.fitting.fit import Fit

# One name may come before a larger one for what it does to held-out data: of its share nothing follows yet.
_TELLING = 2


def hopeless(names: int, most: int, found: Fit, without: Fit, after: Residual, before: Residual) -> bool:
    """Whether so many ``names``, of ``most`` that there may be, took too little for the others to take the rest.

    A later one takes no more than an earlier one: where k of n names took less than k/n of what was too much, of the
    fit and of held-out data, all n of them leave something. Asked only of what is far off, and not of a first name.
    ``found`` is the fit with the names and ``without`` that without any; ``after`` and ``before`` what they leave.
    """
    if names < _TELLING or not after.limits.far_off(found.chi2_per_dof, after.held_out_chi2_per_dof):
        return False
    return max(shares_taken(found, without, after.held_out_chi2_per_dof, before)) < names / most
