"""Benchmarks run only when asked for: `pytest tests/benchmarks --benchmark-only`."""

from __future__ import annotations

from pathlib import Path

import pytest

_HERE = Path(__file__).parent


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave benchmarks out of ordinary runs."""
    if config.getoption("benchmark_only"):
        return
    skip = pytest.mark.skip(reason="a benchmark: run `pytest tests/benchmarks --benchmark-only`")
    for item in items:
        if _HERE in item.path.parents:
            item.add_marker(skip)
