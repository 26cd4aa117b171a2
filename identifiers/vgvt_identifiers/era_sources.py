"""Poles by realisation of every response alone, or of all responses of a run at many orders."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ModalModel
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.data_correlation import CorrelatedRealisation
from vgvt_identifiers.hankel import HankelModel, Realisation, Roots
from vgvt_identifiers.impulse import ImpulseResponses, impulse_responses
from vgvt_identifiers.indicators import (
    consistent_mode_indicator,
    correlated_amplitude_coherence,
    extended_modal_amplitude_coherence,
)
from vgvt_identifiers.pole_claim import ClaimOptions, claim_of_sources
from vgvt_identifiers.pole_patterns import PatternOptions, SourcePoles
from vgvt_identifiers.root_noise import pole_spread
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra
from vgvt_identifiers.stabilisation import Criteria, PolesAtOrder, Stabilisation, stabilise

_LADDER_STEP = 2
_FIRST_RUNG = 4

Realise = Callable[[NDArray[np.float64], int], HankelModel]
"""Makes a model of an order from impulse responses (R, N)."""


@dataclass(frozen=True, slots=True)
class RealisationSettings:
    """The settings that the realisation methods share; the fields of the methods explain them."""

    name: str
    arrangement: Literal["siso", "simo"]
    samples: int
    rows: int
    columns: int
    order: int
    highest_order: int
    taper: float
    average: Literal["weighted", "plain"]
    poles: Literal["per-run", "common"]
    spectra: Literal["whole-record", "estimator"]
    transient: bool
    least_coherence: float
    tolerance: float
    largest_damping_ratio: float


def shared_settings(method: object) -> RealisationSettings:
    """The shared settings of a method that has fields of their names; AttributeError when it lacks one."""
    return RealisationSettings(**{f.name: getattr(method, f.name) for f in fields(RealisationSettings)})


def identify_by_realisation(
    settings: RealisationSettings, realise: Realise, campaign: Campaign, band_hz: tuple[float, float]
) -> ModalModel:
    """The modes of a campaign inside ``band_hz`` from the poles of models that ``realise`` makes."""
    options = PatternOptions(
        settings.tolerance,
        settings.largest_damping_ratio,
        least_quality=settings.least_coherence,
        weighted=settings.average == "weighted",
    )

    def sources(spectra: CampaignSpectra) -> tuple[SourcePoles, ...]:
        if settings.arrangement == "siso":
            return sources_by_response(spectra, settings, realise)
        return sources_by_run(spectra, settings, realise)

    claim = ClaimOptions(options, settings.taper, settings.poles == "per-run", settings.spectra == "estimator")
    return claim_of_sources(campaign, band_hz, claim, sources, sources if settings.transient else None)


def check_settings(settings: RealisationSettings) -> None:
    """InputError for settings that no impulse response can satisfy."""
    bounds = {
        "samples": (20, 100_000),
        "columns": (4, settings.samples - 4),
        "rows": (4, 100_000),
        "order": (2, settings.columns),
        "highest_order": (4, settings.columns),
        "least_coherence": (0.0, 1.0),
        "taper": (0.01, 0.5),
        "tolerance": (1e-4, 0.2),
        "largest_damping_ratio": (1e-6, 1.0),
    }
    check_bounds(settings, bounds)


def sources_by_response(
    spectra: CampaignSpectra, settings: RealisationSettings, realise: Realise
) -> tuple[SourcePoles, ...]:
    """Poles of a model of one order for each response alone, as in the 2014 paper."""
    found = []
    for index, run in enumerate(spectra.runs):
        impulse = _impulse(spectra, run, settings)
        for row in range(len(run.responses)):
            model = realise(impulse.values[row : row + 1], settings.order)
            roots = model.roots()
            found.append(_source(index, settings.order, model, roots, impulse, run.variance[row : row + 1], None))
    return tuple(found)


def sources_by_run(
    spectra: CampaignSpectra, settings: RealisationSettings, realise: Realise
) -> tuple[SourcePoles, ...]:
    """Stable poles of each run, from models of all its responses at every second order up to the highest."""
    found = []
    for index, run in enumerate(spectra.runs):
        impulse = _impulse(spectra, run, settings)
        full = realise(impulse.values, settings.highest_order)
        models = {n: full.truncated(n) for n in range(_FIRST_RUNG, settings.highest_order + 1, _LADDER_STEP)}
        roots = {n: m.roots() for n, m in models.items()}
        rungs = [PolesAtOrder(n, impulse.structure_poles(r.values), models[n].shapes(r)) for n, r in roots.items()]
        resolution = 2 * np.pi / (impulse.values.shape[1] * impulse.step_s) * 0.1
        criteria = Criteria(resolution_rad_s=resolution, added_decay_rad_per_s=spectra.added_decay_rad_per_s)
        stable = stabilise(rungs, criteria)
        for order, wanted, spread in _chosen(stable, roots):
            part = _some(roots[order], wanted)
            found.append(_source(index, order, models[order], part, impulse, run.variance, spread))
    return _joined(found, len(spectra.runs))


def _impulse(spectra: CampaignSpectra, run: RunSpectra, settings: RealisationSettings) -> ImpulseResponses:
    taper = settings.taper
    return impulse_responses(spectra.frequency_hz, run.accelerance, settings.samples, taper, taper)


def _chosen(stable: Stabilisation, roots: dict[int, Roots]) -> list[tuple[int, NDArray[np.intp], NDArray[np.float64]]]:
    """Places of the representatives of the clusters kept, by order, with the spread (n, 2) of frequency and damping."""
    starts = {n: int(np.flatnonzero(stable.orders == n)[0]) for n in np.unique(stable.orders)}
    chosen: dict[int, list[tuple[int, float, float]]] = {}
    for cluster in stable.modes:
        order = int(stable.orders[cluster.representative])
        place = cluster.representative - starts[order]
        chosen.setdefault(order, []).append((place, cluster.frequency_spread_hz, cluster.damping_spread))
    return [
        (n, np.array([r[0] for r in rows], dtype=np.intp), np.array([r[1:] for r in rows]))
        for n, rows in sorted(chosen.items())
    ]


def _some(roots: Roots, wanted: NDArray[np.intp]) -> Roots:
    return Roots(roots.values[wanted], roots.right[:, wanted], roots.left[wanted])


def _source(
    run: int,
    order: int,
    model: HankelModel,
    roots: Roots,
    impulse: ImpulseResponses,
    variance: NDArray[np.float64],
    spread: NDArray[np.float64] | None,
) -> SourcePoles:
    """The poles of some roots; ``spread`` (n, 2) over the orders adds to what noise makes of frequency and damping."""
    noise = pole_spread(roots.values, model.sensitivity(roots), impulse, variance)
    quality = np.full(roots.values.size, np.nan)
    if isinstance(model, CorrelatedRealisation):
        quality = correlated_amplitude_coherence(model, roots)
    elif isinstance(model, Realisation):
        quality = extended_modal_amplitude_coherence(model, roots)
        if model.impulse.shape[0] > 1:
            quality = consistent_mode_indicator(quality, model.shapes(roots))
    extra = np.zeros((roots.values.size, 2)) if spread is None else spread
    return SourcePoles(
        run,
        order,
        noise.poles,
        np.hypot(noise.frequency_std_hz, extra[:, 0]),
        np.hypot(noise.damping_ratio_std, extra[:, 1]),
        quality,
    )


def _joined(parts: list[SourcePoles], runs: int) -> tuple[SourcePoles, ...]:
    """One source a run; a run may have its poles from models of several orders, of which the highest names it."""
    joined = []
    for run in range(runs):
        own = [p for p in parts if p.run == run]
        if not own:
            continue
        poles = np.concatenate([p.poles for p in own])
        sort = np.argsort(np.abs(poles), kind="stable")
        columns = [
            np.concatenate([getattr(p, name) for p in own])[sort]
            for name in ("frequency_std_hz", "damping_ratio_std", "quality")
        ]
        joined.append(SourcePoles(run, max(p.order for p in own), poles[sort], *columns))
    return tuple(joined)
