"""How well a model's FRFs fit measured ones: the NRMSE fit in percent.

Moreno et al., Structural model identification of a small flexible aircraft, American Control
Conference, 2014, equation 13, here on the complex FRF so that phase counts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import FrequencyResponseSet


def fit_percent(measured: NDArray[np.complex128], predicted: NDArray[np.complex128]) -> NDArray[np.float64]:
    """100 (1 - |y - ŷ| / |y - mean(y)|) with the 2-norm over the last axis, frequency.

    Arrays (..., frequency) give (...). 100 is a perfect fit, 0 no better than the mean, negative
    worse; above 70 the paper calls excellent. NaN where the measured FRF is constant. ValueError
    when the shapes differ.
    """
    y, y_hat = np.asarray(measured), np.asarray(predicted)
    if y.shape != y_hat.shape:
        raise ValueError(f"measured and predicted FRFs must have one shape, got {y.shape} and {y_hat.shape}")
    error = np.linalg.norm(y - y_hat, axis=-1)
    scale = np.linalg.norm(y - y.mean(axis=-1, keepdims=True), axis=-1)
    ratio = np.divide(error, scale, out=np.full(np.shape(scale), np.nan), where=scale > 0)
    return np.asarray(100 * (1 - ratio))


def frf_fit_percent(measured: FrequencyResponseSet, predicted: FrequencyResponseSet) -> NDArray[np.float64]:
    """The fit of every FRF, shape (responses, references); ValueError unless both have the same labels and lines."""
    same = (
        measured.responses == predicted.responses
        and measured.references == predicted.references
        and measured.quantity == predicted.quantity
        and np.array_equal(measured.frequency_hz, predicted.frequency_hz)
    )
    if not same:
        raise ValueError("measured and predicted FRFs must have the same DOFs, quantity and frequency lines")
    return fit_percent(measured.values, predicted.values)
