"""Mechanical elements that an effect can add, as data; the simulation knows how to build each.

Positions are in aircraft axes of the unloaded shape, metres; ``part`` is 'body'
or a beam. ``owner`` says what an element belongs to: elements of the airframe are
part of the bare aircraft's truth, those of the rig are not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Vector = tuple[float, float, float]
Owner = Literal["airframe", "rig"]
_UP: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class PointMass:
    """A lumped mass; negative values are not possible: take it from an item of the airframe instead.

    One of the airframe is shared by the rigid bodies around it, as the airframe's own items are.
    ``frame_kg`` rides on the frame that the suspension hangs from besides, and counts where an effect lets that move.
    """

    part: str
    position_m: Vector
    mass_kg: float
    owner: Owner = "airframe"
    frame_kg: float = 0.0


@dataclass(frozen=True, slots=True)
class GroundSpring:
    """Spring and dashpot from a point of the aircraft to the ground, along a direction, at rest as hung.

    The direction is fixed in space, up by default, or ``turns_with_part`` to how that hangs.
    With a ``node`` it holds the accelerometer of that label, wherever other effects put this.
    """

    part: str
    position_m: Vector
    stiffness_n_per_m: float
    damping_n_s_per_m: float = 0.0
    direction: Vector = _UP
    owner: Owner = "rig"
    node: int | None = None
    turns_with_part: bool = False


@dataclass(frozen=True, slots=True)
class RotationSpring:
    """Spring and dashpot on the rotation of the centre body about one of its axes, at rest as hung.

    ``gauge_per_m`` is what the force gauge of an exciter (counted from 0) reads of its moment, N per N m.
    """

    axis: Literal["roll", "pitch", "yaw"]
    stiffness_n_m_per_rad: float
    damping_n_m_s_per_rad: float = 0.0
    gauge_per_m: float = 0.0
    exciter: int = 0
    owner: Owner = "rig"


@dataclass(frozen=True, slots=True)
class Absorber:
    """A mass on a spring and dashpot that slides along a direction fixed to the aircraft; ``kind`` names its mode.

    Where an effect lets the suspension's frame move, spring and dashpot act on what the mass slides by less
    ``frame_share`` of what the frame rises by.
    """

    part: str
    position_m: Vector
    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    direction: Vector = _UP
    kind: Literal["absorber", "surge"] = "absorber"
    owner: Owner = "airframe"
    frame_share: float = 0.0


@dataclass(frozen=True, slots=True)
class MountCompliance:
    """Spring and dashpot between structure and force transducer of an exciter (counted from 0), along the stinger.

    Pulled by more than ``preload_n`` it keeps only the fraction ``tension_ratio`` of its stiffness; with
    ``gap_m`` it has none at all over that way, and all of it beyond.
    """

    stiffness_n_per_m: float
    damping_n_s_per_m: float
    tension_ratio: float = 1.0
    preload_n: float = 0.0
    gap_m: float = 0.0
    exciter: int = 0
    owner: Owner = "rig"


@dataclass(frozen=True, slots=True)
class ModalDrag:
    """A force d |q'| q' on the coordinate q, mass-normalised, of every mode with a damping ratio of its own."""

    drag_per_rtkg_m: float
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class GivenRoot:
    """The stiffness that an effect, by its name, gives a root which it does not find jointed, and whether it did."""

    effect: str
    stiffness_n_m_per_rad: float
    was_rigid: bool


@dataclass(frozen=True, slots=True)
class JointLaw:
    """Another force law for a root joint of a beam: k θ + k3 θ³, Coulomb friction, play around zero.

    ``stiffness_n_m_per_rad`` replaces the joint's own; ``play_rad`` is the half gap.
    The scenario must give the beam that root joint; ``beam`` is a name after mirroring. ``root`` is what the effect
    would have made of a rigid one.
    """

    beam: str
    kind: Literal["bending", "torsion"]
    stiffness_n_m_per_rad: float
    cubic_n_m_per_rad3: float = 0.0
    friction_n_m: float = 0.0
    play_rad: float = 0.0
    owner: Owner = "airframe"
    root: GivenRoot | None = None


@dataclass(frozen=True, slots=True)
class SuspensionFrame:
    """What the spring hangs from: a mass that moves up and down on a spring and dashpot to the ground."""

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    owner: Owner = "rig"


@dataclass(frozen=True, slots=True)
class SuspensionCubic:
    """A force c x³ beside the suspension's spring, x its change of length from that as hung."""

    cubic_n_per_m3: float
    owner: Owner = "rig"


@dataclass(frozen=True, slots=True)
class BendTwist:
    """Coupling of bending and torsion along a beam (a name after mirroring), K = ``coupling`` sqrt(EI GJ).

    Positive: the leading edge goes up as the beam bends up.
    """

    beam: str
    coupling: float
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class HingedFlap:
    """A rigid flap on a sprung hinge; ``inertia_kg_m2`` about its centre of gravity. Trim holds it in line as it hangs.

    With ``gap_rad`` the spring has play, against one side of which the flap's weight leans it as it hangs.
    """

    part: str
    hinge_m: Vector
    hinge_axis: Vector
    centre_of_gravity_m: Vector
    mass_kg: float
    inertia_kg_m2: Vector
    stiffness_n_m_per_rad: float
    damping_n_m_s_per_rad: float
    gap_rad: float = 0.0
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class PointPair:
    """Spring and dashpot on the difference of two points' heights above the rigid centre body, at rest as hung."""

    part: str
    position_m: Vector
    other_part: str
    other_position_m: Vector
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class RattlingMass:
    """A mass that lies on the lower of two stops and can jump to the upper one, ``gap_m`` above, along the vertical."""

    part: str
    position_m: Vector
    mass_kg: float
    gap_m: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class Relaxation:
    """Maxwell branches (spring and dashpot in series) beside the airframe's stiffness, the same for every elastic mode.

    Its modes are those with all locked that hangs on it by springs of another kind, and with no ties between places.
    ``branches`` are pairs of a branch's spring over the stiffness it stands beside and its
    corner: in hertz, or, ``relative``, in multiples of each mode's own frequency. To
    that come a plain spring and a plain dashpot, the latter by its share of the stiffness at
    the mode's own frequency. Modes up to ``limit_hz`` have them; the sum over all modes is the material's own law.
    """

    limit_hz: float
    branches: tuple[tuple[float, float], ...]
    relative: bool = False
    spring_share: float = 0.0
    dashpot_share: float = 0.0
    owner: Owner = "airframe"


@dataclass(frozen=True, slots=True)
class WarmUp:
    """The airframe's springs lose a share of their stiffness while a record runs: k (1 - softening (1 - exp(-t/T))).

    Those that other effects lay across its joints lose theirs with them; the cubic part of a law stays. t counts from
    ``begin_s`` after rest: where the record begins, which is when the shaker starts or later.
    """

    softening: float
    time_constant_s: float
    owner: Owner = "airframe"
    begin_s: float = 0.0


Element = (
    PointMass
    | GroundSpring
    | RotationSpring
    | Absorber
    | MountCompliance
    | JointLaw
    | ModalDrag
    | SuspensionFrame
    | SuspensionCubic
    | BendTwist
    | HingedFlap
    | PointPair
    | RattlingMass
    | Relaxation
    | WarmUp
)
