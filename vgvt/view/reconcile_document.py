"""What the page of a reconciliation shows, as plain values: for who reads ``verdict.json`` and not the page."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from vgvt.view.reconcile_account import FIGURES, Account, Array, ModelState

# Beside these names stand the same values in words.
_AS_NUMBERS = {"stated": "stated_value", "calibrated": "calibrated_value", "calibrated_std": "calibrated_value_std"}


def account_document(account: Account) -> dict[str, object]:
    """Channels with what is left of them, what was calibrated, and every candidate, by the contract's keys."""
    before, after = (_by_channel(account, state) for state in (account.before, account.after))
    return {
        "hold_out": {
            "runs": [c.label for c in account.channels if c.held == "run"],
            "channels": [c.label for c in account.channels if c.held == "channel"],
            "turned": account.turned,
        },
        "bands_hz": account.bands_hz.tolist(),
        "channels": [
            {"channel": c.label, "held_out": c.held or None, "before": before[k], "after": after[k]}
            for k, c in enumerate(account.channels)
        ],
        "calibrated": [
            {
                "name": r.name, "what": r.words, "score": r.score, "std_score": r.score_std, "change": r.change,
                "stated": r.stated or None, "calibrated": r.calibrated or None,
                **{_AS_NUMBERS.get(name, name): r.figures.get(name) for name in FIGURES}, "unit": r.unit,
            }
            for r in account.posterior
        ],
        "candidates": [
            {
                "round": c.round, "effect": c.label, "standing": c.standing, "fitted": c.fitted,
                "gain_nats": c.gain_nats, "raw_nats": c.raw_nats, "lasting_nats": c.lasting_nats,
                "held_out_before": c.held_out_before, "held_out": c.held_out_after, "converged": c.converged,
            }
            for c in account.candidates
        ],
        "modes": [asdict(m) for m in account.modes],
        "located_at": account.located,
    }  # fmt: skip


def _by_channel(account: Account, state: ModelState) -> list[dict[str, object]]:
    """χ² per degree of freedom, over all lines and by band, and NRMSE fit in per cent, of every channel."""
    error = state.predicted - account.measured
    chi2: Array = np.mean(np.abs(error / account.sigma) ** 2, axis=1)
    spread = np.linalg.norm(account.measured - account.measured.mean(axis=1, keepdims=True), axis=1)
    nrmse = 100 * (1 - np.linalg.norm(error, axis=1) / spread)
    # A band without a line has no mean.
    bands = [[float(v) if np.isfinite(v) else None for v in row] for row in state.table]
    return [
        {"chi2_per_dof": float(chi2[k]), "nrmse_percent": float(nrmse[k]), "by_band": bands[k]}
        for k in range(len(account.channels))
    ]
