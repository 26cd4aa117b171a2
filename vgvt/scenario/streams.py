"""Named random streams: every random number of a campaign belongs to a seed and a name."""

from __future__ import annotations

import hashlib
import json

import numpy as np


def named_stream(seed: int, *names: str | int) -> np.random.Generator:
    """A generator of its own for ``seed`` and ``names``, like ``named_stream(7, "noise", run, "4+Z")``.

    Streams are independent of each other and of which others exist, so another
    sensor, run or effect changes no number of the rest. ValueError without a name.
    """
    if not names:
        raise ValueError("a named stream needs at least one name")
    # JSON keeps ("a", "bc"), ("ab", "c"), (1,) and ("1",) apart.
    text = json.dumps([int(seed), *(n if isinstance(n, str) else int(n) for n in names)])
    digest = hashlib.sha256(text.encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest, "big")))
