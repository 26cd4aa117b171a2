"""Thresholds from placebos: campaigns in which nothing is missing, taken through the whole loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.stats

from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.reconcile.thresholds import Thresholds
from vgvt.reconcile.verdict import Verdict

_FEWEST = 5
_SET_NATS = 5.0
_UNDER_A_NAME = 1.0
# Where noise alone is left, and its size is known exactly, 1 is left: no limit may be near that.
_NOISE_ALONE = 1.2


@dataclass(frozen=True, slots=True)
class Placebo:
    """What one campaign without any missing effect came to; ``best_nats`` is the best candidate's tempered gain.

    ``held_out_per_dof`` is None where nothing was held out.
    """

    chi2_per_dof: float
    smooth_per_dof: float
    held_out_per_dof: float | None
    best_nats: float

    @classmethod
    def of(cls, verdict: Verdict) -> Placebo:
        """The figures of a verdict on a campaign in which nothing is missing, whatever it says."""
        found = verdict.attribution
        rivals = found.rounds[0].rivals if found.rounds else found.last_rivals
        null = found.null_residual
        best = max((r.gain_nats for r in rivals), default=0.0)
        return cls(null.train_chi2_per_dof, null.smooth_per_dof, null.held_out_chi2_per_dof, best)


def calibrated_thresholds(placebos: Sequence[Placebo], made_by: str, *, level: float = 0.98) -> Thresholds:
    """Limits that the next placebo stays below with a probability ``level``, each on its own; none below what was seen.

    One-sided prediction limits of the normal distribution (Hahn, Technometrics 11, 1969): wide where placebos are
    few. Limits on what is left are at least 1.2. ``made_by`` (scenario, noise, version, command) goes into the
    provenance with their number. InputError for fewer than five.
    """
    if len(placebos) < _FEWEST:
        raise InputError("placebos", f"{len(placebos)} are too few for a threshold", f"Run at least {_FEWEST}.")
    held = [p.held_out_per_dof for p in placebos if p.held_out_per_dof is not None]
    chi2 = _limit([p.chi2_per_dof for p in placebos], level)
    return Thresholds(
        max(_NOISE_ALONE, chi2), max(_NOISE_ALONE, _limit([p.smooth_per_dof for p in placebos], level)),
        max(_NOISE_ALONE, _limit(held, level) if len(held) >= _FEWEST else chi2),
        # Gains of nothing are often negative: a name needs more than that.
        max(_UNDER_A_NAME, _limit([p.best_nats for p in placebos], level)), _SET_NATS,
        f"{len(placebos)} campaigns without any missing effect, one-sided {level:.0%} prediction limits; {made_by}",
    )  # fmt: skip


def write_thresholds(path: Path, thresholds: Thresholds) -> None:
    """Write thresholds as TOML, as ``thresholds_of`` reads them."""
    numbers = ("chi2_per_dof", "smooth_per_dof", "held_out_per_dof", "evidence_nats", "set_nats")
    lines = [f"{name} = {getattr(thresholds, name):.4g}" for name in numbers]
    said = thresholds.provenance.replace("\\", "/").replace('"', "'").replace("\n", " ")
    with replacing(path) as part:
        part.write_text("\n".join([*lines, f'provenance = "{said}"', ""]), encoding="utf-8")


def _limit(values: Sequence[float], level: float) -> float:
    seen = np.asarray(values, dtype=float)
    count = seen.size
    reach = float(scipy.stats.t.ppf(level, count - 1)) * np.sqrt(1 + 1 / count)
    return float(max(seen.mean() + reach * seen.std(ddof=1), seen.max()))
