"""A modal model: an identifier's claim and the truth are the same type."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from vgvt.data.candidates import PoleCandidate
from vgvt.data.dof import Dof
from vgvt.data.mode_numbers import mode_table
from vgvt.data.shown import counted, headed, listed

_Scalar = TypeVar("_Scalar", bound=np.generic)


class Outcome(StrEnum):
    """How an identification ended; ``detail`` of the model says more in words."""

    FOUND = "found"
    NOTHING_FOUND = "nothing_found"
    DECLINED = "declined"
    NOT_CONVERGED = "not_converged"


@dataclass(frozen=True, slots=True, eq=False)
class ModalModel:
    """Natural frequencies, damping ratios and mode shapes, in order of frequency.

    Shapes: ``natural_frequency_hz`` and ``damping_ratio`` (M,), ``shapes``
    (M, D) complex over ``dofs``; the sign and scale of a shape carry no meaning
    unless ``modal_mass_kg`` is given (then the shape is in the scale of that
    mass). Standard deviations are NaN where a method states none. ``residues``
    (M, D, R) are those of the receptance per reference,
    H(s) = sum R / (s - p) + conj, in m/(N s). ``labels`` name a mode in words; ``flags``
    is a tuple of short remarks per mode. ``advice`` is for people: why nothing
    was found, what was left out, what to try. ``candidates`` are all poles that
    a method with a stabilisation diagram weighed, claimed or not. ``output_only`` is true of a claim that was made
    without the force: its modes are those of aircraft and shaker together.

    Accelerometers feel gravity as they tilt, and records do not tell the two apart. Shapes and the responses of
    residues, of claims and of the truth, are what accelerometers feel (but for true modes an octave and more below the
    swept band, whose residues are the displacement's). The force of a residue acts through the displacement alone, and
    by it go the scale of a true shape and its modal mass.
    """

    natural_frequency_hz: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    shapes: NDArray[np.complex128]
    dofs: tuple[Dof, ...]
    natural_frequency_std_hz: NDArray[np.float64] | None = None
    damping_ratio_std: NDArray[np.float64] | None = None
    modal_mass_kg: NDArray[np.float64] | None = None
    references: tuple[Dof, ...] = ()
    residues: NDArray[np.complex128] | None = None
    labels: tuple[str, ...] = ()
    flags: tuple[tuple[str, ...], ...] = ()
    method: str = ""
    outcome: Outcome = Outcome.FOUND
    advice: tuple[str, ...] = ()
    settings: dict[str, str] = field(default_factory=dict)
    candidates: tuple[PoleCandidate, ...] = ()
    output_only: bool = False

    def __post_init__(self) -> None:
        modes = self.natural_frequency_hz.size
        expected: dict[str, tuple[int, ...]] = {
            "natural_frequency_hz": (modes,),
            "damping_ratio": (modes,),
            "shapes": (modes, len(self.dofs)),
            "natural_frequency_std_hz": (modes,),
            "damping_ratio_std": (modes,),
            "modal_mass_kg": (modes,),
            "residues": (modes, len(self.dofs), len(self.references)),
        }
        for name, shape in expected.items():
            array = getattr(self, name)
            if array is not None and array.shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
        if not (np.isfinite(self.natural_frequency_hz) & (self.natural_frequency_hz >= 0)).all():
            raise ValueError("natural_frequency_hz must be finite and at least 0")
        # Along an axis and against it is one DOF: a shape has one value there.
        if len({(dof.node, abs(dof.direction)) for dof in self.dofs}) < len(self.dofs):
            unsigned = [dof.unsigned for dof in self.dofs]
            twice = sorted({str(dof) for dof in unsigned if unsigned.count(dof) > 1})
            raise ValueError(f"dofs must be there once each; twice: {', '.join(twice)}")
        if np.any(np.diff(self.natural_frequency_hz) < 0):
            raise ValueError("modes must be in order of natural frequency")
        for name in ("labels", "flags"):
            if getattr(self, name) and len(getattr(self, name)) != modes:
                raise ValueError(f"{name} must name every mode ({modes}) or none")

    def __repr__(self) -> str:
        method = f" ({self.method})" if self.method else ""
        seen = [counted(len({dof.node for dof in self.dofs}), "point")]
        seen += [f"force at {listed(self.references)}"] if self.references else []
        seen += ["without the force"] if self.output_only else []
        seen += [] if self.outcome is Outcome.FOUND else [self.outcome.value.replace("_", " ")]
        head = headed(f"ModalModel{method}: {counted(len(self), 'mode')}, {', '.join(seen)}", self.advice, most=2)
        return f"{head}\n{mode_table(self)}" if len(self) else head

    def __len__(self) -> int:
        return int(self.natural_frequency_hz.size)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles with positive imaginary part, rad/s, shape (M,)."""
        omega = 2 * np.pi * self.natural_frequency_hz
        root = np.sqrt(np.maximum(1 - self.damping_ratio**2, 0))
        return np.asarray(omega * (-self.damping_ratio + 1j * root))

    def select(self, index: NDArray[np.intp] | NDArray[np.bool_] | list[int]) -> ModalModel:
        """The modes at ``index`` (indices or mask), in that order; the candidates stay."""
        chosen = np.asarray(index)
        rows = np.arange(len(self))[chosen] if len(self) and chosen.size else np.empty(0, dtype=int)

        def pick(array: NDArray[_Scalar] | None) -> NDArray[_Scalar] | None:
            return None if array is None else array[rows]

        return replace(
            self,
            natural_frequency_hz=self.natural_frequency_hz[rows],
            damping_ratio=self.damping_ratio[rows],
            shapes=self.shapes[rows],
            natural_frequency_std_hz=pick(self.natural_frequency_std_hz),
            damping_ratio_std=pick(self.damping_ratio_std),
            modal_mass_kg=pick(self.modal_mass_kg),
            residues=pick(self.residues),
            labels=tuple(self.labels[i] for i in rows) if self.labels else (),
            flags=tuple(self.flags[i] for i in rows) if self.flags else (),
        )

    def band(self, low_hz: float, high_hz: float) -> ModalModel:
        """The modes with low_hz <= f <= high_hz."""
        f = self.natural_frequency_hz
        return self.select((f >= low_hz) & (f <= high_hz))

    def at(self, dofs: tuple[Dof, ...]) -> ModalModel:
        """The same modes seen at other DOFs of the model; KeyError names the missing ones.

        A DOF along the opposite direction is taken with the sign changed.
        """
        known = {d: i for i, d in enumerate(self.dofs)}
        unsigned = {d.unsigned: (i, d.direction.sign) for d, i in known.items()}
        missing = [str(d) for d in dofs if d.unsigned not in unsigned]
        if missing:
            raise KeyError(f"the modal model has no DOF {', '.join(missing)}")
        index = [unsigned[d.unsigned][0] for d in dofs]
        sign = np.array([unsigned[d.unsigned][1] * d.direction.sign for d in dofs], dtype=float)
        return replace(
            self,
            dofs=dofs,
            shapes=self.shapes[:, index] * sign,
            residues=None if self.residues is None else self.residues[:, index] * sign[:, None],
        )

    @classmethod
    def empty(
        cls, outcome: Outcome, advice: tuple[str, ...], method: str = "", dofs: tuple[Dof, ...] = ()
    ) -> ModalModel:
        """A model without modes that says why."""
        return cls(
            natural_frequency_hz=np.empty(0),
            damping_ratio=np.empty(0),
            shapes=np.empty((0, len(dofs)), dtype=complex),
            dofs=dofs,
            method=method,
            outcome=outcome,
            advice=advice,
        )
