"""The regression guard: it sees what is beyond the seeds' scatter, and nothing else."""

from __future__ import annotations

import numpy as np
import pandas
import pytest

from vgvt.bench.entry import Entry
from vgvt.bench.guard import compare, digest, read_baseline, write_baseline
from vgvt.bench.rows import failure_row
from vgvt.bench.table import table_of
from vgvt.data import InputError


def long_table(
    generator: np.random.Generator, seeds: int, error_scale: float = 1.0, miss: bool = False, entries=("era", "cfdd")
):
    """A table of two scenarios, two modes each, with Gaussian errors."""
    rows = []
    for scenario in ("a", "b"):
        for entry in entries:
            for number in range(seeds):
                for mode in range(2):
                    missed = miss and mode == 1 and number % 2 == 0
                    error = error_scale * generator.standard_normal()
                    rows.append(
                        {
                            "scenario": scenario,
                            "seed_number": number,
                            "seed": number,
                            "entry": entry,
                            "identifier": entry,
                            "outcome": "found",
                            "mode": mode,
                            "status": "missed" if missed else "found",
                            "true_hz": 10.0,
                            "claimed_hz": None if missed else 10 + error / 10,
                            "frequency_error_percent": None if missed else error,
                            "damping_error_percent": None if missed else 5 * generator.standard_normal(),
                            "mac": None if missed else 0.99,
                        }
                    )
    return table_of(rows)


def test_the_same_table_is_the_same(tmp_path) -> None:
    table = long_table(np.random.default_rng(1), 6)
    write_baseline(tmp_path / "b.csv", table)
    comparison = compare(read_baseline(tmp_path / "b.csv"), table)
    assert set(comparison["verdict"]) == {"same"}


def test_an_error_twice_as_large_is_worse_and_half_is_better() -> None:
    before = long_table(np.random.default_rng(2), 12)
    after = long_table(np.random.default_rng(2), 12, error_scale=2.0)
    worse = compare(digest(before), after)
    assert set(worse[worse["measure"] == "frequency_error_percent"]["verdict"]) == {"worse"}
    assert set(worse[worse["measure"] != "frequency_error_percent"]["verdict"]) == {"same"}
    better = compare(digest(after), before)
    assert set(better[better["measure"] == "frequency_error_percent"]["verdict"]) == {"better"}


def test_other_noise_is_no_regression_more_often_than_promised() -> None:
    """Two benches of the same method with fresh noise: false alarms over the whole comparison stay near 5 %."""
    generator = np.random.default_rng(3)
    alarms = 0
    for _ in range(60):
        comparison = compare(
            digest(long_table(generator, 8, entries=("era",))), long_table(generator, 8, entries=("era",))
        )
        alarms += bool(comparison["verdict"].isin(["worse", "better"]).any())
    # Binomial(60, 0.05) exceeds 8 once in 500; the t-test on logarithms of few errors is not exactly calibrated.
    assert alarms <= 8


def test_a_mode_lost_in_half_of_the_seeds_is_worse() -> None:
    before = long_table(np.random.default_rng(4), 20)
    after = long_table(np.random.default_rng(4), 20, miss=True)
    comparison = compare(digest(before), after)
    missed = comparison[comparison["measure"] == "missed"]
    assert set(missed["verdict"]) == {"worse"}
    assert missed["after"].iloc[0] == pytest.approx(0.5)


def crashed(table: pandas.DataFrame, seeds: set[int], reason: str = "crashed: KeyError: 'x'") -> pandas.DataFrame:
    """The table with the first entry of the first scenario failed on some seeds, as the bench writes it."""
    hit = (table["scenario"] == "a") & (table["entry"] == "era") & table["seed_number"].isin(seeds)
    heads = table[hit].drop_duplicates("seed_number").to_dict("records")
    rows = [
        failure_row({k: row[k] for k in ("scenario", "seed_number", "seed")}, Entry("era"), reason) for row in heads
    ]
    return table_of(table[~hit].to_dict("records") + rows)


def verdicts(before: pandas.DataFrame, after: pandas.DataFrame) -> dict[str, str]:
    """What is said of the measures of that entry there; everything else stayed the same."""
    comparison = compare(digest(before), after)
    here = (comparison["scenario"] == "a") & (comparison["entry"] == "era")
    assert set(comparison[~here]["verdict"]) <= {"same"}
    return dict(zip(comparison[here]["measure"], comparison[here]["verdict"], strict=True))


