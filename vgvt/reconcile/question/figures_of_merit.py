"""How far a prediction is from data, in the figures that test engineers compare: NRMSE, FRAC, decibels, χ², ν-gap."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed, in_columns
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.holdout import Split
from vgvt.view.reconcile_wording import DATA_SETS
from vgvt_scoreboard.nu_gap import nu_gap_of_accelerances

ComplexArray = NDArray[np.complex128]


_FIGURES = ("χ²/dof", "NRMSE fit %", "mean |dB|", "FRAC", "ν-gap")


@dataclass(frozen=True, slots=True)
class Merit:
    """χ² per degree of freedom; NRMSE fit in per cent (100 perfect, median over channels); mean |dB|; median FRAC.

    And the largest ν-gap over the lines, of all channels as one system of accelerances in g/N: 0 equal, 1 furthest.
    """

    chi2_per_dof: float
    nrmse_percent: float
    mean_abs_db: float
    frac: float
    nu_gap: float

    def __repr__(self) -> str:
        chi2, nrmse, decibels, frac, gap = self.in_numbers()
        fit = f"χ² per degree of freedom {chi2}, NRMSE fit {nrmse} %, {decibels} dB"
        return headed(f"Merit: {fit}, FRAC {frac}, ν-gap {gap}")

    def in_numbers(self) -> tuple[str, ...]:
        """χ² per degree of freedom, NRMSE fit in per cent, decibels, FRAC and ν-gap as people read them."""
        numbers = (f"{self.chi2_per_dof:.3g}", f"{self.nrmse_percent:.2f}", f"{self.mean_abs_db:.3f}")
        return (*numbers, f"{self.frac:.4f}", f"{self.nu_gap:.3f}")


@dataclass(frozen=True, slots=True)
class Comparison:
    """A prediction against the data that were fitted, and against each kind that was held out (None: there is none)."""

    train: Merit
    held_out: Merit | None
    held_runs: Merit | None
    held_channels: Merit | None

    def __repr__(self) -> str:
        parts = [(DATA_SETS[f.name], getattr(self, f.name)) for f in fields(self)]
        rows = [(words, *merit.in_numbers()) for words, merit in parts if merit is not None]
        return f"<Comparison>\n{in_columns(('data', *_FIGURES), rows, words=('data',))}"

    def document(self) -> dict[str, object]:
        """Plain numbers by the JSON contract's keys."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class Resimulation:
    """What the simulation of the augmented scenario comes to, against the same data; ``remark`` is for the reader.

    ``comparison`` is None where it was skipped, and the remark says why. ``apart`` is how far it is from what was
    fitted, root mean square relative to what ``model_form``, the stated floor, is relative to.
    """

    comparison: Comparison | None
    apart: float | None
    model_form: float
    remark: str

    def __repr__(self) -> str:
        if self.comparison is None:
            return headed(f"Resimulation: {self.remark}")
        apart = "" if self.apart is None else f" {100 * self.apart:.2g} % from what was fitted"
        head = headed(f"Resimulation:{apart} (model form {100 * self.model_form:.2g} %)", filter(None, [self.remark]))
        return f"{head}\n{self.comparison!r}"

    @classmethod
    def skipped(cls, why: str) -> Resimulation:
        """None was made."""
        return cls(None, None, 0.0, f"reconciled.toml was not simulated: {why}")

    def document(self) -> dict[str, object]:
        """Plain numbers by the JSON contract's keys."""
        sets = (
            dict.fromkeys(f.name for f in fields(Comparison)) if self.comparison is None else self.comparison.document()
        )
        return {**sets, "apart": self.apart, "remark": self.remark or None}


def compare(predicted: ComplexArray, measured: Measured, split: Split) -> Comparison:
    """A prediction (C, L) against a campaign's accelerances."""

    def over(rows: NDArray[np.bool_]) -> Merit | None:
        return merit(predicted[rows], measured.some(rows)) if rows.any() else None

    train = over(split.train)
    assert train is not None, "a split leaves something to fit"
    return Comparison(train, over(split.held), over(split.held_runs), over(split.held_channels))


def merit(predicted: ComplexArray, measured: Measured) -> Merit:
    """The figures of a prediction (C, L).

    NRMSE fit 100 (1 - |y - ŷ| / |y - mean y|) as in Gupta, Seiler and Danowsky (AIAA 2016-1753), on complex
    accelerances; FRAC |yᴴŷ|² / (yᴴy ŷᴴŷ), Heylen and Lammens, Proc. IMAC 1996.
    """
    values = measured.values
    error = predicted - values
    spread = np.linalg.norm(values - values.mean(axis=1, keepdims=True), axis=1)
    nrmse = 100 * (1 - np.linalg.norm(error, axis=1) / spread)
    cross = np.abs(np.sum(values.conj() * predicted, axis=1)) ** 2
    frac = cross / (np.sum(np.abs(values) ** 2, axis=1) * np.sum(np.abs(predicted) ** 2, axis=1))
    decibels = 20 * np.abs(np.log10(np.abs(predicted) / np.abs(values)))
    return Merit(
        float(np.mean(np.abs(error / measured.sigma) ** 2)),
        float(np.median(nrmse)),
        float(np.mean(decibels)),
        float(np.median(frac)),
        # A column system of every channel.
        float(nu_gap_of_accelerances(values[:, None], predicted[:, None]).max()),
    )
