"""The long table in a few numbers per scenario and entry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vgvt.view.columns import least, mean, median, root_mean_square

if TYPE_CHECKING:
    import pandas


def summary(table: pandas.DataFrame) -> pandas.DataFrame:
    """One row per scenario and entry: counts per campaign, errors, calibration, efficiency, cost.

    Root-mean-square errors are over found modes and seeds; ``efficiency`` is the root-mean-square of the
    frequency error over the Cramér–Rao bound (1 is the limit, larger is worse); coverage is the share of
    stated 95 % intervals that hold the truth; ``split`` counts the false claims of a mode that another claim has;
    ``frf_fit_percent`` and ``nu_gap`` are medians over the campaigns. What no row states is NaN.
    """
    import pandas

    rows = [
        {"scenario": scenario, "entry": entry} | _numbers(part)
        for (scenario, entry), part in table.groupby(["scenario", "entry"], sort=True)
    ]
    return pandas.DataFrame(rows)


def _numbers(part: pandas.DataFrame) -> dict[str, Any]:
    attempts = part.drop_duplicates("seed_number")
    campaigns = len(attempts)
    found = part[part["status"] == "found"]
    error_hz = (found["claimed_hz"] - found["true_hz"]).astype(float)
    over_bound = error_hz / found["frequency_bound_hz"].astype(float)
    return {
        "campaigns": campaigns,
        "failed": int((attempts["outcome"] == "failed").sum()),
        "found": len(found) / campaigns,
        "missed": int((part["status"] == "missed").sum()) / campaigns,
        "false": int((part["status"] == "false").sum()) / campaigns,
        "split": int((part["split"] == True).sum()) / campaigns,  # noqa: E712  missing is not split
        "rms_frequency_error_percent": root_mean_square(found["frequency_error_percent"]),
        "rms_damping_error_percent": root_mean_square(found["damping_error_percent"]),
        "min_mac": least(found["mac"]),
        "rms_error_over_bound": root_mean_square(over_bound),
        "frequency_coverage": mean(found["frequency_covered"]),
        "damping_coverage": mean(found["damping_covered"]),
        "frf_fit_percent": median(attempts["frf_fit_percent"]),
        "nu_gap": median(attempts["nu_gap"]),
        "wall_s": median(attempts["wall_s"]),
        "peak_memory_mib": median(attempts["peak_memory_mib"]),
    }
