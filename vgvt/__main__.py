"""``python -m vgvt``."""

from __future__ import annotations

import sys

from vgvt.cli import main

if __name__ == "__main__":
    sys.exit(main())
