"""Weights of a rational fit from its own errors: output noise plus response times force noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.rational_fit import Block, RationalFit


def reweighted(blocks: tuple[Block, ...], fit: RationalFit) -> tuple[Block, ...]:
    """The blocks with weights from the errors of a fit: output noise plus response times force noise.

    A - G F has the variance S_a + |G|^2 S_f, so |e|^2 / |leakage|^2 is regressed
    on 1 and |G|^2 (errors in variables, frozen weights).
    """
    return tuple(_reweighted(b, g, e) for b, g, e in zip(blocks, fit.fitted, fit.errors, strict=True))


def _reweighted(block: Block, model: NDArray[np.complex128], error: NDArray[np.complex128]) -> Block:
    from scipy.optimize import nnls

    inverse_force = np.ones(block.weight.size) if block.leakage is None else np.abs(block.leakage)
    noise = np.abs(error) ** 2 / inverse_force**2
    level = np.maximum(np.median(noise, axis=1) / np.log(2), 1e-300)
    gain = (np.abs(model) ** 2 / level[:, None]).mean(axis=0)
    target = (noise / level[:, None]).mean(axis=0)
    shape = np.ones_like(target)
    for _ in range(4):
        columns = np.stack([np.ones_like(gain), gain], axis=1) / shape[:, None]
        constant, slope = nnls(columns, target / shape)[0]
        shape = max(constant, 1e-3) + slope * gain
    return replace(block, weight=1 / (inverse_force * np.sqrt(shape)), row_scale=1 / np.sqrt(level))
