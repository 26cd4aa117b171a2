"""Covariance-driven stochastic subspace identification of sensors that were measured together, without the force."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.covariance_subspace import (
    Poles,
    Realisation,
    block_changes,
    block_covariances,
    pole_std,
    poles_at,
    realise,
    significant_order,
)
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.output_spectra import DIFFERENTIATIONS
from vgvt_identifiers.stabilisation import Cluster, Criteria, PolesAtOrder, Stabilisation, stabilise
from vgvt_identifiers.steady_responses import SteadyResponses, steady_responses

_CITATION = """\
@article{peeters1999reference,
  author = {Peeters, Bart and De Roeck, Guido},
  title = {Reference-Based Stochastic Subspace Identification for Output-Only Modal Analysis},
  journal = {Mechanical Systems and Signal Processing},
  volume = {13},
  number = {6},
  pages = {855--878},
  year = {1999},
}

@article{doehler2013efficient,
  author = {D{\\"o}hler, Michael and Mevel, Laurent},
  title = {Efficient Multi-Order Uncertainty Computation for Stochastic Subspace Identification},
  journal = {Mechanical Systems and Signal Processing},
  volume = {38},
  number = {2},
  pages = {346--366},
  year = {2013},
}
"""
_LARGEST_HANKEL = 900
_LARGEST_RELATIVE_STD = 0.5
_SPARE_STATES = 8
_Row = tuple[complex, NDArray[np.complex128], NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class SsiCov:
    """Realisation of output covariances over many orders; fields are the settings."""

    name: ClassVar[str] = "ssi-cov"
    summary: ClassVar[str] = "Stochastic subspace realisation of the responses' covariances, without a force"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.OUTPUT_ONLY | Needs.TIME_HISTORIES

    largest_order: int = field(default=40, metadata={"doc": "most states of a model"})
    periods: float = field(
        default=2.0, metadata={"doc": "periods of the lowest frequency of the band that the covariances reach"}
    )
    references: int = field(default=6, metadata={"doc": "principal components of the responses used as references"})
    blocks: int = field(default=20, metadata={"doc": "parts of the record whose scatter gives the uncertainty"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "largest_order": (4, 200),
            "periods": (0.5, 50.0),
            "references": (1, 100),
            "blocks": (4, 1000),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        check_bounds(self, bounds)

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The stable modes inside ``band_hz``; shapes have their largest entry at 1."""
        responses = steady_responses(campaign, band_hz)
        if not responses.problem and len({c.quantity for c in responses.channels}) > 1:
            return ModalModel.empty(
                Outcome.DECLINED, (*responses.remarks, "responses of different quantities have no common covariance")
            )
        if responses.problem:
            return ModalModel.empty(Outcome.DECLINED, (*responses.remarks, responses.problem))
        samples, step_s = _decimated(responses, band_hz[1])
        outputs, references = samples.shape[0], min(self.references, samples.shape[0])
        wanted = round(self.periods / (max(band_hz[0], 0.02 * band_hz[1]) * step_s))
        rows = max(min(wanted, _LARGEST_HANKEL // outputs), 4)
        if (samples.shape[1] - 2 * rows) // self.blocks <= 4 * rows:
            reach_s = 2 * rows * step_s
            why = f"{responses.duration_s:.3g} s are too short for covariances of {reach_s:.2g} s: record longer"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*responses.remarks, why))
        covariances = block_covariances(samples, references, 2 * rows - 1, self.blocks)
        found = realise(covariances, step_s, rows * references)
        states = significant_order(found, self.largest_order // 2)
        if not states:
            why = "the covariances are no larger than their own errors: record longer, or excite the structure more"
            dofs = tuple(c.dof for c in responses.channels if c.dof is not None)
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*responses.remarks, why), dofs=dofs)
        # A few states more, as poles need room to settle; far more split a mode among several poles.
        found = found.truncated(min(self.largest_order, states + _SPARE_STATES, (rows - 1) * outputs))
        return flag_non_modes(campaign, self._claim(found, responses, band_hz))

    def _claim(self, found: Realisation, responses: SteadyResponses, band_hz: tuple[float, float]) -> ModalModel:
        models = [poles_at(found, order) for order in range(2, found.values.size + 1, 2)]
        criteria = Criteria(
            largest_damping_ratio=self.largest_damping_ratio, resolution_rad_s=2 * np.pi / responses.duration_s
        )
        table = [_inside(m, band_hz) for m in models]
        stable = stabilise(table, criteria)
        dofs = tuple(c.dof for c in responses.channels if c.dof is not None)
        changes = block_changes(found)
        rows, doubts = [], []
        for cluster in stable.modes:
            best = _surest(found, changes, models, [int(stable.orders[i]) for i in cluster.members], cluster)
            why = _doubt(best)
            if why:
                stable = stable.without(cluster, why)
                doubts.append(why)
            else:
                rows.append(best)
        advice = (*responses.remarks, *doubts)
        if not rows:
            why = "no pole stays from order to order as a mode would: record longer, or excite the band more evenly"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*advice, why), dofs=dofs)
        return _model(rows, stable, responses, advice)


