"""Elements with a state of their own in time: Maxwell branches beside the airframe's stiffness, springs that warm up.

A Maxwell branch is a spring k and a dashpot c in series, whose node MuJoCo needs as a
body: it gets the mass c / p for a rate p far above the band, so that the branch errs by at
most half of ω/p of its own spring. Branches stand beside modal coordinates (Mφ)ᵀq:
for a material that relaxes alike everywhere the modes stay uncoupled, and a node a mode
says the same as one in every hinge.

The material is that of the airframe's own joints and of what effects have laid across these. What is bolted on,
or ties one place to another, has springs of another kind: modes are those with every such thing locked, or untied.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.effects.elements import Relaxation, WarmUp
from vgvt.simulation.airframe import ROOT_JOINTS, AirframeParts, elastic_joints
from vgvt.simulation.damping import RIGID_MODES
from vgvt.simulation.linear import linearise

Mode = tuple[float, list[tuple[str, np.float64]]]
"""Angular frequency, and the modal coordinate as joints with their weights."""
NODE_RATE_RAD_PER_S = 2 * np.pi * 1000.0
# Joints with less than this share of the largest momentum carry rounding errors.
_NOTHING = 1e-10
# What a warm-up leaves on the model for springs that come after it.
_WARMING = "/warm-up"
_SIDES = {0: "", 1: "-above", -1: "-below"}
# More than any spring's torque.
_ANY_N_M = 1e9


def add_relaxations(spec: mujoco.MjSpec, parts: AirframeParts, elements: Sequence[tuple[str, Relaxation]]) -> None:
    """Put each element's branches beside the stiffness of every elastic mode up to its limit, none beside another's."""
    if elements:
        modes = list(_elastic_modes(spec, parts, 2 * np.pi * max(element.limit_hz for _, element in elements)))
        for name, element in elements:
            _add_relaxation(spec, name, element, modes)


def _add_relaxation(spec: mujoco.MjSpec, name: str, element: Relaxation, modes: Sequence[Mode]) -> None:
    """Branches beside modes, as far as the element's limit reaches."""
    for r, (omega, weights) in enumerate(m for m in modes if m[0] <= 2 * np.pi * element.limit_hz):
        stiffness = omega**2
        beside = spec.add_tendon(
            name=f"{name}-{r + 1}",
            stiffness=[element.spring_share * stiffness, 0.0, 0.0],
            damping=[element.dashpot_share * stiffness / omega, 0.0, 0.0],
        )
        _wrap(beside, weights)
        for b, (share, corner) in enumerate(element.branches):
            rate = omega * corner if element.relative else 2 * np.pi * corner
            node = f"{name}-{r + 1}-{b + 1}"
            _add_node(spec, node, share * stiffness / rate)
            spring = spec.add_tendon(name=node, stiffness=[share * stiffness, 0.0, 0.0])
            _wrap(spring, [*weights, (node, -1.0)])


def add_warm_up(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: WarmUp) -> None:
    """Warm every spring of the airframe, and by a note on the model those that come later."""
    spec.add_numeric(name=f"{name}{_WARMING}", data=[element.softening, element.time_constant_s, element.begin_s])
    warm_springs(spec, parts)


def warm_springs(spec: mujoco.MjSpec, parts: AirframeParts) -> None:
    """Bring the actuators that soften springs up to date with the airframe's springs; nothing where none warms up.

    Each takes a spring's torque away in proportion to how far that is stretched. Its activation is the warmth: a
    first-order lag of a command that is 1 from the start of the record on, and 0 before. Where that begins at rest the
    command's limits hold it at 1, as MuJoCo clamps whatever it is sent; else the engine sends it.
    """
    for note in [n for n in spec.numerics if n.name.endswith(_WARMING)]:
        softening, time_constant_s, begin_s = (float(v) for v in note.data)
        for spring in _airframe_springs(spec, parts):
            name = f"{note.name.removesuffix(_WARMING)}-{spring.of}{_SIDES[spring.side]}"
            warmth = spec.actuator(name) or spec.add_actuator(name=name, trntype=spring.kind, target=spring.of)
            warmth.dyntype = mujoco.mjtDyn.mjDYN_FILTER
            warmth.dynprm[0] = time_constant_s
            taken = softening * spring.stiffness_n_m_per_rad
            warmth.gaintype = mujoco.mjtGain.mjGAIN_AFFINE
            warmth.gainprm[:3] = [-taken * spring.rest_rad, taken, 0.0]
            warmth.ctrllimited = True
            warmth.ctrlrange = [0.0, 1.0] if begin_s > 0 else [1.0, 1.0 + 1e-9]
            if spring.side:
                # Within the gap there is nothing to take: there the torque would have the other sign.
                warmth.forcelimited = True
                warmth.forcerange = [0.0, _ANY_N_M] if spring.side * softening > 0 else [-_ANY_N_M, 0.0]


