"""The sealed truth of a synthetic campaign."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vgvt.data.modal import ModalModel
from vgvt.data.mode_numbers import mode_table
from vgvt.data.shown import counted, headed


class TrueModes(StrEnum):
    """Which true modes a claim is judged by: those as tested, or with the shaker attached where no force is used."""

    AS_TESTED = "as_tested"
    COUPLED = "coupled"


@dataclass(frozen=True, slots=True, eq=False)
class RigidBodyProperties:
    """Mass, centre of gravity (3,) and inertia (3, 3) about it, in aircraft axes."""

    mass_kg: float
    centre_of_gravity_m: NDArray[np.float64]
    inertia_kg_m2: NDArray[np.float64]

    def __repr__(self) -> str:
        centre, moments = (
            ", ".join(f"{number:.4g}" for number in numbers)
            for numbers in (self.centre_of_gravity_m, np.diag(self.inertia_kg_m2))
        )
        about = f"centre of gravity ({centre}) m, moments of inertia {moments} kg m^2"
        return headed(f"RigidBodyProperties: {self.mass_kg:.4g} kg, {about}")


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What the simulator knows and no identifier may see.

    ``bare``: the airframe alone, free-free, without gravity. ``as_tested``: per
    run, hung and instrumented, with the force at the transducer's sensing
    element as the input (the poles of A/F); its standard deviations are the smallest
    that the run's force, noise and sensors allow any unbiased method. ``coupled``: per run, with the
    shaker attached and driven (the poles of A/drive, which the responses show by themselves);
    its residues are for a unit of command, volts or the hammer's newtons. Shapes of both
    are those that accelerometers feel. ``runs`` are the run numbers of the last two.
    """

    scenario: str
    rigid_body: RigidBodyProperties
    bare: ModalModel
    runs: tuple[int, ...]
    as_tested: tuple[ModalModel, ...]
    coupled: tuple[ModalModel, ...]

    def __post_init__(self) -> None:
        if not len(self.runs) == len(self.as_tested) == len(self.coupled):
            raise ValueError("runs, as_tested and coupled must have one entry a run")

    def __repr__(self) -> str:
        free = counted(len(self.bare), "mode")
        head = (
            f"Truth of {self.scenario}: {self.rigid_body.mass_kg:.4g} kg, {free} bare, {counted(len(self.runs), 'run')}"
        )
        if not self.runs:
            return headed(head)
        return f"{headed(head, [f'as tested in run {self.runs[0]}:'])}\n{mode_table(self.as_tested[0])}".rstrip()

    def of_runs(self, which: TrueModes) -> tuple[ModalModel, ...]:
        """The modes as tested or with the shaker attached, one model a run."""
        return self.coupled if which is TrueModes.COUPLED else self.as_tested
