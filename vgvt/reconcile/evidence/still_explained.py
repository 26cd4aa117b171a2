"""What a law at one place would still explain beside a named effect: whether the thing there is quite what was named.

Where the right effect is not in the catalogue another one at its place is bent until little is left, as an absorber
below the band is for a damper. What is left is then too little to show among all that noise leaves, and not too little
for a law of a few values: a dynamic stiffness at that place, there and at its mirror image alike, that is smooth over
frequency, or such a factor on a channel, whatever thing may have it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.run_schedule import Shape, progress
from vgvt.reconcile.evidence.free_places import (
    EVERY_RUN,
    ON_BOTH_SIDES,
    FreePlace,
    answered,
    free_places,
    mirror_images,
    moved,
    places_differ,
    with_article,
)
from vgvt.reconcile.evidence.lasting import lasting
from vgvt.reconcile.evidence.rivals import worth_to
from vgvt.reconcile.evidence.smooth_law import TERMS, by_first_of_law, law_terms
from vgvt.reconcile.evidence.whole_airframe import whole_airframe
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit, standardised
from vgvt.reconcile.prediction.surrogate import Anchor, anchor

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# How soon what creeps settles, as effects of the catalogue have it.
_PACE_RUNS = 3.0
# Of a direction's square length, what is left of it beside all that the unknowns imitate and is still one of its own.
_ITS_OWN = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class StillExplained:
    """The place where a smooth law explains most of what a fit leaves, and by how many ``nats`` more than chance.

    Chance would do as much in one of exp(nats) campaigns at any of the places. ``kind`` is as a free place's, ``when``
    says when the law acts, nothing where alike in all runs, and ``course`` (R,) by how much in each run.
    ``asked`` is how many places and courses over the runs there were to choose from. Those of ``alike`` do the same to
    all that is fitted and another thing to what is held out, which may choose among them; what is called ``or_on`` does
    the same to all data. Where it is no place that every campaign is asked for, ``point_m`` is its (x, y). Where one
    point alone is fitted it could be anywhere: then it has no label, kind or course.
    """

    label: str
    kind: str
    nats: float
    when: str = ""
    course: tuple[float, ...] = ()
    asked: int = 1
    alike: tuple[StillExplained, ...] = ()
    or_on: tuple[str, ...] = ()
    point_m: tuple[float, float] | None = None

    @property
    def at(self) -> str:
        """Where and when it acts."""
        label = f"{self.label.removesuffix(EVERY_RUN)} {self.when}" if self.when else self.label
        return with_article(label, self.kind)

    @property
    def words(self) -> str:
        """The place, as part of a sentence."""
        if not self.label:
            return "thing somewhere (the one point that was fitted tells no place)"
        same = [s.when for s in self.alike if s.label == self.label]
        elsewhere = (*(s.at for s in self.alike if s.label != self.label), *(at for s in self.alike for at in s.or_on))
        others = [f"on {at}" for at in dict.fromkeys((*self.or_on, *elsewhere))]
        at = f"{self.at.removesuffix(EVERY_RUN)}{EVERY_RUN}" if same and not self.when else self.at
        return f"{'' if self.kind == 'structure' else 'factor on '}{' or '.join([at, *same, *others])}"


@lru_cache(maxsize=8)
def still_explained(found: Fit) -> StillExplained | None:
    """What a smooth law at one place explains of what a fit leaves; None beside joints that depend on level.

    The law acts in every run, from some run on, in one alone, or more from run to run. Judged as names are, by tempered
    values and where the model's error lasts: the lesser of the two counts.
    """
    problem = found.problem
    here = anchor(problem, found.u, found.hypotheses, found.e, slopes=False)
    if any(group.levels is not None for group in here.groups):
        return None
    keep = problem.split.train
    run_of = np.array([c.run for c in problem.measured.channels])
    numbers = {c.run: c.run_number for c in problem.measured.channels}
    chain, laws = here.chain(found.u, found.e), law_terms(problem.measured.frequency_hz)
    views = _views(found)
    places = [*free_places(problem, here, keep), *whole_airframe(here)]
    columns = [_columns(found, here, place, chain, laws) for place in places]
    asked = list(zip(places, columns, strict=True))
    # To first order the same law on both sides does what it does on either, together.
    asked += [
        (replace(places[k], label=f"{places[k].label}{ON_BOTH_SIDES}"), columns[k] + columns[j])
        for k, j in mirror_images(places)
    ]
    told: list[_Acting] = []
    for place, acting in asked:
        here_too = np.ones(keep.size, dtype=bool) if place.mask is None else place.mask
        courses = _courses(place, run_of[keep & here_too], run_of[problem.measured.used & here_too], numbers)
        if not courses:
            continue
        nats = np.min([view.nats(acting, run_of[keep], [c for _, c in courses]) for view in views], axis=0)
        for n, (when, course) in zip(nats, courses, strict=True):
            one = StillExplained(place.label, place.kind, float(n), when, tuple(map(float, course)))
            told.append(_Acting(one, "" if place.mask is not None else place.label, here_too * course[run_of]))
    best = _best(told, keep, problem.measured.used)
    return best if places_differ(problem) else StillExplained("", "", best.nats, asked=best.asked)


class _Acting(NamedTuple):
    """A law with a course, and what it does: by how much it acts on every channel (C,), and where ``on`` the structure.

    A factor on channels is the same factor whatever it is called.
    """

    told: StillExplained
    on: str
    share: Array


def _best(told: Sequence[_Acting], fitted: NDArray[np.bool_], used: NDArray[np.bool_]) -> StillExplained:
    """What takes most, with all that fitted channels (C,) cannot tell from it, those once that no ``used`` ones can.

    What is not the same to held-out data counts as asked, for each may be chosen by these.
    """
    groups: dict[tuple[str, bytes], dict[bytes, list[StillExplained]]] = {}
    for one in told:
        group = groups.setdefault((one.on, one.share[fitted].tobytes()), {})
        group.setdefault(one.share[used].tobytes(), []).append(one.told)
    best = max(groups.values(), key=lambda group: next(iter(group.values()))[0].nats)
    asked = sum(map(len, groups.values()))
    nats = next(iter(best.values()))[0].nats - float(np.log(asked))
    first, *others = (
        replace(one, nats=nats, asked=asked, or_on=tuple(o.at for o in same)) for one, *same in best.values()
    )
    return replace(first, alike=tuple(others))


def _courses(
    place: FreePlace, fitted: NDArray[np.intp], used: NDArray[np.intp], numbers: Mapping[int, int]
) -> list[tuple[str, Array]]:
    """How a law may act over the runs (R,), in words and numbers, at a place with something to act on in some of them.

    ``fitted`` are runs of channels there that are fitted, counted from 0, ``used`` those of held-out ones, too, and
    ``numbers`` what the campaign calls its runs. What begins with a held-out run is one of them.
    """
    every, seen, heard = np.arange(max(numbers) + 1), np.unique(fitted), np.unique(used)
    if not seen.size or (heard.size == 1 and place.kind == "sensor" and place.label.endswith(EVERY_RUN)):
        # One sensor in one run is a place of its own.
        return []
    courses = [("", np.ones(every.size))]
    first = heard[1:-1][heard[1:-1] <= seen[-1]]
    courses += [(f"from run {numbers[run]} on", np.where(every >= run, 1.0, 0.0)) for run in first]
    if place.kind != "sensor" and seen.size > 1:
        # One sensor in one run is a place of its own.
        courses += [(f"in run {numbers[run]} alone", np.where(every == run, 1.0, 0.0)) for run in seen]
    if seen.size > 2:
        # What creeps is there a little in every run, and at its own pace.
        shapes: tuple[tuple[Shape, str], ...] = (("linear", ""), ("exponential", ", ever more slowly"))
        for shape, how in shapes:
            come = [progress(shape, int(run), every.size, _PACE_RUNS, 2) for run in every]
            courses.append((f"more from run to run{how}", np.array(come)))
    return courses


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """Misfit and scores (2 N + scores,) with the ``basis`` (…, scores) of what scores imitate, by one measure.

    ``worth`` is how many independent values each counts as; ``lasts`` where errors of the model do.
    """

    found: Fit
    left: Array
    basis: Array
    worth: float
    lasts: bool

    @classmethod
    def of(cls, found: Fit, misfit: Array, tangent: Array, worth: float, lasts: bool) -> _View:
        """From misfit (2 N,) and tangent (2 N, scores) by the measure."""
        basis, _ = np.linalg.qr(np.vstack([tangent, np.eye(tangent.shape[1])]))
        whole = np.concatenate([misfit, found.scores])
        return cls(found, whole - basis @ (basis.T @ whole), basis, worth, lasts)

    def nats(self, columns: Array, run_of: NDArray[np.intp], courses: Sequence[Array]) -> Array:
        """Minus the logarithm of the chance that columns (2 N, 2 terms) of nothing take as much as these do.

        By each of the courses over the runs (R,); ``run_of`` (fitted channels,) are the runs of the rows.
        """
        judged = lasting(self.found.problem, columns) if self.lasts else columns
        # Rows of different runs share nothing: what a course has are sums of what its runs have.
        rows = np.broadcast_to(run_of[None, :, None], (2, run_of.size, judged.shape[0] // (2 * run_of.size))).ravel()
        by_run = [judged[rows == run] for run in range(int(run_of.max()) + 1)]
        square = np.array([c.T @ c for c in by_run])
        imitated = np.array([self.basis[: rows.size][rows == r].T @ c for r, c in enumerate(by_run)])
        taken = np.array([c.T @ self.left[: rows.size][rows == r] for r, c in enumerate(by_run)])
        shares = [course[: square.shape[0]] for course in courses]
        return np.array(
            [
                self._surprise(*(np.tensordot(g, of, axes=1) for g, of in ((c**2, square), (c, imitated), (c, taken))))
                for c in shares
            ]
        )

    def _surprise(self, square: Array, imitated: Array, taken: Array) -> float:
        """The same by products of columns (k, k), with the basis (scores, k), and with what is left (k,)."""
        length = np.sqrt(np.maximum(np.diag(square), np.finfo(float).tiny))
        own = (square - imitated.T @ imitated) / np.outer(length, length)
        sizes, sides = np.linalg.eigh(own)
        kept = sizes > _ITS_OWN
        along = (sides[:, kept].T @ (taken / length)) ** 2 / sizes[kept]
        return surprise(0.5 * self.worth * float(along.sum()))


def _views(found: Fit) -> tuple[_View, _View]:
    problem = found.problem
    misfit = data_misfit(problem, found.predicted)
    worth = worth_to(found)
    judged = lasting(problem, np.column_stack([misfit, found.tangent]))
    return (
        _View.of(found, misfit, found.tangent, worth, lasts=False),
        _View.of(found, judged[:, 0], judged[:, 1:], 1.0, lasts=True),
    )


def _columns(found: Fit, here: Anchor, place: FreePlace, chain: ComplexArray, laws: Array) -> Array:
    """Changes of the misfit (2 N, 2 terms) by each term of a law, real and imaginary, at a place."""
    problem = found.problem
    if place.kind == "airframe":
        answer = by_first_of_law(here, place, found.u, found.e)
    else:
        answer = answered(here, place, found.predicted, chain)
        if place.rows is not None:
            omega = 2 * np.pi * problem.measured.frequency_hz
            for group, row in zip(here.groups, place.rows, strict=True):
                # A law's force is its stiffness times what moves there.
                answer[group.channels] *= moved(group, row, omega)[0]
    terms = answer[problem.split.train][:, :, None] * laws
    scaled = standardised(problem, np.concatenate([terms, 1j * terms], axis=2))
    flat = scaled.reshape(-1, scaled.shape[2])
    return np.asarray(np.sqrt(2) * np.concatenate([flat.real, flat.imag]))


def surprise(half: float) -> float:
    """Minus the logarithm of the chance that noise has such a ``half`` square sum along 2 terms' directions.

    Of an even number of values it is exp(-h) (1 + h + h²/2 + …), with half as many summands.
    """
    summands = np.cumprod([1.0, *(half / k for k in range(1, TERMS))])
    return half - float(np.log(summands.sum()))
