"""MuJoCo kept from writing into the user's folder and over the progress line: our own errors say what goes wrong."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def silent() -> Iterator[None]:
    """No MUJOCO_LOG.TXT and nothing on the terminal while this lasts; also a decorator.

    What its compiler warns of comes as Python's :class:`UserWarning`, past its log.
    """
    before, quiet = mujoco.MjLogConfig.get(), mujoco.MjLogConfig.get()
    quiet.logto_file = quiet.logto_console = False
    mujoco.MjLogConfig.set(quiet)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            yield
    finally:
        mujoco.MjLogConfig.set(before)
