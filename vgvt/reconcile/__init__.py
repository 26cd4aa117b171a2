"""Close the loop: from a measured campaign to the effect that a scenario lacks; names load when asked for."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "question.data": ("Measured", "MeasuredChannel", "measured_frfs"),
    "question.drawn": ("drawn_gains", "drawn_lab"),
    "question.figures_of_merit": ("Comparison", "Merit", "Resimulation", "compare", "merit"),
    "question.holdout": ("Split", "split"),
    "question.hypothesis": ("Hypothesis",),
    "question.problem": ("Problem", "make_problem", "problem_of"),
    "question.thresholds": ("Thresholds", "stored_thresholds", "thresholds_for", "thresholds_of"),
    "question.uncertain": ("Unknown", "unknowns"),
    "fitting.calibration": ("calibrate",),
    "fitting.fit": ("Fit", "fit"),
    "evidence.localise": ("Localisation", "Place", "localise"),
    "evidence.residual": ("Residual", "residual"),
    "search.candidates": ("candidates",),
    "search.screen": ("Screened", "screen"),
    "next_test.before_test": ("expected_fit",),
    "next_test.power": ("Power", "power"),
    "next_test.power_rows": ("power_rows",),
    "next_test.suggest": ("Suggestion", "suggest"),
    "decision.attribute": ("Addition", "Attribution", "Rival", "attribute"),
    "decision.kinds": ("Kind",),
    "decision.undecided": ("undecided",),
    "decision.verdict": ("NamedEffect", "Verdict"),
    "outcome.account": ("account_of",),
    "outcome.augment": ("augment", "posterior_of", "write_reconciled"),
    "outcome.resimulate": ("resimulated",),
    "outcome.mode_errors": ("ModelModes", "mode_rows", "model_modes"),
    "loop": ("reconcile",),
    "placebo": ("Placebo", "calibrated_thresholds", "own_thresholds", "write_thresholds"),
    "rehearsal": ("Rehearsal", "placebo_campaign", "rehearsed"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}
__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__]
