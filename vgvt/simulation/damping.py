"""Structural damping that gives each mode of the bare airframe the ratio the scenario asks for.

A fixed tendon over the elastic joints with the coefficients M φ and the damper
d adds d (Mφ)(Mφ)ᵀ to C: damping of one mode and no other, and none of the rigid
body, whose joints have no share in M φ. Above the limit plain joint dampers
take over, in proportion to stiffness, which also keep the chain's highest,
physically meaningless modes quiet; what they add below is taken off the tendons.

The more cells, the higher is the highest mode, and the less the joints may have for a step to hold: what a fine
chain's lack, tendons give, as far as modes are near enough to be seen at the end of a band. So damping is no matter
of the cells.

A joint that is no cell of a beam, at a root or between halves of the body, may be as stiff as one likes: how much
damping has room is judged with these locked, and each has no more than its own motion can be stepped with. So an
aircraft whose joint is nearly rigid is damped as one that has none.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
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
# Times the limit. What swings farther off is felt up to there by its stiffness: damping turns that by 2 ζ / 3 at most.
_NEAR = 3.0
# Of its damping, less than this is nothing that a mode lacks.
_NOTHING = 1e-6
# Modes that are named where there are many.
_TOLD = 4


@dataclass(frozen=True, slots=True, eq=False)
class StructuralDamping:
    """Dampers of a bare airframe: of every elastic joint in proportion to its stiffness, and of some modes besides.

    ``per_stiffness_s`` times a cell's stiffness is its damper, of each of ``joints``, by name, ``own_s`` (elastic
    joints,) times its stiffness. A mode's damper ``coefficients`` (modes,) acts on ``weights`` (modes, elastic joints)
    times their velocities: of some of all elastic modes, whose frequencies are ``natural_frequency_hz``. The
    first ``stated`` of them are those up to the scenario's limit; further ones have the damping ratio
    ``growth_s`` ω / 2, by their joints or beside them.
    """

    per_stiffness_s: float
    growth_s: float
    stated: int
    joints: tuple[str, ...]
    own_s: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    weights: NDArray[np.float64]
    natural_frequency_hz: NDArray[np.float64]

    @classmethod
    def of(cls, spec: mujoco.MjSpec, damping: Damping, connecting: Collection[str] = ()) -> StructuralDamping:
        """What gives the bare airframe of ``spec`` the ratios that a scenario states.

        ``connecting`` are joints that are no cells of a beam, by name. A control surface that is loose changes the
        modes, not what the structure loses: ``spec`` has it locked.
        """
        model = spec.compile()
        # In its unloaded shape and without weight the bare airframe has the stiffness of its joints and no other.
        mass = mass_matrix(model, mujoco.MjData(model))
        eigenvalues, shapes = scipy.linalg.eigh(_stiffness(model), mass)
        omega = np.sqrt(np.maximum(eigenvalues[RIGID_MODES:], 0.0))
        shapes = shapes[:, RIGID_MODES:]
        limit = 2 * np.pi * damping.limit_hz
        ratios = np.full(omega.size, damping.damping_ratio)
        ratios[: len(damping.modal)] = damping.modal[: omega.size]
        exact = omega <= limit
        fixed = [int(model.joint(name).dofadr[0]) for name in connecting]
        fastest = _fastest(model.jnt_stiffness, mass, fixed) if fixed else omega.max(initial=0.0)
        # As much joint damping as leaves every tendon something to give and the default ratio at the limit ...
        growth = 2 * min(damping.damping_ratio / limit, (ratios[exact] / omega[exact]).min(initial=np.inf))
        # ... and the chain's highest mode, far faster than anything of interest, an oscillation that can be stepped.
        per_stiffness = min(growth, 2 * _HIGHEST_RATIO / fastest) if fastest else growth
        own_s = np.full(model.nv, per_stiffness)
        # Where a joint is stiffer than all around it, it moves against inertia alone.
        alone = np.sqrt(model.jnt_stiffness[fixed] * np.linalg.inv(mass)[fixed, fixed])
        own_s[fixed] = np.minimum(per_stiffness, 2 * _HIGHEST_RATIO / alone)
        elastic = _elastic(model)
        addresses = model.jnt_dofadr[elastic]
        names = tuple(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, k) for k in elastic)
        spared = ((per_stiffness - own_s) * model.jnt_stiffness) @ shapes**2
        whole = np.where(exact, 2 * ratios * omega, growth * omega**2)
        own = whole - (per_stiffness * omega**2 - spared)
        given = exact | ((omega <= _NEAR * limit) & (own > _NOTHING * whole))
        weights = (mass @ shapes[:, given])[addresses].T
        return cls(
            float(per_stiffness),
            float(growth),
            int(exact.sum()),
            names,
            own_s[addresses],
            own[given],
            weights,
            omega / (2 * np.pi),
        )

    def without_effect(self, damping: Damping) -> str | None:
        """What is to be said of the last ratios of ``damping.modal``, where they go to no mode; None where all do.

        Not an error: a fit or a change of stiffness may carry a mode across the limit.
        """
        given, exact, count = len(damping.modal), self.stated, self.natural_frequency_hz.size
        if given <= exact:
            return None
        what = f"airframe.damping.modal has {given} ratios, of which the last {given - exact} go to no mode"
        if given > count:
            what += f": there are {count} elastic modes"
        above = self.natural_frequency_hz[exact:given]
        if not above.size:
            return f"{what}; leave them out"
        theirs = ", ".join(f"{100 * np.pi * self.growth_s * hz:.2f} % at {hz:.5g} Hz" for hz in above[:_TOLD])
        theirs += " …" if above.size > _TOLD else ""
        return (
            f"{what}{' and' if given > count else ':'} above limit_hz {damping.limit_hz:g} damping grows with "
            f"frequency, {theirs}; write limit_hz = {np.ceil(above[-1]) + 1:g}, or leave them out"
        )

    def damp_joints(self, spec: mujoco.MjSpec) -> None:
        """Add the joints' own dampers to the airframe's ``spec``."""
        for name, seconds in zip(self.joints, self.own_s, strict=True):
            joint = spec.joint(name)
            joint.damping = [seconds * joint.stiffness[0], 0.0, 0.0]

    def modal_matrix(self, joints: Sequence[str]) -> NDArray[np.float64]:
        """What the modes' dampers add to the damping matrix (n, n) over coordinates named ``joints``."""
        out = np.zeros((len(joints), len(joints)))
        index = [joints.index(name) for name in self.joints]
        out[np.ix_(index, index)] = (self.weights.T * self.coefficients) @ self.weights
        return out


