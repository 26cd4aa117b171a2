"""The folder of a reconciliation: its files, and whether they answer the question that is asked now."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.data.errors import InputError

if TYPE_CHECKING:
    from vgvt.data import Campaign
    from vgvt.scenario.model import Scenario


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

    def answer(self, fingerprint: str) -> dict[str, Any] | None:
        """The verdict that lies here, if it answers the same question and nothing of it is missing."""
        if not all(p.is_file() for p in (self.verdict, self.scenario, self.report)):
            return None
        try:
            document = json.loads(self.verdict.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        same = isinstance(document, dict) and document.get("fingerprint") == fingerprint
        return document if same else None

    def forget(self) -> None:
        """Remove the rounds of an earlier search: the next one begins anew. Derivatives stay, which hold no effect."""
        for rounds in self.cache.glob("rounds*.json"):
            rounds.unlink(missing_ok=True)

    def prepare(self) -> None:
        """Make the folder; InputError where that is impossible or it is used for something else."""
        if self.path.exists() and not self.path.is_dir():
            raise InputError(str(self.path), "this is a file, and a verdict needs a folder", "give another with --out")
        known = {self.verdict.name, self.scenario.name, self.report.name, "cache", "power.json", "power.html"}
        foreign = [p.name for p in self.path.iterdir() if p.name not in known] if self.path.is_dir() else []
        if any(not name.endswith(".part") for name in foreign):
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
        for name in foreign:
            (self.path / name).unlink(missing_ok=True)


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
