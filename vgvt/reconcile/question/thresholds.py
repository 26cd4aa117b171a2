"""Where 'adequate' ends and a name begins: what campaigns without any effect leave, carried over to the one at hand."""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.shown import headed
from vgvt.data.suggestion import choose_one_of
from vgvt.files.toml_syntax import parsed_toml
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.holdout import Split

if TYPE_CHECKING:
    from vgvt.reconcile.question.problem import Problem

SMOOTHED = 5
"""Neighbouring lines whose sum is the smooth part of a residual."""
PLACEBO_FLOOR = 0.004
"""Relative model-form floor that limits refer to."""
FAR_OFF = 4.0
"""More than this many times what campaigns leave in which nothing is missing, and a model is none of the data."""
_STORED = Path(__file__).with_name("thresholds.toml")
_MADE_BY = "vgvt reconcile --scenario SCENARIO --placebos N"
# How well a campaign's noise is known on average, and the normal deviate that 98 of 100 stay below. Of the 376 placebos
# of the study at 1 and 3 % noise none left 3 % more than that noise, what it fluctuates by and the form's share.
_NOISE_KNOWN, _DEVIATE = 0.03, 2.054


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Limits that campaigns without any missing effect stay below; ``provenance`` says which.

    χ² per degree of freedom of the fit, of its smooth part and of held-out data *beyond noise*: where a campaign had
    no noise, and a model-form floor of ``model_form`` were all that it is judged by. ``limits_for`` makes them those
    of a campaign. ``evidence_nats`` is the largest gain of evidence that an effect that is not there reaches where
    noise is most of what is judged by; ``evidence_form_nats`` where a model-form floor is all, which lasts from line to
    line and from channel to channel; ``set_nats`` is how near candidates count as equal.
    ``strain_sd`` and ``strain_form_sd`` are the same pair for how far all that is uncertain is taken together
    (:mod:`vgvt.reconcile.evidence.strain`).
    """

    chi2_per_dof: float
    smooth_per_dof: float
    held_out_per_dof: float
    evidence_nats: float
    set_nats: float
    provenance: str
    model_form: float = PLACEBO_FLOOR
    evidence_form_nats: float = 0.0
    strain_sd: float = 4.0
    strain_form_sd: float = 0.0

    def __repr__(self) -> str:
        chi2 = f"χ² per degree of freedom {self.chi2_per_dof:.3g} beyond noise, {self.smooth_per_dof:.3g} smooth"
        name = f"a name needs {self.evidence_nats:.3g} nats, {self.evidence_form_nats:.3g} without noise"
        return headed(f"Thresholds: {chi2}, {self.held_out_per_dof:.3g} held out; {name}", [self.provenance])

    def at(self, share: NoiseShare) -> Thresholds:
        """These thresholds with the ``evidence_nats`` of a campaign of that share of noise.

        What a model's form has wrong is imitated in proportion to its size, the root of its share.
        """
        return replace(self, evidence_nats=max(self.evidence_nats, self.evidence_form_nats * share.form_size))


LIMITS = (
    "chi2_per_dof", "smooth_per_dof", "held_out_per_dof", "evidence_nats", "evidence_form_nats", "strain_sd",
    "strain_form_sd",
)  # fmt: skip
"""The fields of :class:`Thresholds` that a campaign in which nothing is missing stays below."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of χ² per degree of freedom for one campaign: of the fit, of its smooth part and of held-out data.

    And of how far all that is uncertain may be taken together.
    """

    chi2_per_dof: float
    smooth_per_dof: float
    held_out_per_dof: float
    strain_sd: float

    def met_by(self, fitted: float, held_out: float | None) -> bool:
        """Whether χ² per degree of freedom is no more than campaigns leave in which nothing is missing."""
        return fitted <= self.chi2_per_dof and (held_out or 0.0) <= self.held_out_per_dof

    def far_off(self, fitted: float, held_out: float | None) -> bool:
        """Whether χ² per degree of freedom is far beyond: of several wrong models one is always the best."""
        return fitted > FAR_OFF * self.chi2_per_dof or (held_out or 0.0) > FAR_OFF * self.held_out_per_dof


@dataclass(frozen=True, slots=True)
class NoiseShare:
    """Share of sigma² that is noise, on average: what a model that is right leaves of χ² per degree of freedom.

    ``values`` is the number of real numbers that it is the mean of, ``floor`` the relative model-form floor.
    """

    noise: float
    values: int
    floor: float

    @property
    def form_size(self) -> float:
        """Size of an error of the model's form relative to what a campaign is judged by."""
        return math.sqrt(max(0.0, 1 - self.noise))

    @property
    def worth(self) -> float:
        """Independent values a line is worth: noise is new on every line, an error of the model's form is not.

        Such an error lasts for some lines; an effect that mends it would else be paid for each of them.
        """
        return self.noise + (1 - self.noise) / SMOOTHED


