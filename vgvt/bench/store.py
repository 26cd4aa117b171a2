"""Where a bench keeps what is done: one small file per cell, whole or not there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from vgvt._version import __version__
from vgvt.bench.cell import Cell, Row
from vgvt.files.atomically import replacing


class Store:
    """The results in a bench's folder; a cell is known by its key and the version of vgvt."""

    def __init__(self, folder: Path) -> None:
        self._cells = folder / "cells"

    def _path(self, cell: Cell) -> Path:
        return self._cells / f"{cell.key}.json"

    def rows(self, cell: Cell) -> list[Row] | None:
        """The rows of a cell that was done by this version; None where it must be done (again)."""
        try:
            document: dict[str, Any] = json.loads(self._path(cell).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        rows = document.get("rows")
        return rows if document.get("version") == __version__ and isinstance(rows, list) else None

    def keep(self, cell: Cell, rows: list[Row]) -> None:
        """Write the rows of a cell down."""
        with replacing(self._path(cell)) as temporary:
            temporary.write_text(json.dumps({"version": __version__, "title": cell.title, "rows": rows}), "utf-8")
