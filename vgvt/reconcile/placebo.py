"""Thresholds from placebos: campaigns in which nothing is missing, taken through the whole loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import scipy.stats

from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.reconcile.decision.verdict import Verdict
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.thresholds import LIMITS, PLACEBO_FLOOR, Thresholds, noise_share, stored_thresholds

_FEWEST = 5
_SET_NATS = 5.0
_UNDER_A_NAME = 1.0
# Where noise is more of what a campaign is judged by, it hides what the model's form leaves.
_MOST_NOISE = 0.8
# So many of 98 % limits say what the highest of them are like.
_LOWERED_FROM = 100
# Below it the model's form is most of what a campaign is judged by, and has a limit of gains of its own.
_MOSTLY_NOISE = 0.5


@dataclass(frozen=True, slots=True)
class Placebo:
    """What one campaign without any missing effect came to; ``best_nats`` is the gain, by
    the view that grants less, of the best candidate that held-out data did not refuse.

    ``noise_per_dof`` and ``held_out_noise_per_dof`` are the χ² that its noise alone leaves, ``model_form`` the relative
    floor it was judged with. What is held out is None where nothing was; ``strain_sd`` where it was not noted.
    """

    chi2_per_dof: float
    smooth_per_dof: float
    held_out_per_dof: float | None
    best_nats: float
    noise_per_dof: float = 0.0
    held_out_noise_per_dof: float | None = 0.0
    model_form: float = PLACEBO_FLOOR
    strain_sd: float | None = None

    @classmethod
    def of(cls, verdict: Verdict) -> Placebo:
        """The figures of a verdict on a campaign in which nothing is missing, whatever it says."""
        found = verdict.attribution
        named = found.rounds or found.leads
        rivals = named[0].rivals if named else found.last_rivals
        return cls.of_residual(found.null, found.null_residual, best_nats(rivals, found.vetoed))

    @classmethod
    def of_residual(cls, null: Fit, left: Residual, best_nats: float = 0.0) -> Placebo:
        """The figures of a calibration alone, of which no candidate was asked."""
        measured, parts = null.problem.measured, null.problem.split
        return cls(
            left.train_chi2_per_dof, left.smooth_per_dof, left.held_out_chi2_per_dof, best_nats, left.noise_per_dof,
            left.held_out_noise_per_dof, noise_share(measured, parts.train).floor, left.strain_sd,
        )  # fmt: skip


def best_nats(rivals: Sequence[Rival], refused: Sequence[Rival]) -> float:
    """The gain that stands between a placebo and a name: what held-out data refused would not have got one.

    Of both views of the model's own error the one that grants less, as a name needs both.
    """
    asked = (r for r in rivals if not any(r is v for v in refused))
    return max((min(r.gain_nats, r.lasting_nats) for r in asked), default=0.0)


def calibrated_thresholds(
    placebos: Sequence[Placebo], made_by: str, *, level: float = 0.98, where_hidden: Thresholds | None = None
) -> Thresholds:
    """Limits that the next placebo stays below with a probability ``level``, each on its own; none below what was seen.

    One-sided prediction limits of the normal distribution (Hahn, Technometrics 11, 1969): wide where placebos are
    few. What is left counts beyond its noise, relative to a model-form floor of 0.4 %, so that campaigns of other noise
    can use it. ``made_by`` (scenario, noise, version, command) goes into the provenance with the number.
    InputError for fewer than five placebos whose noise does not hide the rest, unless ``where_hidden`` has limits of
    what is left for these, and for fewer than five at all.
    """
    told = [p for p in placebos if p.noise_per_dof < _MOST_NOISE]
    if len(placebos if where_hidden else told) < _FEWEST:
        raise InputError(
            "placebos",
            f"{len(told)} are too few for a threshold (of {len(placebos)}; noise hides the others)",
            f"Run at least {_FEWEST} with less noise.",
        )
    gains = _by_share([(p.best_nats, p.noise_per_dof) for p in placebos], level)
    strains = [(p.strain_sd, p.noise_per_dof) for p in placebos if p.strain_sd is not None]
    return Thresholds(
        *(_of_what_is_left(told, level) if where_hidden is None or len(told) >= _FEWEST else _scaled(where_hidden)),
        # Gains of nothing are often negative: a name needs more than that.
        max(_UNDER_A_NAME, gains[0]), _SET_NATS,
        f"{len(placebos)} campaigns without any missing effect, one-sided {level:.0%} prediction limits; {made_by}",
        PLACEBO_FLOOR, gains[1], *(_by_share(strains, level) if len(strains) >= _FEWEST else ()),
    )  # fmt: skip


def own_thresholds(placebos: Sequence[Placebo], made_by: str, *, level: float = 0.98) -> Thresholds:
    """Limits of one's own test: those of its ``placebos``, but from fewer than a hundred none below the stored ones.

    A few do not know how high the highest of a hundred comes: of 51 that were made together 50 gained at most 1.5 nats,
    and one 11.3. Where noise hides what is left, its limits are the stored ones. InputError for fewer than five.
    """
    stored = stored_thresholds()
    own = calibrated_thresholds(placebos, made_by, level=level, where_hidden=stored)
    if len(placebos) >= _LOWERED_FROM:
        return own
    higher = {name: max(getattr(own, name), getattr(stored, name)) for name in LIMITS}
    return replace(own, **higher, provenance=f"{own.provenance}; none below those that are shipped")


def _of_what_is_left(told: Sequence[Placebo], level: float) -> tuple[float, float, float]:
    """Limits of χ² per degree of freedom beyond noise: of the fit, of its smooth part and of held-out data."""
    unit = PLACEBO_FLOOR
    chi2 = [_beyond(p.chi2_per_dof, p.noise_per_dof, p.model_form / unit) for p in told]
    smooth = [_beyond(p.smooth_per_dof, p.noise_per_dof, p.model_form / unit) for p in told]
    held = [
        _beyond(p.held_out_per_dof, p.held_out_noise_per_dof, p.model_form / unit)
        for p in told
        if p.held_out_per_dof is not None and p.held_out_noise_per_dof is not None
    ]
    lowest = (_limit(seen, level) for seen in (chi2, smooth, held if len(held) >= _FEWEST else chi2))
    fitted, summed, held_out = (max(0.0, limit) for limit in lowest)
    return fitted, summed, held_out


def _scaled(limits: Thresholds) -> tuple[float, float, float]:
    """The same three of other limits, relative to the floor that placebos' refer to."""
    share = (limits.model_form / PLACEBO_FLOOR) ** 2
    return limits.chi2_per_dof * share, limits.smooth_per_dof * share, limits.held_out_per_dof * share


