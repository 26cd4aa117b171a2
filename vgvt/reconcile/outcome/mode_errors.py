"""Mode by mode, before and after: a wrong effect often mends one mode and spoils others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import counted, in_columns
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.mechanics.response import Poles, poles_of
from vgvt.reconcile.outcome.measured_modes import SeenMode, mac_of_residues, seen_modes
from vgvt.reconcile.prediction.surrogate import Reduced, anchor
from vgvt.reconcile.question.problem import Problem
from vgvt.view.reconcile_account import ModeRow, SeenRow

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_Pairs = list[tuple[int | None, int | None]]

# A window of this many half-power widths each side, at least this share of the frequency and these many lines.
_WIDTHS, _SHARE, _FEWEST_LINES = 3.0, 0.01, 5
_SAME_MAC, _SAME_FREQUENCY = 0.5, 0.15
_MOST_DAMPED = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class ModelModes:
    """Modes of a fitted model in its first run: Hz (M,), damping ratios (M,), shapes (M, P) at the grid's points.

    ``mean_hz`` (M,) and ``mean_damping`` (M,) are the means of all runs, each with its accelerometers where they sit.
    """

    frequency_hz: Array
    damping_ratio: Array
    shapes: ComplexArray
    mean_hz: Array
    mean_damping: Array

    def __repr__(self) -> str:
        numbers = zip(self.frequency_hz, self.damping_ratio, strict=True)
        rows = [(str(k), f"{f:.3f}", f"{100 * ratio:.2f}") for k, (f, ratio) in enumerate(numbers, start=1)]
        head = f"<ModelModes: {counted(len(rows), 'mode')}>"
        return "\n".join(filter(None, (head, in_columns(("mode", "frequency Hz", "damping %"), rows))))


def model_modes(fit: Fit) -> ModelModes:
    """The modes of a fit within the band of its data, as they are in the first run, its accelerometers seated."""
    here = anchor(fit.problem, fit.u, fit.hypotheses, fit.e, slopes=False)
    group, whole = here.groups[0], here.assembled[0]
    band = fit.problem.measured.frequency_hz
    found = _seated(group, 0, band)
    frequency, damping = _numbers(found)
    inside = (found.poles.imag > 0) & (frequency >= band[0]) & (frequency <= band[-1]) & (damping < _MOST_DAMPED)
    index = np.flatnonzero(inside)[np.argsort(frequency[inside])]
    # At every point, those of other runs too: where runs differ in structure a group has some of the channels only.
    points = [whole.structure.places.index(p.site) for p in whole.plan.grid]
    shapes = (whole.structure.axis[points] @ group.basis @ found.vectors[:, index]).T
    poles = found.poles[index]
    by_run = np.array([_nearest(_seated(g, k, band), poles) for g in here.groups for k in range(len(g.runs))])
    return ModelModes(frequency[index], damping[index], shapes, *by_run.mean(axis=0))


def _seated(group: Reduced, run: int, band_hz: Array) -> Poles:
    """The poles of a group, with the accelerometers of one of its runs on it."""
    matrices = group.matrices
    if group.roving:
        rows = group.runs[run]
        seated = matrices.axis[rows]
        matrices = replace(matrices, mass=matrices.mass + seated.T @ (group.masses_kg[rows][:, None] * seated))
    return poles_of(matrices, 2 * np.pi * band_hz[:1])


def _numbers(found: Poles) -> tuple[Array, Array]:
    """Hz and damping ratios of all poles."""
    size = np.abs(found.poles)
    return size / (2 * np.pi), -found.poles.real / size


def _nearest(found: Poles, poles: ComplexArray) -> Array:
    """Hz and damping ratios (2, M) of the poles that are nearest to some (M,)."""
    nearest = np.abs(found.poles[:, None] - poles).argmin(axis=0)
    return np.array([values[nearest] for values in _numbers(found)])


def mode_rows(before: Fit, after: Fit) -> tuple[ModeRow, ...]:
    """Every mode of both models, paired by shape, with the error of both in a window around it."""
    first = model_modes(before)
    second = first if after is before else model_modes(after)
    pairs = _pairs(first, second)
    # As on the rest of a page: the own gain of a held-out channel is no error of either model.
    foretold = (before.foretold, after.foretold)
    seen = _seen(before.problem, foretold, first, second, pairs)
    rows = []
    for (i, j), shown in zip(pairs, seen, strict=True):
        f = second.frequency_hz[j] if j is not None else first.frequency_hz[i]
        damping = second.damping_ratio[j] if j is not None else first.damping_ratio[i]
        errors = _errors(before.problem, foretold, float(f), float(damping))
        mac = None if i is None or j is None else float(_mac(first.shapes[i], second.shapes[j]))
        rows.append(
            ModeRow(
                _at(first.frequency_hz, i), _at(second.frequency_hz, j), _at(first.damping_ratio, i),
                _at(second.damping_ratio, j), mac, *errors, shown,
            )
        )  # fmt: skip
    return tuple(sorted(rows, key=lambda r: r.after_hz or r.before_hz or 0.0))


def _seen(
    problem: Problem, foretold: tuple[ComplexArray, ComplexArray], first: ModelModes, second: ModelModes, pairs: _Pairs
) -> list[SeenRow | None]:
    """What the records show of each pair of modes, and of each of the models beside."""
    measured, used = problem.measured, problem.measured.used
    run_of = np.array([c.run for c in measured.channels])[used]

    def shown(values: ComplexArray, modes: Sequence[tuple[ModelModes, int] | None]) -> list[SeenMode | None]:
        """Of a mode for each that there is."""
        there = [m for m in modes if m is not None]
        starts = ([float(m.frequency_hz[k]) for m, k in there], [float(m.damping_ratio[k]) for m, k in there])
        found = iter(seen_modes(values[used], measured.sigma[used], measured.frequency_hz, run_of, *starts))
        return [None if m is None else next(found) for m in modes]

    earlier = [None if i is None else (first, i) for i, _ in pairs]
    later = [None if j is None else (second, j) for _, j in pairs]
    records = shown(measured.values, [j or i for i, j in zip(earlier, later, strict=True)])
    models = list(zip(shown(foretold[0], earlier), shown(foretold[1], later), strict=True))
    return [
        None if found is None else _seen_row(_as_sure(found, reversed(both), (after, before)), both)
        for found, both, before, after in zip(records, models, earlier, later, strict=True)
    ]


def _as_sure(
    found: SeenMode, told: Iterable[SeenMode | None], modes_of: Sequence[tuple[ModelModes, int] | None]
) -> SeenMode:
    """A mode with deviations that hold what the local fit errs by, as it does of the first model that shows the mode.

    ``told`` is what such fits say of models whose modes are known. Between few lines a sharp peak is anywhere, and a
    mode beside it bends what the fit takes for a background: that is no noise, and runs do not scatter by it.
    """
    known = ((t, mode) for t, mode in zip(told, modes_of, strict=True) if t is not None and mode is not None)
    told_of, mode = next(known, (None, None))
    if told_of is None or mode is None:
        return found
    modes, k = mode
    off_hz = told_of.frequency_hz - float(modes.mean_hz[k])
    off_damping = told_of.damping_ratio - float(modes.mean_damping[k])
    return replace(
        found,
        frequency_std_hz=float(np.hypot(found.frequency_std_hz, off_hz)),
        damping_std=float(np.hypot(found.damping_std, off_damping)),
    )


def _seen_row(found: SeenMode, models: tuple[SeenMode | None, SeenMode | None]) -> SeenRow:
    def errors(name: str) -> tuple[float | None, float | None]:
        one, other = (None if m is None else 100 * (getattr(m, name) / getattr(found, name) - 1) for m in models)
        return one, other

    before, after = (None if m is None else mac_of_residues(found, m) for m in models)
    return SeenRow(
        found.frequency_hz, found.frequency_std_hz, found.damping_ratio, found.damping_std, errors("frequency_hz"),
        errors("damping_ratio"), (before, after),
    )  # fmt: skip


def _pairs(first: ModelModes, second: ModelModes) -> _Pairs:
    """Best MAC first, each mode once, near in frequency; what is left has no partner."""
    options = sorted(
        (
            (_mac(a, b), i, j)
            for i, a in enumerate(first.shapes)
            for j, b in enumerate(second.shapes)
            if abs(first.frequency_hz[i] / second.frequency_hz[j] - 1) < _SAME_FREQUENCY
        ),
        reverse=True,
    )
    taken: _Pairs = []
    used_i: set[int] = set()
    used_j: set[int] = set()
    for mac, i, j in options:
        if mac > _SAME_MAC and i not in used_i and j not in used_j:
            taken.append((i, j))
            used_i.add(i)
            used_j.add(j)
    taken += [(i, None) for i in range(len(first.shapes)) if i not in used_i]
    taken += [(None, j) for j in range(len(second.shapes)) if j not in used_j]
    return taken


def _mac(a: ComplexArray, b: ComplexArray) -> float:
    return float(np.abs(np.vdot(a, b)) ** 2 / max(np.vdot(a, a).real * np.vdot(b, b).real, 1e-300))


def _errors(
    problem: Problem, foretold: tuple[ComplexArray, ComplexArray], frequency_hz: float, damping_ratio: float
) -> tuple[tuple[float, float], tuple[float, float] | None]:
    """Median error, per cent of the responses' size in the window, on train and on held-out channels.

    ``foretold`` are A/F (C, L) of the model before and after.
    """
    measured, split = problem.measured, problem.split
    half = frequency_hz * max(_SHARE, _WIDTHS * damping_ratio)
    away = np.abs(measured.frequency_hz - frequency_hz)
    lines = away <= max(half, np.sort(away)[min(_FEWEST_LINES, away.size) - 1])
    values = measured.values[:, lines]
    size = np.where(measured.used, np.linalg.norm(values, axis=1), 1.0)
    share = [100 * np.linalg.norm(model[:, lines] - values, axis=1) / size for model in foretold]

    def middle(rows: NDArray[np.bool_]) -> tuple[float, float]:
        return float(np.median(share[0][rows])), float(np.median(share[1][rows]))

    return middle(split.train), middle(split.held) if split.held.any() else None


def _at(values: Array, index: int | None) -> float | None:
    return None if index is None else float(values[index])
