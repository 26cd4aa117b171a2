"""Virtual ground vibration test: from the shaker's coil to the scored mode shape."""

from vgvt._version import __version__

__all__ = ["__version__"]
