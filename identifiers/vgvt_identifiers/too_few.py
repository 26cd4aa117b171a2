"""The one fault of the data that methods find deep in their equations and tell people as it is."""

from __future__ import annotations


class TooFewError(ValueError):
    """A record or a band holds too few samples or lines for what is asked of it; the message is advice for people."""
