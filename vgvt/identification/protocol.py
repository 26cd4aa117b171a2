"""What an identifier is: a frozen dataclass of settings and one pure method."""

from __future__ import annotations

from enum import Flag, auto
from typing import ClassVar, Protocol, runtime_checkable

from vgvt.data import Campaign, ModalModel


class Needs(Flag):
    """What a method wants from a campaign; combine with ``|``."""

    FORCE_REFERENCE = auto()
    """Every run must have a force channel; without one the method declines."""
    TIME_HISTORIES = auto()
    """Works on the sampled records themselves."""
    FRFS = auto()
    """Works on frequency response functions estimated from the records."""
    OUTPUT_ONLY = auto()
    """Uses the responses alone, so damping and shapes rest on an assumed excitation."""


@runtime_checkable
class Identifier(Protocol):
    """An identification method with its settings, as a frozen dataclass whose fields are the settings.

    ``name`` is the name it is registered under, ``summary`` one sentence,
    ``citation`` BibTeX of what it implements. ``identify`` is pure: the same
    campaign and band give the same claim, and the campaign is left as it was.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    citation: ClassVar[str]
    needs: ClassVar[Needs]

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes inside ``band_hz`` (low, high), or an empty model whose outcome and advice say why."""
        ...
