"""An entry of the bench: an identifier with its settings, under one name."""

from __future__ import annotations

from dataclasses import dataclass

from vgvt.data import InputError


@dataclass(frozen=True, slots=True)
class Entry:
    """An identifier's registered name and the settings that differ from its defaults, as text."""

    identifier: str
    settings: tuple[tuple[str, str], ...] = ()

    @property
    def label(self) -> str:
        """The entry as it is written: ``era`` or ``era:order=20,window=hann``."""
        settings = ",".join(f"{key}={value}" for key, value in self.settings)
        return f"{self.identifier}:{settings}" if settings else self.identifier

    @classmethod
    def parse(cls, text: str) -> Entry:
        """The entry written as NAME or NAME:key=value,key=value; InputError says what is wrong."""
        name, _, rest = text.partition(":")
        settings = []
        for pair in filter(None, rest.split(",")):
            key, equals, value = pair.partition("=")
            if not equals or not key.strip().replace("-", "_").isidentifier():
                raise InputError("--identifier", f"{pair!r} is not a setting", "write NAME:key=value,key=value")
            settings.append((key.strip().replace("-", "_"), value.strip()))
        return cls(name.strip(), tuple(sorted(settings)))
