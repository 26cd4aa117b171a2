"""How much longer than the interpreter alone ``vgvt --help`` takes."""

from __future__ import annotations

import subprocess
import sys
import time


def test_help_beside_the_bare_interpreter(benchmark) -> None:
    """The ratio goes into ``extra_info``: both are started in turn, in one run."""

    def seconds(*arguments: str) -> float:
        begin = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
        return time.perf_counter() - begin

    benchmark.pedantic(lambda: seconds("-m", "vgvt", "--help"), rounds=5, warmup_rounds=1)
    bare = min(seconds("-c", "pass") for _ in range(5))
    benchmark.extra_info["ratio_to_the_bare_interpreter"] = benchmark.stats.stats.min / bare
