"""Which runs of a window need the terms of leakage beside those of the poles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.rational_fit import Block, RationalFit
from vgvt_identifiers.rational_problem import LEAKAGE_BACKGROUND, RationalProblem


def blocks_that_leak(
    frequency_hz: NDArray[np.float64], blocks: tuple[Block, ...], fit: RationalFit, background: int
) -> NDArray[np.bool_]:
    """Whether each block (B,) needs its leakage: at the poles of the fit, its error without rises by more than noise.

    ``frequency_hz`` (K,) and ``background`` are those of the fit, whose blocks these are.
    A sweep that passes a mode early in the record turns 1/F so little across the mode that leakage can take
    the place of the mode itself; terms that are not there must therefore go, not only cost certainty.
    Schwarz, Estimating the dimension of a model, Annals of Statistics 6(2), 1978.
    """
    x = (2 * np.pi * frequency_hz - fit.centre_rad_s) / fit.half_width_rad_s
    z = (fit.poles - 1j * fit.centre_rad_s) / fit.half_width_rad_s
    mirror = fit.centre_rad_s / fit.half_width_rad_s if fit.mirrored else None
    needed = np.zeros(len(blocks), bool)
    for which, block in enumerate(blocks):
        if block.leakage is None:
            continue
        still = Block(block.values, block.weight, block.row_scale)
        full, less = (RationalProblem.of(x, (b,), background, mirror).cost(z) for b in (block, still))
        rows, terms = block.values.shape[0], z.size + LEAKAGE_BACKGROUND
        freedom = rows * (x.size - terms - background - z.size * (1 + fit.mirrored))
        penalty = 2 * rows * terms * np.log(2 * rows * x.size)
        needed[which] = 2 * (less - full) * max(freedom, 1) > penalty * full
    return needed
