"""The time loop of a march in machine code, where there is a place for that.

Compiling takes seconds, once: machine code is kept beside the loop's file, or in the user's cache where that cannot be
written (NUMBA_CACHE_DIR says otherwise). Without a folder it is compiled anew by every process; where nothing
compiles, steps are taken in plain Python, and all that is lost is time.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics import march_steps

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def stepped(
    moved: Array, grown: ComplexArray, pushed: ComplexArray, out: ComplexArray, yields: Array, laws: Array
) -> Array:
    """What :func:`vgvt.reconcile.mechanics.march_steps.stepped` gives, which says what is asked for.

    Warns once where nothing compiles, which takes a hundred times as long.
    """
    arguments = (moved, grown, pushed, out, yields, laws)
    for keeps in (True, False):
        if keeps in _failed:
            continue
        try:
            return np.asarray(_compiled(keeps)(*arguments))
        except MemoryError:
            raise
        except Exception as error:  # noqa: BLE001  no folder, a full disk, no executable memory: errors of any kind
            _failed[keeps] = error
            if not keeps:
                warnings.warn(_slow(error), RuntimeWarning, stacklevel=2)
    # What runs away is not a number, as in machine code.
    with np.errstate(all="ignore"):
        return march_steps.stepped(*arguments)


# Why machine code that is kept, or that is not, cannot be had here.
_failed: dict[bool, Exception] = {}


@cache
def _compiled(keeps: bool) -> Callable[..., Any]:
    """The loop as it is compiled when it is first called; with NUMBA_DISABLE_JIT itself."""
    # Here, as loading a compiler takes a third of a second and few campaigns need it.
    import numba
    from numba.extending import register_jitable

    register_jitable(error_model="numpy")(march_steps.spring_force)
    made: Callable[..., Any] = numba.njit(cache=keeps, error_model="numpy")(march_steps.stepped)
    return made


def _slow(error: Exception) -> str:
    return (
        f"joints that depend on level are stepped without machine code, which takes a hundred times as long: {error} "
        "(it needs memory that may be executed)"
    )
