"""Where 'adequate' ends and a name begins: quantiles over campaigns without any effect, with their provenance."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

_STORED = Path(__file__).with_name("thresholds.toml")


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Limits that campaigns without any effect stay below; ``provenance`` says which.

    χ² per degree of freedom of the fit, of its smooth part and of held-out data; ``evidence_nats`` the largest
    gain of evidence that an effect that is not there reaches; ``set_nats`` how near candidates count as equal.
    """

    chi2_per_dof: float
    smooth_per_dof: float
    held_out_per_dof: float
    evidence_nats: float
    set_nats: float
    provenance: str


def stored_thresholds() -> Thresholds:
    """The thresholds that are shipped, with where they come from."""
    return thresholds_of(_STORED)


def thresholds_of(path: Path) -> Thresholds:
    """Thresholds from a TOML file with a number for every field and the provenance in words."""
    return Thresholds(**tomllib.loads(path.read_text(encoding="utf-8")))
