"""The regression guard: which method got better or worse than a baseline, beyond the scatter of the seeds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vgvt.bench.rows import FAILED
from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.view.columns import root_mean_square

if TYPE_CHECKING:
    import pandas

KEYS = ("scenario", "seed_number", "seed", "entry")
COUNTS = (FAILED, "missed", "false")
ERRORS = ("frequency_error_percent", "damping_error_percent", "shape_error")
SIGNIFICANCE = 0.05
"""Chance of any false alarm in a comparison, over all scenarios, entries and measures (Holm's correction)."""
LEAST_RATIO = 1.05
"""A change of an error by less than this factor is too small to speak of, however sure."""
LEAST_COUNT = 0.02
"""Likewise for modes per campaign."""
_SMALLEST = 1e-9  # percent, or 1 - MAC: below it an error is round-off


def digest(table: pandas.DataFrame) -> pandas.DataFrame:
    """The long table as one row per campaign and entry: what a baseline keeps.

    Errors are root-mean-squares over the found modes, in percent; ``shape_error`` is the largest 1 - MAC.
    NaN where nothing was found.
    """
    import pandas

    rows = []
    for key, part in table.groupby(list(KEYS), sort=True):
        found = part[part["status"] == "found"]
        rows.append(
            dict(zip(KEYS, key, strict=True))
            | {
                FAILED: int((part["outcome"] == FAILED).any()),
                "missed": int((part["status"] == "missed").sum()),
                "false": int((part["status"] == "false").sum()),
                "frequency_error_percent": root_mean_square(found["frequency_error_percent"]),
                "damping_error_percent": root_mean_square(found["damping_error_percent"]),
                "shape_error": 1 - float(found["mac"].min()) if len(found) else np.nan,
            }
        )
    return pandas.DataFrame(rows, columns=[*KEYS, *COUNTS, *ERRORS])


def write_baseline(path: Path, table: pandas.DataFrame) -> None:
    """Write the digest of a table as CSV with six significant digits: small enough to be reviewed as text."""
    with replacing(path) as temporary:
        digest(table).to_csv(temporary, index=False, float_format="%.6g", lineterminator="\n")


def read_baseline(path: Path) -> pandas.DataFrame:
    """A baseline; InputError for a missing, damaged or foreign file."""
    import pandas

    if not path.is_file():
        raise InputError(str(path), "no such baseline", "write one with: vgvt bench --baseline FILE")
    try:
        frame = pandas.read_csv(path)
    except (ValueError, pandas.errors.ParserError) as error:
        raise InputError(str(path), f"cannot be read: {error}", "restore it, or write it again") from error
    missing = [name for name in (*KEYS, *COUNTS, *ERRORS) if name not in frame.columns]
    if missing:
        raise InputError(str(path), f"has no column {', '.join(missing)}", "write it with: vgvt bench --baseline FILE")
    return frame


def compare(baseline: pandas.DataFrame, table: pandas.DataFrame) -> pandas.DataFrame:
    """Every measure of every entry on every scenario, paired by seed: number and value, so by campaign.

    Columns: scenario, entry, measure, ``pairs`` (seeds that both have), ``before`` and ``after`` (means; of errors
    geometric), ``effect_size`` (mean over standard deviation of the paired differences, of logarithms for errors),
    ``p_value`` (two-sided paired t-test) and ``verdict``: worse, better, same, or no pairs. A verdict needs p to
    pass Holm's correction at 5 % and a change of at least 5 % in an error, or 0.02 modes a campaign in a count.
    ``failed`` is not tested, and has neither effect size nor p: the records are the same before and after, so that no
    scatter makes a campaign fail. One that fails now and did not is worse, whatever the others did, and were it
    for want of time: a method that hangs is not to be told from a busy machine. What failed on either side has no
    pair in the other measures.
    An entry that came to the very same on a scenario cannot raise an alarm and costs the others no confidence.
    InputError when baseline and table share no campaign.
    """
    import pandas

    both = baseline.merge(digest(table), on=list(KEYS), suffixes=("_before", "_after"))
    if both.empty:
        raise InputError(
            "--against",
            "the baseline and this bench share no campaign",
            "bench the baseline's scenarios, seeds and entries",
        )
    rows = [
        {"scenario": scenario, "entry": entry, "measure": measure}
        | (_failures(part) if measure == FAILED else _change(part, measure))
        for (scenario, entry), part in both.groupby(["scenario", "entry"], sort=True)
        for measure in (*COUNTS, *ERRORS)
    ]
    frame = pandas.DataFrame(rows)
    frame["verdict"] = _verdicts(frame)
    return frame


def _failures(part: pandas.DataFrame) -> dict[str, Any]:
    """Who came to no claim, campaign by campaign; the verdict is known without a test."""
    before, after = (part[f"{FAILED}_{side}"].to_numpy(dtype=float) for side in ("before", "after"))
    verdict = "worse" if (after > before).any() else "better" if (after < before).any() else "same"
    return {
        "pairs": before.size,
        "before": float(before.mean()),
        "after": float(after.mean()),
        "effect_size": np.nan,
        "p_value": np.nan,
        "verdict": verdict,
    }


def _change(part: pandas.DataFrame, measure: str) -> dict[str, Any]:
    before, after = (part[f"{measure}_{side}"].to_numpy(dtype=float) for side in ("before", "after"))
    # Without a claim nothing is missed and nothing is false: that is no better than what is.
    claimed = (part[f"{FAILED}_before"] == 0) & (part[f"{FAILED}_after"] == 0)
    paired = np.isfinite(before) & np.isfinite(after) & claimed.to_numpy()
    before, after = before[paired], after[paired]
    if not before.size:
        return {"pairs": 0, "before": np.nan, "after": np.nan, "effect_size": np.nan, "p_value": np.nan}
    if measure in ERRORS:
        before, after = np.log(np.maximum(before, _SMALLEST)), np.log(np.maximum(after, _SMALLEST))
    effect, p_value = _paired(after - before)
    back = np.exp if measure in ERRORS else np.asarray
    return {
        "pairs": before.size,
        "before": float(back(before.mean())),
        "after": float(back(after.mean())),
        "effect_size": effect,
        "p_value": p_value,
    }


def _paired(difference: NDArray[np.float64]) -> tuple[float, float]:
    """Effect size and two-sided p of a paired t-test; differences that are all the same are certain, or nothing."""
    from scipy.stats import t

    n, mean = difference.size, float(difference.mean())
    spread = float(difference.std(ddof=1)) if n > 1 else np.nan
    # A baseline keeps six digits: smaller differences are those of its text.
    if np.abs(difference).max() < 1e-5:
        return 0.0, 1.0
    if n < 2:
        return np.nan, np.nan
    if spread <= 1e-12 * abs(mean):
        return float(np.sign(mean) * np.inf), 0.0
    effect = mean / spread
    return effect, float(2 * t.sf(abs(effect) * np.sqrt(n), n - 1))


def _verdicts(frame: pandas.DataFrame) -> list[str]:
    p = frame["p_value"].to_numpy(dtype=float)
    moved = frame["p_value"].lt(1.0).groupby([frame["scenario"], frame["entry"]]).transform("any").to_numpy()
    tested = np.flatnonzero(np.isfinite(p) & moved)
    sure = np.zeros(p.size, dtype=bool)
    # Holm: the smallest p against level / m, the next against level / (m - 1), until one fails.
    for rank, k in enumerate(tested[np.argsort(p[tested], kind="stable")]):
        if p[k] > SIGNIFICANCE / (tested.size - rank):
            break
        sure[k] = True
    return [_verdict(row, bool(sure[k])) for k, (_, row) in enumerate(frame.iterrows())]


def _verdict(row: pandas.Series, sure: bool) -> str:
    if row["measure"] == FAILED:
        return str(row["verdict"])
    if not row["pairs"]:
        return "no pairs"
    before, after = float(row["before"]), float(row["after"])
    if row["measure"] in ERRORS:
        large = max(before, after) >= LEAST_RATIO * min(before, after)
    else:
        large = abs(after - before) >= LEAST_COUNT
    if not (sure and large):
        return "same"
    return "worse" if after > before else "better"
