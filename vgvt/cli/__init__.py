"""The command line: one file a command, strings in, types inside."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

_THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one ``vgvt`` command and return its exit status: 0 done, 1 failed, 2 bad input, 130 interrupted."""
    # Small singular value decompositions slow down 30 to 200 times when BLAS threads contend;
    # the pin must come before numpy loads.
    for variable in _THREAD_VARIABLES:
        os.environ.setdefault(variable, "1")
    try:
        if arguments is None:  # a process of our own: nobody else in it wants to draw with MuJoCo
            from vgvt.cli.rendering import draw_nothing

            draw_nothing()
        from vgvt.cli.boundary import run_command

        return run_command(list(sys.argv[1:] if arguments is None else arguments))
    except KeyboardInterrupt:
        sys.stderr.write("vgvt: interrupted, nothing was written\n")
        return 130