@dataclass(frozen=True, slots=True)
class _Spring:
    """A linear spring of a joint or tendon, at rest there; with a ``side``, only above that (1) or below (-1)."""

    kind: mujoco.mjtTrn
    of: str
    stiffness_n_m_per_rad: float
    rest_rad: float = 0.0
    side: int = 0


def _airframe_springs(spec: mujoco.MjSpec, parts: AirframeParts) -> Iterator[_Spring]:
    """The springs of the airframe's own joints, and those that effects have laid across them so far."""
    own = set(elastic_joints(parts))
    for joint in spec.joints:
        if joint.name in own:
            yield _Spring(mujoco.mjtTrn.mjTRN_JOINT, joint.name, float(joint.stiffness[0]))
    for tendon in spec.tendons:
        wraps = (wrap.target.name for wrap in tendon.path if wrap.type == mujoco.mjtWrap.mjWRAP_JOINT)
        if tendon.stiffness[0] == 0 or own.isdisjoint(wraps):
            continue
        low, high = (float(v) for v in tendon.springlength)
        stops = ((low, -1), (high, 1)) if low < high else ((0.0, 0),)
        for rest, side in stops:
            yield _Spring(mujoco.mjtTrn.mjTRN_TENDON, tendon.name, float(tendon.stiffness[0]), rest, side)


def _elastic_modes(spec: mujoco.MjSpec, parts: AirframeParts, limit_rad_per_s: float) -> Iterator[Mode]:
    """Angular frequency and modal coordinate, as joints with their weights, of the elastic modes of the airframe.

    Of its own springs alone, and all that hangs on it by other joints locked: it is carried along.
    """
    model = spec.compile()
    material = {spring.of for spring in _airframe_springs(spec, parts) if spring.kind == mujoco.mjtTrn.mjTRN_TENDON}
    for t in range(model.ntendon):
        if model.tendon(t).name not in material:
            model.tendon_stiffness[t] = 0.0
    bare = linearise(model, np.zeros(model.nq))
    own = {*ROOT_JOINTS, *elastic_joints(parts)}
    joints = sorted((int(model.joint(j).dofadr[0]), model.joint(j).name) for j in range(model.njnt))
    joints = [(address, name) for address, name in joints if name in own]
    kept = np.ix_(*[[address for address, _ in joints]] * 2)
    mass = bare.mass[kept]
    eigenvalues, shapes = scipy.linalg.eigh(bare.stiffness[kept], mass)
    for square, shape in list(zip(eigenvalues, shapes.T, strict=True))[RIGID_MODES:]:
        if not 0 < square <= limit_rad_per_s**2:
            continue
        momentum: NDArray[np.float64] = mass @ shape
        # Of two signs the same for aircraft next to each other: a node's coordinate goes with it, and a slope is taken
        # across it. Weights are unlike each other, so that a mode of two halves that swing against each other has one.
        momentum *= np.copysign(1.0, momentum @ np.linspace(1.0, 2.0, momentum.size))
        least = _NOTHING * np.abs(momentum).max()
        weights = zip(joints, momentum, strict=True)
        yield float(np.sqrt(square)), [(name, weight) for (_, name), weight in weights if abs(weight) > least]


def _wrap(tendon: mujoco.MjsTendon, weights: Iterable[tuple[str, float]]) -> None:
    for joint, weight in weights:
        tendon.wrap_joint(joint, float(weight))


def _add_node(spec: mujoco.MjSpec, name: str, damper_n_s_per_m: float) -> None:
    """A node of a branch, with its dashpot to the ground: a coordinate, not a place."""
    body = spec.worldbody.add_body(name=name)
    body.add_joint(
        name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(1.0, 0.0, 0.0), damping=[damper_n_s_per_m, 0.0, 0.0]
    )
    body.explicitinertial = True
    body.ipos = np.zeros(3)
    body.mass = damper_n_s_per_m / NODE_RATE_RAD_PER_S
    body.inertia = np.full(3, 1e-3 * body.mass)
