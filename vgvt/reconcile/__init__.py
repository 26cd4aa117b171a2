"""Close the loop: from a measured campaign to the effect that a scenario lacks; names load when asked for."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

_HOMES = {
    "account": ("account_of", "power_rows"),
    "attribute": ("Addition", "Attribution", "Rival", "attribute"),
    "augment": ("augment", "posterior_of", "write_reconciled"),
    "before_test": ("expected_fit",),
    "candidates": ("candidates",),
    "data": ("Measured", "MeasuredChannel", "measured_frfs"),
    "figures_of_merit": ("Comparison", "Merit", "compare", "merit"),
    "fit": ("Fit", "calibrate", "fit"),
    "holdout": ("Split", "split"),
    "hypothesis": ("Hypothesis",),
    "localise": ("Localisation", "Place", "localise"),
    "loop": ("reconcile",),
    "mode_errors": ("ModelModes", "mode_rows", "model_modes"),
    "placebo": ("Placebo", "calibrated_thresholds", "write_thresholds"),
    "power": ("Power", "power"),
    "problem": ("Problem", "make_problem", "problem_of"),
    "residual": ("Residual", "residual"),
    "screen": ("Screened", "screen"),
    "suggest": ("Suggestion", "suggest"),
    "thresholds": ("Thresholds", "stored_thresholds", "thresholds_of"),
    "uncertain": ("Unknown", "unknowns"),
    "verdict": ("Kind", "NamedEffect", "Verdict"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}
__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__]


class _Package(ModuleType):
    """Keeps a name for the function where a submodule has the same one: importing it would put the module there."""

    def __setattr__(self, name: str, value: Any) -> None:
        known = isinstance(value, ModuleType) and _HOME_OF.get(name) == name
        super().__setattr__(name, getattr(value, name) if known else value)


sys.modules[__name__].__class__ = _Package
