"""The folder of a reconciliation: its files, and whether they answer the question that is asked now."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.cli.document import document_text
from vgvt.data.errors import InputError
from vgvt.files.atomically import replacing
from vgvt.files.manifest import file_sha256

if TYPE_CHECKING:
    from vgvt.data import Campaign
    from vgvt.scenario.model import Scenario

_HALF_WRITTEN = re.compile(r"\.(?P<name>.+)\.[0-9a-f]{8}\.part")
_EDITED = re.compile(r"reconciled-edited(-\d+)?\.toml")


@dataclass(frozen=True, slots=True)
class ReconcileFolder:
    """The names of the files in a reconciliation's folder."""

    path: Path

    @property
    def verdict(self) -> Path:
        """The verdict as JSON."""
        return self.path / "verdict.json"

    @property
    def scenario(self) -> Path:
        """The scenario with what was found."""
        return self.path / "reconciled.toml"

    @property
    def report(self) -> Path:
        """The one-file page."""
        return self.path / "report.html"

    @property
    def cache(self) -> Path:
        """What a second call can go on from."""
        return self.path / "cache"

    @property
    def lock(self) -> Path:
        """What a process holds that works here."""
        return self.cache / "lock"

    @property
    def places(self) -> dict[str, str]:
        """Where the files are, as a verdict tells it: from where the command is given, wherever they were written."""
        return {"folder": str(self.path), "report": str(self.report), "reconciled": str(self.scenario)}

    def answer(self, fingerprint: str) -> dict[str, Any] | None:
        """The verdict that lies here, if it answers the same question and nothing of it is missing."""
        if not all(p.is_file() for p in (self.verdict, self.scenario, self.report)):
            return None
        document = self._told()
        if document.get("fingerprint") != fingerprint:
            return None
        return document | self.places | {"reconciled_edited": self.edited}

    @property
    def edited(self) -> bool:
        """Whether the scenario is another one than that of the verdict that lies here: somebody has edited it."""
        written = self._told().get("reconciled_sha256")
        return written is not None and self.scenario.is_file() and file_sha256(self.scenario) != written

    def _told(self) -> dict[str, Any]:
        """The verdict that lies here, whatever it answers; empty where it cannot be read."""
        try:
            document = json.loads(self.verdict.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return document if isinstance(document, dict) else {}

    def publish(self, document: Mapping[str, Any]) -> Path | None:
        """Put what lies in the cache in its place, the verdict, which makes the folder an answer, last.

        A call that is stopped before leaves the former answer whole. A scenario that somebody has edited is kept
        under another name, which is returned. InputError where what was written is not there any more.
        """
        moved = {self.cache / place.name: place for place in (self.scenario, self.report)}
        for written in moved:
            if not written.is_file():
                raise InputError(str(written), "has gone since it was written", "let nothing else work in this folder")
        kept = self._kept_aside() if self.edited else None
        self.verdict.unlink(missing_ok=True)
        for written, place in moved.items():
            written.replace(place)
        with replacing(self.verdict) as temporary:
            temporary.write_text(document_text(document), encoding="utf-8")
        return kept

    def _kept_aside(self) -> Path:
        """The edited scenario under a name that nothing has yet."""
        names = (self.path / f"reconciled-edited{'' if k == 1 else f'-{k}'}.toml" for k in count(1))
        return self.scenario.rename(next(name for name in names if not name.exists()))

    @property
    def rounds(self) -> tuple[Path, ...]:
        """The rounds of a search that are kept."""
        return tuple(self.cache.glob("rounds*.json"))

    @property
    def begun(self) -> bool:
        """Whether anything is kept that a second call can go on from."""
        return any(path.is_file() and path != self.lock for path in self.cache.rglob("*"))

    def forget(self) -> None:
        """Remove the rounds of an earlier search: the next one begins anew. Derivatives stay, which hold no effect."""
        for kept in self.rounds:
            kept.unlink(missing_ok=True)

    def prepare(self) -> None:
        """Make the folder; InputError where that is impossible or it is used for something else."""
        if self.path.exists() and not self.path.is_dir():
            raise InputError(str(self.path), "this is a file, and a verdict needs a folder", "give another with --out")
        known = {*self._written, "cache"}
        there = list(self.path.iterdir()) if self.path.is_dir() else []
        foreign = [p.name for p in there if not (p.name in known or self._left_over(p) or _EDITED.fullmatch(p.name))]
        if foreign:
            raise InputError(
                str(self.path),
                f"holds other files ({', '.join(sorted(foreign)[:3])})",
                "give another folder with --out",
            )
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(str(self.path), f"cannot be made ({error.strerror})", "give another with --out") from None
        if not os.access(self.path, os.W_OK | os.X_OK):
            raise InputError(str(self.path), "may not write here", "give another place with --out FOLDER")

    def sweep(self) -> None:
        """Remove what a call that was killed while it wrote left half written; for who is alone in the folder."""
        for path in [p for p in self.path.iterdir() if self._left_over(p)]:
            path.unlink(missing_ok=True)

    @property
    def _written(self) -> tuple[str, ...]:
        """Names of the files that are written here, of a reconciliation and of a power study."""
        return self.verdict.name, self.scenario.name, self.report.name, "power.json", "power.html"

    def _left_over(self, path: Path) -> bool:
        """Whether this is a half written file of ours (:func:`vgvt.files.atomically.replacing`), and of nobody else."""
        found = _HALF_WRITTEN.fullmatch(path.name)
        return found is not None and found["name"] in self._written and path.is_file()


def fingerprint_of(
    campaign: Campaign, scenario: Scenario, effects: Mapping[str, type], options: Mapping[str, object]
) -> str:
    """Hash of everything that a verdict follows from: samples, channels, scenario, effects, options, version.

    An effect that somebody is writing keeps its name: it is what it does that counts.
    """
    from vgvt import __version__
    from vgvt.cli.run_folder import scenario_sha256
    from vgvt.reconcile.question.effect_code import code_of

    found = hashlib.sha256()
    for record in campaign.runs:
        labels = [f"{c.name} {c.role.value} {c.dof}" for c in record.channels]
        found.update(json.dumps([record.run, record.sample_rate_hz, labels]).encode())
        found.update(record.samples.tobytes())
    facts = {
        "band_hz": list(campaign.band_hz),
        "scenario": scenario_sha256(scenario),
        "version": __version__,
        "effects": sorted(effects),
        "code": code_of(effects, scenario),
        **options,
    }
    found.update(json.dumps(facts, sort_keys=True).encode())
    return found.hexdigest()
