"""What the dampers of modes push, in machine code that MuJoCo calls itself: Python stays outside the time loop.

Machine code is kept beside this file, or in the user's cache (NUMBA_CACHE_DIR says where). Where the structs of this
MuJoCo hold the arrays is no constant of it, and compiled in by every process.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

_WORDS: Any = types.CPointer(types.intp)  # type: ignore[no-untyped-call]
_array: Any = numba.carray  # type: ignore[attr-defined]
# As long as no array is: addresses bound what is read.
_ANY = 1 << 40


@dataclass(frozen=True, slots=True)
class Places:
    """Where MuJoCo's structs hold what is needed, in words of eight bytes: of mjModel, then of mjData."""

    ntendon: int
    tendon_adr: int
    tendon_num: int
    tendon_damping: int
    wrap_objid: int
    wrap_prm: int
    jnt_dofadr: int
    qvel: int
    qfrc_passive: int


def _as_pointer(_: Any, address: Any) -> Any:
    """A whole number as the address that it is."""

    def made(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(address), made


_pointer: Any = intrinsic(_as_pointer)


@numba.njit(cache=True, error_model="numpy")
def _push(model: Any, data: Any, at: Any) -> None:
    """Add to the passive forces what tendons push whose number of joints is negative: those that MuJoCo leaves out."""
    here, there = _array(model, (_ANY,), np.intp), _array(data, (_ANY,), np.intp)
    first = _array(_pointer(here[at[1]]), (_ANY,), np.int32)
    number = _array(_pointer(here[at[2]]), (_ANY,), np.int32)
    damping = _array(_pointer(here[at[3]]), (_ANY,), np.float64)
    joint = _array(_pointer(here[at[4]]), (_ANY,), np.int32)
    weight = _array(_pointer(here[at[5]]), (_ANY,), np.float64)
    coordinate = _array(_pointer(here[at[6]]), (_ANY,), np.int32)
    velocity = _array(_pointer(there[at[7]]), (_ANY,), np.float64)
    force = _array(_pointer(there[at[8]]), (_ANY,), np.float64)
    for tendon in range(here[at[0]]):
        begin, end = first[tendon], first[tendon] - number[tendon]
        rate = 0.0
        for k in range(begin, end):
            rate += weight[k] * velocity[coordinate[joint[k]]]
        for k in range(begin, end):
            force[coordinate[joint[k]]] -= damping[tendon] * rate * weight[k]


def compiled_push(places: Places) -> Any:
    """The callback for passive forces, as ctypes has it; whoever installs it must keep it."""
    at = astuple(places)

    @numba.cfunc(types.void(_WORDS, _WORDS))
    def push(model: Any, data: Any) -> None:
        _push(model, data, at)

    return push.ctypes
