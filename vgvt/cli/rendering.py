"""Which way to OpenGL MuJoCo takes: only pictures need one, and one that does not work is to stop nothing else."""

from __future__ import annotations

import ctypes
import os
import sys

from vgvt.cli.boundary import CommandError

VARIABLE = "MUJOCO_GL"
NONE = "disabled"
"""What MuJoCo takes for: load no OpenGL at all."""

_aside: dict[str, str] = {}


def draw_nothing() -> None:
    """Let MuJoCo load without OpenGL in this process; what the environment asks for waits until there is a picture.

    MuJoCo loads what its variable names as it is imported: a word that it does not know, or a library that is not
    installed, would end every command.
    """
    _aside[VARIABLE] = os.environ.get(VARIABLE, "")
    os.environ[VARIABLE] = NONE


def asked_for() -> str:
    """What the user's MUJOCO_GL says; empty where it is not set, or to nothing."""
    return _aside.get(VARIABLE, os.environ.get(VARIABLE, "")).strip().lower()


def back_end() -> str:
    """The way that pictures take: what MUJOCO_GL says, else EGL on Linux; empty for what MuJoCo takes by itself.

    EGL opens no window, so that a display that is dead or forwarded from elsewhere does not matter.
    """
    if asked := asked_for():
        return asked
    if sys.platform != "linux":
        return ""
    has_display = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return "" if has_display and not _has_egl() else "egl"


def advice() -> str:
    """What to do where the way that pictures take does not work."""
    if asked_for() in ("", "egl"):
        return "on Debian: apt install libegl1 libgl1-mesa-dri, then MUJOCO_GL=egl"
    return "unset MUJOCO_GL, or set it to what works here: egl, osmesa or glfw"


def load_opengl() -> None:
    """Load the simulation with the way that pictures take; CommandError where that fails."""
    os.environ[VARIABLE] = chosen = back_end()
    try:
        import vgvt.simulation  # noqa: F401
    except Exception as error:
        # What goes wrong depends on the back end; an import that comes as far as MuJoCo's end has no fault of its.
        if "mujoco" in sys.modules:
            raise
        problem = f"OpenGL does not work here (back end: {chosen or 'the default'}): {error}"
        raise CommandError(problem, f"{advice()}; or go without: --no-picture") from error


def _has_egl() -> bool:
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return True
