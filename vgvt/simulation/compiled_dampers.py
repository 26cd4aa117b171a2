"""The dampers of modes in compiled code while records are stepped, in place of tendons.

A mode's damper is a tendon over every elastic joint, whose row never changes. MuJoCo builds it anew for every force,
joint by joint and past all that stand in it: two fifths of the time of a step of Hati, four fifths of GARTEUR's. Here
these tendons have no joints as far as MuJoCo sees, and a callback adds what they push.

MuJoCo's Python package does not say where its structs hold the arrays: that is found in a small model by the arrays'
addresses, and the callback is compared with tendons before it is trusted. Where anything is not as expected, or
somebody else has such a callback, tendons stay, and all that is lost is time.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from functools import cache
from typing import Any

import mujoco
import numpy as np

from vgvt.simulation.damping import MODAL_DAMPING

# What MuJoCo needs for every place in a tendon's row that it goes past, s, and how often a step of RK4 asks for forces.
_GONE_PAST_S, _STAGES = 2e-9, 4
# What must be saved, s: to load what compiles, and where its structs are, takes half of it, the first time all.
_WORTH_S = 1.0
# MuJoCo's structs are smaller by far.
_FURTHEST = 1 << 20
_TENDONS = 11

_lock, _probing = threading.Lock(), threading.Lock()
_users = 0


@contextmanager
def compiled_dampers(models: Sequence[mujoco.MjModel], steps: int) -> Iterator[list[mujoco.MjModel]]:
    """Models to be stepped ``steps`` times each within the block, their modes' dampers compiled where that pays.

    Others are the models themselves. Outside of the block the copies have no such dampers. RuntimeError where somebody
    else has replaced the callback within it, without which what was stepped is not damped.
    """
    callback = _ready() if steps * sum(map(_wasted_s, models)) >= _WORTH_S else None
    if callback is None or not _installed(callback):
        yield list(models)
        return
    try:
        yield [_relieved(model) for model in models]
        if mujoco.get_mjcb_passive() is not callback:
            raise RuntimeError("mujoco.set_mjcb_passive was called while records were stepped: step them again without")
    finally:
        _released(callback)


def _wasted_s(model: mujoco.MjModel) -> float:
    """What a step of a model takes for the rows of its modes' dampers, s."""
    return _STAGES * _GONE_PAST_S / 2 * sum(float(model.tendon_num[t]) ** 2 for t in _modal(model))


def _modal(model: mujoco.MjModel) -> list[int]:
    """The dampers that the callback can stand for: an effect may let them grow with speed, which stays with MuJoCo."""
    modal = [t for t in range(model.ntendon) if model.tendon(t).name.startswith(MODAL_DAMPING)]
    return [t for t in modal if not model.tendon_dampingpoly[t].any()]


def _relieved(model: mujoco.MjModel) -> mujoco.MjModel:
    """A copy whose modal dampers MuJoCo leaves out, and the callback does not."""
    out = copy(model)
    out.tendon_num[_modal(model)] *= -1
    return out


def _installed(callback: Any) -> bool:
    """Whether the callback is in place: another user's here shares it, anybody else's stays."""
    global _users
    with _lock:
        if _users == 0:
            if mujoco.get_mjcb_passive() is not None:
                return False
            mujoco.set_mjcb_passive(callback)
        _users += 1
        return True


def _released(callback: Any) -> None:
    """Take the callback away behind its last user, and nobody else's."""
    global _users
    with _lock:
        _users -= 1
        if _users == 0 and mujoco.get_mjcb_passive() is callback:
            mujoco.set_mjcb_passive(None)


def _ready() -> Any | None:
    """The one callback, however many threads ask for it first; None beside somebody else's, for as long as that is."""
    with _probing:
        with _lock:
            taken = _users == 0 and mujoco.get_mjcb_passive() is not None
        return None if taken else _probed()


@cache
def _probed() -> Any | None:
    """The callback, once it has done in a small model what tendons do; None where it cannot be made."""
    model = _probe()
    data = mujoco.MjData(model)
    data.qvel[:] = [0.3, -0.7, 0.2]
    mujoco.mj_forward(model, data)
    wanted = data.qfrc_passive.copy()
    places = _places(model, data)
    if places is None or mujoco.get_mjcb_passive() is not None:
        return None
    try:
        from vgvt.simulation.compiled_push import Places, compiled_push

        callback, relieved = compiled_push(Places(**places)), _relieved(model)
    except Exception:  # noqa: BLE001  nowhere to keep machine code, NUMBA_DISABLE_JIT: errors have no common kind
        return None
    if not _installed(callback):
        return None
    try:
        mujoco.mj_forward(relieved, data)
    finally:
        _released(callback)
    return callback if np.allclose(data.qfrc_passive, wanted, rtol=1e-12, atol=0.0) else None


def _places(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, int] | None:
    """Where the structs hold arrays and the number of tendons, in words; None where that is not told."""
    if ctypes.sizeof(ctypes.c_void_p) != 8 or not (hasattr(model, "_address") and hasattr(data, "_address")):
        return None
    of_model = ("tendon_adr", "tendon_num", "tendon_damping", "wrap_objid", "wrap_prm", "jnt_dofadr")
    found = {name: _word(model._address, getattr(model, name).ctypes.data) for name in of_model}
    found |= {name: _word(data._address, getattr(data, name).ctypes.data) for name in ("qvel", "qfrc_passive")}
    # Sizes stand before the arrays.
    sizes = np.ctypeslib.as_array((ctypes.c_int64 * min(found[n] for n in of_model)).from_address(model._address))
    (counts,) = np.nonzero(sizes == _TENDONS)
    return found | {"ntendon": int(counts[0])} if counts.size == 1 else None


def _word(begin: int, wanted: int) -> int:
    """The first word, counted from an address, that holds another one; it is there."""
    return next(k for k in range(_FURTHEST // 8) if ctypes.c_uint64.from_address(begin + 8 * k).value == wanted)


def _probe() -> mujoco.MjModel:
    """Three masses one above the other, and as many dampers over them as there is nothing else of."""
    spec = mujoco.MjSpec()
    body = spec.worldbody
    for name in ("a", "b", "c"):
        body = body.add_body(pos=[0.0, 0.0, 1.0])
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0.0, 0.0], mass=1.0)
    for k in range(_TENDONS):
        damper = spec.add_tendon(name=f"{MODAL_DAMPING}{k}", damping=[0.5 + k, 0.0, 0.0])
        for weight, name in enumerate("abc"[: 1 + k % 3], start=1):
            damper.wrap_joint(name, float(weight - k))
    return spec.compile()
