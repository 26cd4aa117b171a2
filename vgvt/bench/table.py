"""The long table on disk: Parquet through duckdb, CSV on request."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.bench.rows import COLUMNS
from vgvt.data import InputError
from vgvt.files.atomically import replacing

if TYPE_CHECKING:
    import pandas

_PANDAS = {"VARCHAR": "string", "BIGINT": "Int64", "DOUBLE": "Float64", "BOOLEAN": "boolean"}


def table_of(rows: Sequence[dict[str, Any]]) -> pandas.DataFrame:
    """The rows as a table with the columns of the bench, in order of scenario, seed, entry and mode."""
    import pandas

    frame = pandas.DataFrame(list(rows), columns=list(COLUMNS))
    frame = _typed(frame)
    return frame.sort_values(["scenario", "seed_number", "entry", "mode"], kind="stable", ignore_index=True)


def write_parquet(path: Path, table: pandas.DataFrame) -> None:
    """Write the table as Parquet, whole or not at all."""
    import duckdb

    with replacing(path) as temporary, duckdb.connect() as connection:
        connection.register("bench", table)
        columns = ", ".join(f'CAST("{name}" AS {kind}) AS "{name}"' for name, kind in COLUMNS.items())
        connection.execute(f"COPY (SELECT {columns} FROM bench) TO '{_quoted(temporary)}' (FORMAT parquet)")


def write_csv(path: Path, table: pandas.DataFrame) -> None:
    """Write the table as CSV with nine significant digits, whole or not at all."""
    with replacing(path) as temporary:
        table.to_csv(temporary, index=False, float_format="%.9g", lineterminator="\n")


def read_table(path: Path) -> pandas.DataFrame:
    """A table written by either; InputError for a missing, damaged or foreign file."""
    import duckdb
    import pandas

    if not path.is_file():
        raise InputError(str(path), "no such file", "make a table with: vgvt bench")
    try:
        if path.suffix == ".csv":
            frame = pandas.read_csv(path)
        else:
            with duckdb.connect() as connection:
                frame = connection.execute(f"SELECT * FROM read_parquet('{_quoted(path)}')").df()
    except (duckdb.Error, ValueError) as error:
        raise InputError(
            str(path), f"cannot be read as a table: {str(error).splitlines()[0]}", "make it again"
        ) from error
    missing = [name for name in ("scenario", "seed_number", "entry", "status") if name not in frame.columns]
    if missing:
        raise InputError(str(path), f"has no column {', '.join(missing)}", "give a table that vgvt bench wrote")
    return _typed(frame)


def _typed(frame: pandas.DataFrame) -> pandas.DataFrame:
    """The columns with their types; a text that is not there is empty, as CSV cannot tell the two apart."""
    typed = frame.astype({name: _PANDAS[kind] for name, kind in COLUMNS.items() if name in frame.columns})
    texts = {name: "" for name, kind in COLUMNS.items() if kind == "VARCHAR" and name in frame.columns}
    return typed.fillna(texts)


def _quoted(path: Path) -> str:
    return str(path).replace("'", "''")
