"""The table of a sweep: the bench's long table with the swept keys as columns in front."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.bench.rows import COLUMNS
from vgvt.files.atomically import replacing
from vgvt.scenario.sweeps import Variant

if TYPE_CHECKING:
    import pandas


def with_swept_columns(table: pandas.DataFrame, variants: Sequence[Variant]) -> pandas.DataFrame:
    """The table with a column for every swept key, whose value depends on the row's scenario."""
    values = {variant.scenario.name: variant.values for variant in variants}
    keys = list(variants[0].values)
    columns = {key: [_cell(values[name][key]) for name in table["scenario"]] for key in keys}
    wide = table.copy()
    for place, key in enumerate(keys):
        wide.insert(place + 1, key, columns[key])
    return wide


def write_swept_parquet(path: Path, table: pandas.DataFrame) -> None:
    """Write a sweep's table as Parquet, whole or not at all."""
    import duckdb

    columns = ", ".join(
        f'CAST("{name}" AS {COLUMNS[name]}) AS "{name}"' if name in COLUMNS else f'"{name}"' for name in table.columns
    )
    with replacing(path) as temporary, duckdb.connect() as connection:
        connection.register("swept", table)
        target = str(temporary).replace("'", "''")
        connection.execute(f"COPY (SELECT {columns} FROM swept) TO '{target}' (FORMAT parquet)")


def _cell(value: Any) -> Any:
    """A swept value as a table's cell: lists as text."""
    return str(value) if isinstance(value, (list, dict)) else value
