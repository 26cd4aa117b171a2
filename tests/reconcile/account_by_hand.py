"""A reconciliation made up by hand, as its page takes it."""

from __future__ import annotations

import numpy as np

from vgvt.data import Geometry
from vgvt.view.reconcile_account import (
    Account,
    CandidateRow,
    ChannelRow,
    EffectRow,
    ModelState,
    ModeRow,
    NamelessRow,
    PlaceRow,
    PosteriorRow,
    PowerRow,
    SeenRow,
    SuggestionRow,
)

FREQUENCY = np.linspace(3.0, 35.0, 120)
LIMITS = {
    "chi2_per_dof": 1.3,
    "smooth_per_dof": 1.8,
    "held_out_chi2_per_dof": 2.0,
    "evidence_nats": 6.0,
    "set_nats": 5.0,
    "place_explained": 0.05,
}


def response(frequency_hz: float, gain: float) -> np.ndarray:
    w, w0 = 2 * np.pi * FREQUENCY, 2 * np.pi * frequency_hz
    return gain * w**2 / (w0**2 - w**2 + 0.04j * w * w0)


def state(factor: float, adequate: bool) -> ModelState:
    predicted = np.array([response(15.0 * factor, g) for g in (1.0, 0.8, 1.2, 0.5)])
    merit = {"chi2_per_dof": 40.0 * abs(factor - 1) + 1, "nrmse_percent": 90.0, "mean_abs_db": 0.5, "frac": 0.99}
    merit["nu_gap"] = 0.123
    figures = {
        "chi2_per_dof": merit["chi2_per_dof"],
        "smooth_per_dof": 1.0,
        "held_out_chi2_per_dof": merit["chi2_per_dof"],
        "lag_one": 0.2,
        "between_channels": 0.1,
        "share_beyond_three": 0.01,
    }
    merits = {"train": merit, "held_out": merit, "held_runs": merit, "held_channels": None}
    return ModelState(predicted, np.full((4, 3), merit["chi2_per_dof"]), figures, merits, adequate)


def nameless() -> NamelessRow:
    """A damper of 5 N s/m at one place, less well known where it is stiffer."""
    law = 2j * np.pi * FREQUENCY * 5.0
    return NamelessRow(
        "force at 8+Z from run 2 on", "structure", "a force at 8+Z that <is> smooth", "N/m", FREQUENCY, law,
        0.02 * np.abs(law) * (1 + 2j), law * 0.99,
    )  # fmt: skip


def account(kind: str = "ambiguous", named: bool = True) -> Account:
    z = 300.0 - (2 * np.pi * FREQUENCY) ** 2 * 0.05 + 0j
    places = (
        PlaceRow("force at 8+Z", "structure", (0.8, 1.1, 0.0), 0.81, "mass", 0.05, "kg", z),
        PlaceRow(
            "bending at the root of wing-right", "structure", (0.4, 0.2, 0.0), 0.2, "unclear", 0.0, "", z, turns=True
        ),
        PlaceRow("run 1, 2+Z", "sensor", None, 0.1, "", 0.0, "", None),
    )
    effect = EffectRow(
        "added-mass", "Something <heavy> sits there.", {"mass_kg": (0.05, 0.002, "kg")}, {"x_m": 0.8}, 120.5,
        ("local-absorber",), 12.0, 1.1, "All modes move.", "Weigh it",
    )  # fmt: skip
    candidates = (
        CandidateRow(1, "added-mass", 120.5, 300.0, 200.0, 12.0, 1.1, "named", "mass_kg 0.05 kg"),
        CandidateRow(1, "local-absorber", 118.0, 290.0, 190.0, 12.0, 1.2, "equivalent"),
        CandidateRow(1, "local-absorber", 3.0, 4.0, 3.5, 12.0, 11.0, "too little evidence"),
        CandidateRow(1, "channel-gain (channels = 2+Z)", 9.0, 20.0, 12.5, 12.0, 13.0, "refused by held-out data"),
    )
    before, after = state(1.1, False), state(1.0, True)
    corners = np.array([[0.0, -1.5, 0.0], [0.0, 1.5, 0.0], [1.0, 0.0, 0.0], [0.0, -1.5, 0.0]])
    return Account(
        title="plate against </script><b>nominal",
        kind=kind,
        reasons=("Adding added-mass gains 120 nats",),
        unexplained=(),
        facts={"campaign": "plate"},
        geometry=Geometry((1, 2), np.array([[0.2, 1.0, 0.0], [0.2, -1.0, 0.0]]), (), (corners,)),
        channels=(
            ChannelRow("run 1, 1+Z"),
            ChannelRow("run 1, 2+Z", "channel"),
            ChannelRow("run 2, 1+Z", "run"),
            ChannelRow("run 2, 2+Z", "run"),
        ),
        frequency_hz=FREQUENCY,
        measured=after.predicted * 1.001,
        sigma=0.02 * np.abs(after.predicted),
        bands_hz=np.array([3.0, 10.0, 20.0, 35.0]),
        before=before,
        after=after if named else before,
        limits=LIMITS,
        provenance="a study",
        effects=(effect,) if named else (),
        candidates=candidates,
        places=places,
        located="the calibrated scenario",
        posterior=(
            PosteriorRow("EI wing", "EI of the wing", -4.2, 0.3, "× 0.66 ± 0.02"),
            PosteriorRow("drive x", "drive point, x", 0.1, 0.9, "+0.0005 ± 0.0045 m", "0.635 m", "0.6355 m"),
        ),
        modes=(
            ModeRow(
                16.5,
                15.0,
                0.02,
                0.02,
                0.99,
                (40.0, 0.5),
                (41.0, 0.6),
                SeenRow(15.02, 0.004, 0.021, 0.0003, (9.85, -0.13), (-4.8, None), (0.912, 0.998)),
            ),
            ModeRow(22.25, None, 0.01, None, None, (3.0, 3.1), None),
        ),
        power=(
            PowerRow("added-mass", "added-mass", "mass_kg", "kg", 0.01, 0.016, 0.002, 0.2, (("local-absorber", 0.93),)),
            PowerRow("mains-hum", "mains-hum", "amplitude_v", "V", np.inf, np.inf, 0.0, 0.1),
            PowerRow(
                "local-absorber",
                "at a tip",
                "mass_kg",
                "kg",
                6e-5,
                1.6e-4,
                0.02,
                0.3,
                variants=16,
                median=7.7e-4,
                worst=7.8e-3,
            ),
            PowerRow(
                "root-freeplay",
                "",
                "gap_rad",
                "rad",
                np.nan,
                np.nan,
                3e-4,
                9e-3,
                variants=6,
                median=np.nan,
                worst=np.nan,
                reason="by level: not foretold",
            ),
        ),
        tests=(SuggestionRow("tape a dummy mass", ("added-mass", "local-absorber"), 31.0, 5.0),),
    )
