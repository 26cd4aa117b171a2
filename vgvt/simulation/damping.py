"""Structural damping that gives each mode of the bare airframe the ratio the scenario asks for.

A fixed tendon over the elastic joints with the coefficients M φ and the damper
d adds d (Mφ)(Mφ)ᵀ to C: damping of one mode and no other, and none of the rigid
body, whose joints have no share in M φ. Above the limit plain joint dampers
take over, in proportion to stiffness, which also keep the chain's highest,
physically meaningless modes quiet; what they add below is taken off the tendons.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.scenario.airframe import Damping
from vgvt.simulation.linear import mass_matrix

RIGID_MODES = 6
MODAL_DAMPING = "modal-damping-"
_HIGHEST_RATIO = 0.7
# Modes that are named where there are many.
_TOLD = 4


@dataclass(frozen=True, slots=True, eq=False)
class StructuralDamping:
    """Dampers of a bare airframe: of every elastic joint in proportion to its stiffness, and of some modes besides.

    ``per_stiffness_s`` times a joint's stiffness is its damper. A mode's damper ``coefficients`` (modes,) acts on
    ``weights`` (modes, elastic joints) times the velocities of ``joints``, by name: of the first of all elastic modes,
    whose frequencies are ``natural_frequency_hz``.
    """

    per_stiffness_s: float
    joints: tuple[str, ...]
    coefficients: NDArray[np.float64]
    weights: NDArray[np.float64]
    natural_frequency_hz: NDArray[np.float64]

    @classmethod
    def of(cls, spec: mujoco.MjSpec, damping: Damping) -> StructuralDamping:
        """What gives the bare airframe of ``spec`` the ratios that a scenario states.

        A control surface that is loose changes the modes, not what the structure loses: ``spec`` has it locked.
        """
        model = spec.compile()
        # In its unloaded shape and without weight the bare airframe has the stiffness of its joints and no other.
        mass = mass_matrix(model, mujoco.MjData(model))
        eigenvalues, shapes = scipy.linalg.eigh(np.diag(model.jnt_stiffness), mass)
        omega = np.sqrt(np.maximum(eigenvalues[RIGID_MODES:], 0.0))
        shapes = shapes[:, RIGID_MODES:]
        limit = 2 * np.pi * damping.limit_hz
        ratios = np.full(omega.size, damping.damping_ratio)
        ratios[: len(damping.modal)] = damping.modal[: omega.size]
        exact = omega <= limit
        # As much joint damping as leaves every tendon something to give, the default ratio at the limit, and the
        # chain's highest mode, a thousand times faster than anything of interest, an oscillation that can be stepped.
        per_stiffness = 2 * min(
            damping.damping_ratio / limit,
            (ratios[exact] / omega[exact]).min(initial=np.inf),
            _HIGHEST_RATIO / omega[-1] if omega.size else np.inf,
        )
        elastic = [(int(model.joint(j.name).dofadr[0]), j.name) for j in spec.joints if j.stiffness[0] > 0]
        # MuJoCo builds a tendon's row fastest from joints in the order of their coordinates.
        elastic.sort()
        addresses = [address for address, _ in elastic]
        names = tuple(name for _, name in elastic)
        own = (2 * ratios * omega - per_stiffness * omega**2)[exact]
        return cls(float(per_stiffness), names, own, (mass @ shapes[:, exact])[addresses].T, omega / (2 * np.pi))

    def without_effect(self, damping: Damping) -> str | None:
        """What is to be said of the last ratios of ``damping.modal``, where they go to no mode; None where all do.

        Not an error: a fit or a change of stiffness may carry a mode across the limit.
        """
        given, exact, count = len(damping.modal), self.coefficients.size, self.natural_frequency_hz.size
        if given <= exact:
            return None
        what = f"airframe.damping.modal has {given} ratios, of which the last {given - exact} go to no mode"
        if given > count:
            what += f": there are {count} elastic modes"
        above = self.natural_frequency_hz[exact:given]
        if not above.size:
            return f"{what}; leave them out"
        theirs = ", ".join(f"{100 * np.pi * self.per_stiffness_s * hz:.2f} % at {hz:.5g} Hz" for hz in above[:_TOLD])
        theirs += " …" if above.size > _TOLD else ""
        return (
            f"{what}{' and' if given > count else ':'} above limit_hz {damping.limit_hz:g} damping grows with "
            f"frequency, {theirs}; write limit_hz = {np.ceil(above[-1]) + 1:g}, or leave them out"
        )

    def damp_joints(self, spec: mujoco.MjSpec) -> None:
        """Add the joints' own dampers to the airframe's ``spec``."""
        for name in self.joints:
            joint = spec.joint(name)
            joint.damping = [self.per_stiffness_s * joint.stiffness[0], 0.0, 0.0]

    def modal_matrix(self, joints: Sequence[str]) -> NDArray[np.float64]:
        """What the modes' dampers add to the damping matrix (n, n) over coordinates named ``joints``."""
        out = np.zeros((len(joints), len(joints)))
        index = [joints.index(name) for name in self.joints]
        out[np.ix_(index, index)] = (self.weights.T * self.coefficients) @ self.weights
        return out


def add_structural_damping(spec: mujoco.MjSpec, found: StructuralDamping) -> None:
    """Add tendons and joint dampers to the bare airframe's ``spec`` (before rig and instruments are)."""
    found.damp_joints(spec)
    for r, (coefficient, weights) in enumerate(zip(found.coefficients, found.weights, strict=True)):
        tendon = spec.add_tendon(name=f"{MODAL_DAMPING}{r + 1}", damping=[coefficient, 0.0, 0.0])
        for name, weight in zip(found.joints, weights, strict=True):
            tendon.wrap_joint(name, weight)


def undamped(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """A copy without the modes' dampers: at rest they push nothing, and their rows are most of the work of asking."""
    still = spec.copy()
    for tendon in [t for t in still.tendons if t.name.startswith(MODAL_DAMPING)]:
        still.delete(tendon)
    return still
