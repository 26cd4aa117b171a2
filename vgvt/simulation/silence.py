"""MuJoCo kept from writing into the user's folder and over the progress line: our own errors say what goes wrong."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def silent() -> Iterator[None]:
    """No MUJOCO_LOG.TXT and nothing on the terminal while this lasts; also a decorator."""
    before, quiet = mujoco.MjLogConfig.get(), mujoco.MjLogConfig.get()
    quiet.logto_file = quiet.logto_console = False
    mujoco.MjLogConfig.set(quiet)
    try:
        yield
    finally:
        mujoco.MjLogConfig.set(before)
