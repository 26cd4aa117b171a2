"""How much memory a command took."""

from __future__ import annotations

import platform


def peak_memory_mib() -> float | None:
    """The most memory that this process, or one of its children, ever held, in MiB; None where nobody counts."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    largest = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return float(largest / (2**20 if platform.system() == "Darwin" else 2**10))
