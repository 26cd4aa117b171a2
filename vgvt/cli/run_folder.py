"""A run folder: where a campaign, its sealed truth, the claims and the scores lie, and when it may be reused."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.cli.boundary import CommandError
from vgvt.data.errors import InputError

if TYPE_CHECKING:
    from vgvt.scenario.model import Scenario

_TEMPORARY = ".*.part"  # what vgvt.files.atomically leaves when the machine goes down in the middle of writing
_REPLACE = "remove the folder, or replace the run in it with --force"


class HalfSwappedError(CommandError):
    """Stopped between the first and the last rename of a swap of runs."""

    def __init__(self, path: Path) -> None:
        super().__init__(f"{path}: stopped while the new run took the old one's place", "do it again with --force")


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The names of the files in a run folder."""

    path: Path

    @property
    def scenario(self) -> Path:
        """The scenario with every default and every option of the command line written out."""
        return self.path / "scenario.toml"

    @property
    def campaign(self) -> Path:
        """What the engineer brings home."""
        return self.path / "campaign.nc"

    @property
    def truth(self) -> Path:
        """What no identifier may see."""
        return self.path / "sealed" / "truth.nc"

    @property
    def manifest(self) -> Path:
        """Hashes, versions, seed and times."""
        return self.path / "manifest.json"

    @property
    def report(self) -> Path:
        """The one-file page."""
        return self.path / "report.html"

    def claim(self, identifier: str) -> Path:
        """What an identifier said."""
        return self.path / "claims" / f"{identifier}.json"

    def scorecard(self, identifier: str) -> Path:
        """How right it was."""
        return self.path / "scorecards" / f"{identifier}.json"

    def manifest_document(self) -> dict[str, Any] | None:
        """The manifest, None where there is none; InputError for one that cannot be read."""
        try:
            document = json.loads(self.manifest.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise InputError(str(self.manifest), f"cannot be read: {error}", _REPLACE) from None
        if not isinstance(document, dict):
            raise InputError(str(self.manifest), "is not a manifest", _REPLACE)
        return document

    @contextmanager
    def staging(self) -> Iterator[RunFolder]:
        """A run folder within this one to write a new run into; it goes with what is left in it."""
        path = self.path / f".{uuid.uuid4().hex[:8]}.part"
        path.mkdir()
        try:
            yield RunFolder(path)
        finally:
            shutil.rmtree(path, ignore_errors=True)

    def take_over(self, staged: RunFolder) -> None:
        """Put a staged run in the place of this one; only renames, with the manifest last.

        HalfSwappedError when that was stopped in the middle: no manifest then, so that nobody takes the run for whole.
        """
        try:
            self.forget_results()
            self.truth.parent.mkdir(exist_ok=True)
            for new, place in (
                (staged.scenario, self.scenario),
                (staged.truth, self.truth),
                (staged.campaign, self.campaign),
                (staged.manifest, self.manifest),
            ):
                new.replace(place)
        except (OSError, KeyboardInterrupt, SystemExit) as error:
            self.manifest.unlink(missing_ok=True)
            raise HalfSwappedError(self.path) from error

    def forget_results(self) -> None:
        """Remove what was concluded from a campaign that is about to be replaced."""
        stale = [self.manifest, self.report]
        stale += [path for part in ("claims", "scorecards") for path in (self.path / part).glob("*.json")]
        for path in stale:
            path.unlink(missing_ok=True)


def scenario_sha256(scenario: Scenario) -> str:
    """Hash of everything the scenario says, seed and engine included, whatever the order of its keys."""
    text = json.dumps(scenario.model_dump(mode="json"), sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def default_folder(scenario: Scenario, original_seed: int, original_engine: str) -> Path:
    """runs/NAME, with seed and engine in the name where the command line changed them."""
    name = scenario.name
    if scenario.seed != original_seed:
        name += f"-seed{scenario.seed}"
    if scenario.simulation.engine != original_engine:
        name += f"-{scenario.simulation.engine}"
    return Path("runs") / name


def prepared_folder(path: Path, sha256: str, force: bool) -> tuple[RunFolder, bool]:
    """The folder for a run, and whether the campaign in it can be reused.

    InputError when it holds another scenario's run or foreign files, unless
    ``force``; then the run's own files are replaced and foreign ones left alone.
    """
    folder = RunFolder(path)
    if path.exists() and not path.is_dir():
        raise InputError(str(path), "this is a file, and a run needs a folder", "give another place with --out FOLDER")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(path), f"cannot make this folder ({error.strerror})", "give another with --out") from None
    if not os.access(path, os.W_OK | os.X_OK):
        raise InputError(str(path), "may not write here", "give another place with --out FOLDER")
    for leftover in (*path.glob(_TEMPORARY), *path.glob(f"*/{_TEMPORARY}")):
        shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink()
    if force:
        return folder, False
    manifest = folder.manifest_document()
    if manifest is None:
        held = [place.name for place in (folder.campaign, folder.scenario, folder.truth.parent) if place.exists()]
        if folder.campaign.exists() and len(held) > 1:
            raise InputError(
                str(folder.manifest),
                f"is missing beside {', '.join(held)}: what run they are of cannot be known",
                "put it back, make the run anew with --force, or keep what is there with --out OTHER_FOLDER",
            )
        if any(path.iterdir()):
            raise InputError(
                str(path), "the folder is not empty and holds no run", "give an empty one with --out, or use --force"
            )
        return folder, False
    if manifest.get("scenario_sha256") != sha256:
        raise InputError(
            str(path),
            f"holds a run of another scenario (or another seed or engine): {manifest.get('scenario')}",
            "keep both with --out OTHER_FOLDER, or replace it with --force",
        )
    return folder, _campaign_is_whole(folder, manifest)


def _campaign_is_whole(folder: RunFolder, manifest: dict[str, Any]) -> bool:
    from vgvt.files.manifest import file_sha256

    files = manifest.get("files", {})
    names = [path.relative_to(folder.path).as_posix() for path in (folder.campaign, folder.truth)]
    return all(
        (folder.path / name).is_file()
        and isinstance(files.get(name), dict)
        and files[name].get("sha256") == file_sha256(folder.path / name)
        for name in names
    )
