"""Scores: a claimed modal model against the truth, one row per mode."""

from vgvt.data.scorecard import ModeScore, ModeStatus, Scorecard
from vgvt_scoreboard.counterparts import counterparts
from vgvt_scoreboard.judged_by import JudgedBy, judged_by
from vgvt_scoreboard.merged_truth import MergedTruth, merge_truth
from vgvt_scoreboard.nrmse import fit_percent, frf_fit_percent
from vgvt_scoreboard.nu_gap import pointwise_nu_gap, winding_turns
from vgvt_scoreboard.pairing import Pairing, PairingRule, pair_modes, pole_distance
from vgvt_scoreboard.reach import reachable, sigma_share
from vgvt_scoreboard.score import score
from vgvt_scoreboard.validation import validate

__all__ = [
    "JudgedBy",
    "MergedTruth",
    "ModeScore",
    "ModeStatus",
    "Pairing",
    "PairingRule",
    "Scorecard",
    "counterparts",
    "fit_percent",
    "frf_fit_percent",
    "judged_by",
    "merge_truth",
    "pair_modes",
    "pointwise_nu_gap",
    "pole_distance",
    "reachable",
    "score",
    "sigma_share",
    "validate",
    "winding_turns",
]