@pytest.mark.parametrize("reason", ["crashed: KeyError: 'x'", "took more than 60 s"])
@pytest.mark.parametrize("seeds", [{3}, {0, 1, 2, 3}])
def test_a_single_campaign_that_newly_fails_is_worse(seeds: set[int], reason: str) -> None:
    """The records are the same: there is no scatter that a test would have to see past."""
    table = long_table(np.random.default_rng(11), 5)
    said = verdicts(table, crashed(table, seeds, reason))
    assert said.pop("failed") == "worse"
    assert set(said.values()) == {"same"}
    assert verdicts(crashed(table, seeds), table)["failed"] == "better"


def test_a_crash_mended_makes_up_for_no_new_one() -> None:
    table = long_table(np.random.default_rng(12), 6)
    assert verdicts(crashed(table, {0, 1}), crashed(table, {5}))["failed"] == "worse"
    assert verdicts(crashed(table, {0, 1}), crashed(table, {0, 1}))["failed"] == "same"


def test_a_campaign_without_a_claim_misses_nothing_and_is_no_better_for_it() -> None:
    """All modes are missed on every other seed; a method that crashes there instead has not got better, only worse."""
    table = long_table(np.random.default_rng(13), 20, miss=True)
    missing = set(range(0, 20, 2))
    comparison = compare(digest(table), crashed(table, missing))
    row = comparison.query("scenario == 'a' and entry == 'era' and measure == 'missed'").iloc[0]
    assert (row["pairs"], row["before"], row["after"], row["verdict"]) == (10, 0, 0, "same")
    # Nor is one worse that crashed there and now comes to claims with misses.
    assert verdicts(crashed(table, missing), table)["missed"] == "same"
    assert verdicts(table, crashed(table, set(range(20))))["missed"] == "no pairs"


def test_a_new_entry_is_not_compared() -> None:
    before = long_table(np.random.default_rng(5), 4, entries=("era",))
    after = long_table(np.random.default_rng(5), 4)
    assert set(compare(digest(before), after)["entry"]) == {"era"}


def test_nothing_in_common_is_bad_input() -> None:
    before = long_table(np.random.default_rng(6), 2, entries=("era",))
    after = long_table(np.random.default_rng(6), 2, entries=("cfdd",))
    with pytest.raises(InputError, match="share no campaign"):
        compare(digest(before), after)


def test_a_damaged_baseline_is_named(tmp_path) -> None:
    (tmp_path / "b.csv").write_text("scenario,entry\nquick,era\n")
    with pytest.raises(InputError, match="seed_number"):
        read_baseline(tmp_path / "b.csv")
    with pytest.raises(InputError, match="no such baseline"):
        read_baseline(tmp_path / "none.csv")


def test_a_digest_is_what_one_counts_by_hand() -> None:
    table = long_table(np.random.default_rng(7), 3, miss=True)
    row = digest(table).query("scenario == 'a' and entry == 'era' and seed_number == 0").iloc[0]
    part = table.query("scenario == 'a' and entry == 'era' and seed_number == 0")
    assert (row["missed"], row["false"], row["failed"]) == (1, 0, 0)
    assert row["frequency_error_percent"] == pytest.approx(abs(float(part["frequency_error_percent"].dropna().iloc[0])))
    assert isinstance(digest(table), pandas.DataFrame)


def test_methods_that_did_not_change_cost_no_power() -> None:
    """One entry's errors half as large again, 5 seeds: seen beside twenty entries that came to the very same."""
    names = tuple(f"method-{k}" for k in range(20))
    before = long_table(np.random.default_rng(8), 5, entries=("era", *names))
    after = before.copy()
    era = after["entry"] == "era"
    noise = np.random.default_rng(9).uniform(1.4, 1.6, len(after))
    after.loc[era, "frequency_error_percent"] = (after["frequency_error_percent"] * noise)[era]
    comparison = compare(digest(before), after)
    worse = comparison[comparison["verdict"] == "worse"]
    assert set(worse["entry"]) == {"era"}
    assert len(worse) == 2


def test_other_campaigns_are_no_pairs() -> None:
    before = long_table(np.random.default_rng(10), 3)
    after = before.assign(seed=before["seed"] + 1)
    with pytest.raises(InputError, match="seeds"):
        compare(digest(before), after)