def _decimated(responses: SteadyResponses, top_hz: float) -> tuple[NDArray[np.float64], float]:
    """Samples (D, N) at the lowest rate that holds the band with room for the filter, and their time step."""
    from scipy.signal import resample_poly

    factor = max(int(responses.sample_rate_hz / (2.6 * top_hz)), 1)
    samples = responses.samples - responses.samples.mean(axis=1, keepdims=True)
    if factor > 1:
        samples = resample_poly(samples, 1, factor, axis=1)
    return np.asarray(samples), factor / responses.sample_rate_hz


def _inside(model: Poles, band_hz: tuple[float, float]) -> PolesAtOrder:
    natural = np.abs(model.poles_rad_s) / (2 * np.pi)
    keep = (natural >= band_hz[0]) & (natural <= band_hz[1])
    return PolesAtOrder(model.order, model.poles_rad_s[keep], model.shapes[keep])


def _surest(
    found: Realisation,
    changes: NDArray[np.float64],
    models: list[Poles],
    orders: list[int],
    cluster: Cluster,
) -> _Row:
    """The pole of a cluster that the blocks of the record agree on best: at high orders a mode splits among several."""
    rows: list[_Row] = []
    for order in orders:
        model = models[order // 2 - 1]
        which = int(np.argmin(np.abs(model.poles_rad_s - cluster.pole_rad_s)))
        std = pole_std(found, changes, model, [which])[0]
        rows.append((complex(model.poles_rad_s[which]), model.shapes[which], std))
    return min(rows, key=lambda row: float(row[2][0]))


def _doubt(row: _Row) -> str:
    """Why a stable pole is no mode after all: the blocks of the record disagree on it."""
    pole, _, std = row
    damping, natural_hz = -pole.real / abs(pole), abs(pole) / (2 * np.pi)
    if std[0] > _LARGEST_RELATIVE_STD * damping * natural_hz or std[1] > _LARGEST_RELATIVE_STD * damping:
        return f"{natural_hz:.4g} Hz: the parts of the record disagree on it by half its own width or more"
    return ""


def _model(
    rows: list[_Row],
    stable: Stabilisation,
    responses: SteadyResponses,
    advice: tuple[str, ...],
) -> ModalModel:
    rows = sorted(rows, key=lambda row: abs(row[0]))
    poles = np.array([row[0] for row in rows])
    shapes = np.array([row[1] for row in rows])
    # The pole decays from acceleration to displacement alike, so a shape of accelerations is the shape.
    largest = shapes[np.arange(len(rows)), np.argmax(np.abs(shapes), axis=1)]
    assert all(c.quantity in DIFFERENTIATIONS for c in responses.channels)
    return ModalModel(
        natural_frequency_hz=np.abs(poles) / (2 * np.pi),
        damping_ratio=-poles.real / np.abs(poles),
        shapes=shapes / largest[:, None],
        dofs=tuple(c.dof for c in responses.channels if c.dof is not None),
        natural_frequency_std_hz=np.array([row[2][0] for row in rows]),
        damping_ratio_std=np.array([row[2][1] for row in rows]),
        flags=((),) * len(rows),
        advice=advice,
        candidates=stable.candidates(),
    )
