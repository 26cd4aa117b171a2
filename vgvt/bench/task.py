"""What is worked off: cells of a bench, cases of a study, campaigns of a rehearsal."""

from __future__ import annotations

from typing import Protocol


class Titled(Protocol):
    """A piece of work that can be told in words, and handed to another process."""

    @property
    def title(self) -> str:
        """The piece in words, for progress and for what is said where it fails."""


class Kept(Titled, Protocol):
    """A piece of work whose rows are kept on disk."""

    @property
    def key(self) -> str:
        """A hash, or a name, of all that the result depends on, code aside."""
