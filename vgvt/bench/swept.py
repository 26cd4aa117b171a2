"""What a sweep makes of the bench: which keys it may change, and the long table with them as columns in front."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.bench.rows import COLUMNS
from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.scenario.sweeps import Variant, key_steps

if TYPE_CHECKING:
    import pandas


def require_free(keys: Sequence[str], engine: str | None) -> None:
    """InputError for a key that the bench itself sets in every campaign, or that its engine does not read.

    ``engine`` None leaves each scenario its own, as in ``BenchPlan``.
    """
    for key in keys:
        match key_steps(key):
            case ["seed"]:
                raise InputError(
                    f"--set {key}",
                    "the seed of every campaign is derived from --seed and the variant",
                    "write --seeds N for N campaigns of each variant",
                )
            case ["simulation", "engine"] if engine is not None:
                raise InputError(
                    f"--set {key}",
                    f"--engine {engine} simulates all variants",
                    "write --engine own to sweep it",
                )
            case ["simulation", "step_s"] if engine == "linear":
                raise InputError(
                    f"--set {key}", "--engine linear takes no steps", "write --engine mujoco to sweep the step"
                )


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