def _by_share(seen: Sequence[tuple[float, float]], level: float) -> tuple[float, float]:
    """Limits of figures that come each with a share of noise: where that is most, and where model form is all."""
    noisy = [value for value, noise in seen if noise >= _MOSTLY_NOISE]
    formed = [value / np.sqrt(1 - noise) for value, noise in seen if noise < _MOSTLY_NOISE]
    of_noise = _limit_above(noisy if len(noisy) >= _FEWEST else [value for value, _ in seen], level)
    return of_noise, max(0.0, _limit_above(formed, level)) if len(formed) >= _FEWEST else 0.0


def _beyond(left: float, noise: float, floors: float) -> float:
    """What is left beyond noise, over what one floor would leave if it were all; ``floors`` is that of the campaign."""
    return (left - noise) / (1 - noise) * floors**2


def write_thresholds(path: Path, thresholds: Thresholds) -> None:
    """Write thresholds as TOML, as ``thresholds_of`` reads them."""
    numbers = (f.name for f in fields(Thresholds) if f.name != "provenance")
    lines = [f"{name} = {getattr(thresholds, name):.4g}" for name in numbers]
    said = thresholds.provenance.replace("\\", "/").replace('"', "'").replace("\n", " ")
    with replacing(path) as part:
        part.write_text("\n".join([*lines, f'provenance = "{said}"', ""]), encoding="utf-8")


def _limit_above(values: Sequence[float], level: float) -> float:
    """:func:`_limit` from the upper half and its mirror image: some fits end far below, which says nothing of above."""
    seen = np.asarray(values, dtype=float)
    middle = float(np.median(seen))
    above = seen[seen > middle] - middle
    spread = np.sqrt(np.mean(above**2)) if above.size else 0.0
    count = max(above.size, 2)
    reach = float(scipy.stats.t.ppf(level, count - 1)) * np.sqrt(1 + 1 / count)
    return float(max(middle + reach * spread, seen.max()))


def _limit(values: Sequence[float], level: float) -> float:
    seen = np.asarray(values, dtype=float)
    count = seen.size
    reach = float(scipy.stats.t.ppf(level, count - 1)) * np.sqrt(1 + 1 / count)
    return float(max(seen.mean() + reach * seen.std(ddof=1), seen.max()))
