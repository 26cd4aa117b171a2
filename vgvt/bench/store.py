"""Where a bench keeps what is done: one small file per cell, whole or not there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from vgvt.bench.cell import Row
from vgvt.bench.task import Kept
from vgvt.files.atomically import replacing


class Store:
    """The results in a bench's folder; a cell is known by its key and the fingerprint of the code that did it."""

    def __init__(self, folder: Path, made_by: str) -> None:
        self._cells = folder / "cells"
        self._made_by = made_by

    def _path(self, cell: Kept) -> Path:
        return self._cells / f"{cell.key}.json"

    def rows(self, cell: Kept) -> list[Row] | None:
        """The rows of a cell that was done by the same code; None where it must be done (again)."""
        try:
            document: dict[str, Any] = json.loads(self._path(cell).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        rows = document.get("rows")
        return rows if document.get("made_by") == self._made_by and isinstance(rows, list) else None

    def keep(self, cell: Kept, rows: list[Row]) -> None:
        """Write the rows of a cell down."""
        with replacing(self._path(cell)) as temporary:
            temporary.write_text(json.dumps({"made_by": self._made_by, "title": cell.title, "rows": rows}), "utf-8")
