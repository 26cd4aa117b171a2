"""Parameters that nothing which is foretold depends on: of a loose flap, how far it turns freely.

Only joints are followed at each level of force. What else depends on level is tried as it is at rest, where its gap or
its preload does nothing; a fit then hands the middle of what is plausible back, give or take all of it.
"""

from __future__ import annotations

import numpy as np

from vgvt.reconcile.fitting.fit import Fit

# Of a deviation of a value of the data, by a whole one of the parameter: all values together do not see it either.
_NOTHING = 1e-3


def untold_parameters(fit: Fit, index: int) -> tuple[str, ...]:
    """Parameters of a hypothesis that move nothing in a fit; not those at the end of what is tried, which cannot."""
    start = fit.u.size + sum(len(h.parameters) for h in fit.hypotheses[:index])
    values = fit.values(index)
    return tuple(
        p.name
        for k, p in enumerate(fit.hypotheses[index].parameters)
        if values[p.name][1] > 0 and np.abs(fit.tangent[:, start + k]).max(initial=0.0) < _NOTHING
    )
