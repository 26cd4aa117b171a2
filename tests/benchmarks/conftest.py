"""Benchmarks run only when asked for: `pytest tests/benchmarks --benchmark-only`."""

from __future__ import annotations

from pathlib import Path

import pytest

_HERE = Path(__file__).parent


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Measure in this process: how tests would be shared out, if they were, makes pytest-benchmark refuse."""
    if not config.getoption("numprocesses", None):
        config.option.dist = "no"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave benchmarks out of ordinary runs."""
    if config.getoption("benchmark_only"):
        return
    skip = pytest.mark.skip(reason="a benchmark: run `pytest tests/benchmarks --benchmark-only`")
    for item in items:
        if _HERE in item.path.parents:
            item.add_marker(skip)
