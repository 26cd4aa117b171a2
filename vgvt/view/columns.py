"""Numbers of a table's column, what no row states left out: NaN over nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def stated(column: Any) -> NDArray[np.float64]:
    """The finite values (N,) of a pandas column or an array."""
    numbers = column.astype("Float64").to_numpy(dtype=float, na_value=np.nan) if hasattr(column, "to_numpy") else column
    values = np.asarray(numbers, dtype=float)
    return np.asarray(values[np.isfinite(values)])


def root_mean_square(column: Any) -> float:
    """Root of the mean square of what is stated."""
    values = stated(column)
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def mean(column: Any) -> float:
    """Mean of what is stated."""
    values = stated(column)
    return float(values.mean()) if values.size else float("nan")


def median(column: Any) -> float:
    """Median of what is stated."""
    values = stated(column)
    return float(np.median(values)) if values.size else float("nan")


def least(column: Any) -> float:
    """Smallest of what is stated."""
    values = stated(column)
    return float(values.min()) if values.size else float("nan")