def _stiffness(model: mujoco.MjModel) -> NDArray[np.float64]:
    """Stiffness (n, n) of joints, and of tendons across them."""
    stiffness = np.diag(model.jnt_stiffness)
    for t in np.flatnonzero(model.tendon_stiffness):
        wraps = slice(model.tendon_adr[t], model.tendon_adr[t] + model.tendon_num[t])
        row = np.zeros(model.nv)
        row[model.jnt_dofadr[model.wrap_objid[wraps]]] = model.wrap_prm[wraps]
        stiffness += model.tendon_stiffness[t] * np.outer(row, row)
    return stiffness


def _elastic(model: mujoco.MjModel) -> list[int]:
    """Joints with a spring, their own or a tendon's, by number: as MuJoCo builds a tendon's row fastest."""
    geared = model.wrap_objid[model.wrap_type == mujoco.mjtWrap.mjWRAP_JOINT]
    return sorted({*np.flatnonzero(model.jnt_stiffness > 0).tolist(), *geared.tolist()})


def _fastest(stiffness: NDArray[np.float64], mass: NDArray[np.float64], fixed: Sequence[int]) -> float:
    """The highest natural frequency, rad/s, of joints' ``stiffness`` (n,) and ``mass`` (n, n) with some fixed."""
    free = np.setdiff1d(np.arange(stiffness.size), fixed)
    squares = scipy.linalg.eigh(np.diag(stiffness[free]), mass[np.ix_(free, free)], eigvals_only=True)
    return float(np.sqrt(max(squares[-1], 0.0)))


def add_structural_damping(spec: mujoco.MjSpec, found: StructuralDamping) -> None:
    """Add tendons and joint dampers to the bare airframe's ``spec`` (before rig and instruments are)."""
    found.damp_joints(spec)
    for r, (coefficient, weights) in enumerate(zip(found.coefficients, found.weights, strict=True)):
        tendon = spec.add_tendon(name=f"{MODAL_DAMPING}{r + 1}", damping=[coefficient, 0.0, 0.0])
        for name, weight in zip(found.joints, weights, strict=True):
            tendon.wrap_joint(name, weight)
