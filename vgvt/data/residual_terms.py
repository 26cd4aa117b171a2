"""What the modes outside a claim's band add to its accelerances: a mass line below, a stiffness line above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_POWERS = (0, 2)  # of s in an accelerance: heavy and stiff modes outside the band


def residual_terms(
    rest: NDArray[np.complex128], frequency_hz: NDArray[np.float64], at_hz: NDArray[np.float64] | None = None
) -> NDArray[np.complex128]:
    """Real constant and real s² in what a model leaves over of accelerances (R, I, F), by least squares.

    Fitted at ``frequency_hz`` (F,), told there or at ``at_hz`` (G,), shape (R, I, G). Ewins, Modal
    Testing, 2nd ed., 2000, section 4.4.
    """

    def powers(hertz: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([(hertz / frequency_hz[-1]) ** power for power in _POWERS], axis=1)

    columns = rest.real.reshape(-1, frequency_hz.size).T
    coefficients = np.linalg.lstsq(powers(frequency_hz), columns, rcond=None)[0]
    design = powers(frequency_hz if at_hz is None else at_hz)
    return np.asarray((design @ coefficients).T.reshape(*rest.shape[:2], -1), dtype=complex)
