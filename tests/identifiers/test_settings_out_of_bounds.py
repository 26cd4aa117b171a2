"""A setting that no method could use is refused when the method is made, in words, and not deep within numpy."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError, Outcome
from vgvt.identification import available_identifiers, make_identifier, run_identifier, settings_of
from vgvt.identification.example import Example
from vgvt_identifiers.era_dc import EraDc
from vgvt_identifiers.too_few import TooFewError

NUMERIC = ("int", "float")
BUNDLED = {n: cls for n, cls in available_identifiers().items() if cls.__module__.startswith("vgvt_identifiers")}
NUMBERS = [(name, s.name, s.type) for name, cls in BUNDLED.items() for s in settings_of(cls) if s.type in NUMERIC]


@pytest.mark.parametrize(("method", "setting", "kind"), NUMBERS)
def test_every_number_has_bounds(method: str, setting: str, kind: str) -> None:
    for value in ("-1", "1" + 30 * "0", *(("nan", "inf") if kind == "float" else ())):
        with pytest.raises(InputError, match=rf"{method}: {setting} = .*\n +give \S+ to \S+"):
            make_identifier(method, **{setting: value})


def test_there_is_something_to_bound() -> None:
    assert ("era-dc", "lag", "int") in NUMBERS and len(NUMBERS) > 60


@pytest.mark.parametrize("setting", ["block_rows", "block_columns", "lag"])
def test_correlations_of_none_are_refused(setting: str) -> None:
    with pytest.raises(InputError, match=rf"{setting} = 0\n +give 1 to "):
        make_identifier("era-dc", **{setting: 0})


@pytest.mark.parametrize(
    ("change", "fewest"), [({"columns": 575}, 618), ({"lag": 138}, 605), ({"block_rows": 57}, 623)]
)
def test_correlations_that_the_samples_cannot_fill_are_refused(change: dict[str, int], fewest: int) -> None:
    """The bound is where they just fill two rows: so many samples will do, one fewer will not."""
    with pytest.raises(InputError, match=rf"samples = 601 cannot fill .*\n +give {fewest} or more"):
        make_identifier("era-dc", **change)
    method = make_identifier("era-dc", samples=fewest, order=2, highest_order=4, **change)
    assert isinstance(method, EraDc)
    impulse = np.random.default_rng(1).standard_normal((1, fewest))
    assert method.model(impulse, 2).rows == 2
    with pytest.raises(TooFewError):
        method.model(impulse[:, 1:], 2)


@pytest.mark.parametrize("method", ["era", "era-dc"])
def test_records_too_short_for_the_matrix_are_told_to_be(method: str) -> None:
    short = Example(stations=1, duration_s=1.0, sweep_s=1.0, noise_m_s2=1e-3).campaign()
    claim = run_identifier(make_identifier(method), short)
    assert claim.outcome is Outcome.NOTHING_FOUND
    assert any("samples cannot fill" in line and "measure longer" in line for line in claim.advice)