def noise_share(measured: Measured, rows: NDArray[np.bool_]) -> NoiseShare:
    """The share of noise in what some channels (C,) bool are judged by."""
    if not rows.any():
        return NoiseShare(1.0, 0, 0.0)
    noise, variance = measured.noise[rows], measured.sigma[rows] ** 2
    size = np.abs(measured.values[rows])
    shape = size**2 + np.median(size, axis=1, keepdims=True) ** 2
    floor = float(np.sqrt(max(float(np.median((variance - noise) / shape)), 0.0)))
    return NoiseShare(float(np.mean(noise / variance)), 2 * noise.size, floor)


def limits_for(thresholds: Thresholds, measured: Measured, parts: Split) -> Limits:
    """The limits of χ² for one campaign, at its noise, its floor and its number of lines.

    A placebo leaves its noise, which is known within 3 % and fluctuates, and its model-form error: that of the
    placebos, and as much again as the declared floor lies above theirs, which is taken at its word.
    """
    fitted = noise_share(measured, parts.train)
    # Where nothing is held out, what a new run like the fitted ones may leave.
    held = noise_share(measured, parts.held) if parts.held.any() else fitted
    return Limits(
        _limit(fitted, thresholds.chi2_per_dof, thresholds.model_form, 1),
        # Sums over neighbouring lines: a smooth error counts that many times, noise once.
        _limit(fitted, thresholds.smooth_per_dof, thresholds.model_form, SMOOTHED),
        _limit(held, thresholds.held_out_per_dof, thresholds.model_form, 1),
        max(thresholds.strain_sd, thresholds.strain_form_sd * fitted.form_size),
    )


def thresholds_for(problem: Problem, thresholds: Thresholds | None = None) -> Thresholds:
    """Limits (those that are shipped when left out) with what a name needs at a problem's own share of noise."""
    limits = stored_thresholds() if thresholds is None else thresholds
    return limits.at(noise_share(problem.measured, problem.split.train))


def stored_thresholds() -> Thresholds:
    """The thresholds that are shipped, with where they come from."""
    return thresholds_of(_STORED)


def thresholds_of(path: Path) -> Thresholds:
    """Thresholds from a TOML file with a number for every field and the provenance in words.

    InputError, with the key, for a file that is not that.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
        raise InputError(str(path), problem, f"give a file as {_MADE_BY} writes it") from None
    found = parsed_toml(path, raw)
    for field in fields(Thresholds):
        if field.name not in found and field.default is MISSING:
            raise InputError(f"{path}: {field.name}", "is missing", f"give a file as {_MADE_BY} writes it")
    for name, value in found.items():
        if name not in (f.name for f in fields(Thresholds)):
            known = [f.name for f in fields(Thresholds)]
            raise InputError(f"{path}: {name}", "is no limit", choose_one_of(name, known))
        if name == "provenance":
            if not isinstance(value, str):
                raise InputError(f"{path}: {name}", f"is {value!r}", "say in quotes where the limits come from")
        elif isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < math.inf:
            raise InputError(f"{path}: {name}", f"is {value!r}, and a limit is a number", "write one, 0 or more")
    if found.get("model_form") == 0:
        raise InputError(f"{path}: model_form", "is 0, and the limits refer to it", f"write {PLACEBO_FLOOR:g}")
    return Thresholds(**found)


def _limit(share: NoiseShare, beyond: float, floor_of_placebos: float, summed: int) -> float:
    fluctuation = _DEVIATE * np.sqrt(2 * summed / max(share.values, 1))
    noise = share.noise * (1 + _NOISE_KNOWN + fluctuation)
    if share.floor == 0:
        return float(noise)
    like_placebos = (floor_of_placebos / share.floor) ** 2
    form = beyond * like_placebos + summed * max(0.0, 1 - like_placebos)
    return float(noise + (1 - share.noise) * form)
