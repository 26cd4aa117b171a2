"""Fetch measured records from the public repository that holds them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from http.client import HTTPException
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.parse import quote
from urllib.request import Request, urlopen

from vgvt._version import __version__
from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.files.locate import default_data_folder
from vgvt.files.manifest import file_sha256
from vgvt.files.open import shipped_sidecar
from vgvt.files.sidecar import RunRow, Sidecar
from vgvt.files.sidecar_records import Source
from vgvt.files.strict import load_table

Progress = Callable[[float, str], None]

_TIMEOUT_S = 30.0
_ATTEMPTS = 3
_BLOCK_BYTES = 1 << 16


class DownloadError(OSError):
    """A download that did not succeed although nothing was wrong with what was asked for."""


def fetch_measured(name: str, target: str | Path | None = None, progress: Progress | None = None) -> Path:
    """Fetch the records of a measured campaign; returns the folder of the data set.

    ``target`` is the folder that will contain the data set (left out: VGVT_DATA
    or the user's data folder). Files that are there with the right SHA-256 are
    kept, so that a broken download can be taken up again. ``progress(fraction, message)``.
    InputError for a name that is not known or has no public source; DownloadError when the network fails.
    """
    return fetch_described(shipped_sidecar(name), target, progress)


def fetch_described(sidecar_path: Path, target: str | Path | None = None, progress: Progress | None = None) -> Path:
    """Fetch the records that a sidecar with a [source] describes, like ``fetch_measured``."""
    sidecar = load_table(sidecar_path, Sidecar)
    source, base = sidecar.source, default_data_folder() if target is None else Path(target)
    if source is None:
        raise InputError(
            str(sidecar_path),
            f"{sidecar.name} has no public source",
            "it is a copy made from other records; fetch those, or ask for the file where you got the sidecar",
        )
    dataset = base / (sidecar.records.dataset or sidecar.name)
    runs = {run.file: run for run in sidecar.run}
    for done, run in enumerate(runs.values()):
        if progress is not None:
            progress(done / len(runs), run.file)
        _fetch_one(source, run, dataset / sidecar.records.folder / run.file)
    if source.licence_text:
        with replacing(dataset / "LICENSE") as temporary:
            temporary.write_text(source.licence_text, encoding="utf-8")
    if progress is not None:
        progress(1.0, f"{len(runs)} files in {dataset}")
    return dataset


def _fetch_one(source: Source, run: RunRow, path: Path) -> None:
    if run.sha256 is None:
        raise InputError(run.file, "the sidecar gives no SHA-256", "add sha256 to the run: a download must be checked")
    if path.is_file() and file_sha256(path) == run.sha256:
        return
    url = source.url(quote(run.file))
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            _download(url, path, run.sha256)
            return
        except HTTPError as error:
            error.close()
            if error.code < 500 or attempt == _ATTEMPTS:
                raise DownloadError(f"{url}: the server answered {error.code} {error.reason}") from error
        except _TransferError as error:
            if attempt == _ATTEMPTS:
                raise DownloadError(f"{url}: {error} ({attempt} attempts); run the command again to go on") from error


class _TransferError(Exception):
    """A transfer that may succeed the next time."""


def _download(url: str, path: Path, sha256: str) -> None:
    """Stream a file into place; its name appears only when its hash is right."""
    request = Request(url, headers={"User-Agent": f"vgvt/{__version__}"})
    digest = hashlib.sha256()
    with replacing(path) as temporary:
        try:
            with urlopen(request, timeout=_TIMEOUT_S) as answer, temporary.open("wb") as stream:
                expected = answer.headers.get("Content-Length")
                received = 0
                while block := answer.read(_BLOCK_BYTES):
                    stream.write(block)
                    digest.update(block)
                    received += len(block)
        except HTTPError:
            raise
        except (URLError, HTTPException, TimeoutError, ConnectionError) as error:
            reason = getattr(error, "reason", None) or error
            raise _TransferError(f"the connection failed: {reason}") from error
        if expected is not None and received < int(expected):
            raise _TransferError(f"the connection was cut after {received} of {expected} bytes")
        if digest.hexdigest() != sha256:
            raise _TransferError(f"what came ({received} bytes) does not have the SHA-256 {sha256[:12]}...")
