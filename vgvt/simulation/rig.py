"""The rig as edits of the airframe's MuJoCo model: suspension, instruments, shaker and stinger."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Shaker, Stinger, Suspension
from vgvt.simulation.airframe import ROOT, AirframeParts

GRAVITY_M_PER_S2 = 9.80665
DRIVE_SITE = "drive-point"
TRANSDUCER = "force-transducer"
STINGER = "stinger"
SUSPENSION = "suspension"
FRAME_SITE = "frame"
HOOK_SITE = "hook"
ARMATURE = "armature"
COIL = "coil"
HAMMER = "hammer"
STRIKE_SITE = "strike-point"
# A lag L/R below this turns the force by less than 0.15 degrees at 40 Hz, and would cost short time steps.
NEGLIGIBLE_LAG_S = 1e-5


def numbered(name: str, exciter: int) -> str:
    """The name of a part of an exciter, counted from 0; the first one's parts have plain names."""
    return name if exciter == 0 else f"{name}-{exciter + 1}"


def hang(spec: mujoco.MjSpec, parts: AirframeParts, suspension: Suspension, hung_mass_kg: float) -> None:
    """Switch gravity on and hang the aircraft by its hook.

    The spring's upper end is as high as it must be for the sag to bring the
    hook back to its height in aircraft axes.
    """
    spec.option.gravity = [0.0, 0.0, -GRAVITY_M_PER_S2]
    hook = np.array(suspension.hook_m)
    carrier = parts.carrier(ROOT, hook)
    spec.body(carrier).add_site(name=HOOK_SITE, pos=hook - parts.origin_m[carrier])
    sag = hung_mass_kg * GRAVITY_M_PER_S2 / suspension.stiffness_n_per_m
    top = hook + np.array([0.0, 0.0, suspension.free_length_m + sag])
    spec.worldbody.add_site(name=FRAME_SITE, pos=top)
    spring = spec.add_tendon(
        name=SUSPENSION,
        stiffness=[suspension.stiffness_n_per_m, 0.0, 0.0],
        damping=[suspension.damping_n_s_per_m, 0.0, 0.0],
        springlength=[suspension.free_length_m, suspension.free_length_m],
    )
    spring.wrap_site(FRAME_SITE)
    spring.wrap_site(HOOK_SITE)
    spec.joint("yaw").stiffness = [suspension.yaw_stiffness_n_m_per_rad, 0.0, 0.0]
    for name in ("yaw", "pitch", "roll"):
        spec.joint(name).damping = [suspension.rotation_damping_n_m_s_per_rad, 0.0, 0.0]
    for name in ("slide-x", "slide-y"):
        spec.joint(name).damping = [suspension.pendulum_damping_n_s_per_m, 0.0, 0.0]


def add_point_mass(
    spec: mujoco.MjSpec, parts: AirframeParts, name: str, carrier: str, position_m: NDArray[np.float64], mass_kg: float
) -> None:
    """A lumped mass at a point (3,) on a rigid body of the airframe, as a body of its own so that it can be weighed."""
    body = spec.body(carrier).add_body(name=name, pos=position_m - parts.origin_m[carrier])
    # MuJoCo needs an inertia; that of a 2 mm ball is nothing here.
    body.explicitinertial = True
    body.ipos = np.zeros(3)  # left out, MuJoCo would add the body's own position once more
    body.mass = max(mass_kg, 1e-12)
    body.inertia = np.full(3, 0.4 * body.mass * 1e-6)


def add_shaker(
    spec: mujoco.MjSpec,
    shaker: Shaker,
    stinger: Stinger,
    drive_point_m: NDArray[np.float64],
    push: NDArray[np.float64],
    exciter: int = 0,
) -> None:
    """The shaker below the hung aircraft's drive point (3,), with a stinger that just fits; one of several by number.

    It is set up as a technician would: the stinger at right angles to the
    surface as it hangs, along the unit vector ``push`` (3,).

    Armature on its flexure, m x'' + c x' + k x = Bl i - F; the stinger a tendon
    that carries tension and compression, whose rest length is its length at
    equilibrium, so that attaching it moves nothing.
    """
    foot = drive_point_m - stinger.length_m * push
    name = numbered(ARMATURE, exciter)
    armature = spec.worldbody.add_body(name=name, pos=foot, gravcomp=1.0)
    armature.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=push,
        stiffness=[shaker.flexure_stiffness_n_per_m, 0.0, 0.0],
        damping=[shaker.flexure_damping_n_s_per_m, 0.0, 0.0],
    )
    armature.explicitinertial = True
    armature.ipos = np.zeros(3)
    armature.mass = shaker.armature_mass_kg + 0.5 * stinger.mass_kg
    armature.inertia = np.full(3, 1e-3 * shaker.armature_mass_kg)
    armature.add_site(name=numbered("stinger-foot", exciter))
    rod = spec.add_tendon(
        name=numbered(STINGER, exciter),
        stiffness=[stinger.axial_stiffness_n_per_m, 0.0, 0.0],
        damping=[stinger.axial_damping_n_s_per_m, 0.0, 0.0],
        springlength=[stinger.length_m, stinger.length_m],
    )
    rod.wrap_site(numbered("stinger-foot", exciter))
    rod.wrap_site(numbered(DRIVE_SITE, exciter))
    _add_coil(spec, shaker, push, exciter)


def add_hammer(spec: mujoco.MjSpec, site: str, axis: NDArray[np.float64], weight: float = 1.0, part: int = 0) -> None:
    """A force on the site along ``axis`` (3,), fixed to it: what the hammer does while it touches, and nothing else.

    Where it hits a beam between two links, it is the sum of several, counted by ``part`` from 0: of its force each has
    its ``weight``.

    The hammer is not a body here: its force is given, not found from its fall, so that what the
    aircraft does during the few milliseconds of contact does not act back on it.
    """
    hammer = spec.add_actuator(name=numbered(HAMMER, part), trntype=mujoco.mjtTrn.mjTRN_SITE, target=site)
    hammer.gear = [*(weight * axis), 0.0, 0.0, 0.0]
    # Integrated like a shaker's command: straight between time steps.
    hammer.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
    hammer.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    hammer.gainprm[0] = 1.0
    if part > 0:
        return
    spec.add_sensor(
        name=HAMMER, type=mujoco.mjtSensor.mjSENS_ACTUATORFRC, objtype=mujoco.mjtObj.mjOBJ_ACTUATOR, objname=HAMMER
    )


def _add_coil(spec: mujoco.MjSpec, shaker: Shaker, push: NDArray[np.float64], exciter: int) -> None:
    """The coil as seen from the armature, driven by the command's rate of change.

    With voltage drive, V = R i + L di/dt + Bl x' is a force Bl V/R less Bl²/R x', both through the lag
    τ = L/R. (MuJoCo's own DC motor applies the current of the *next* step, which errs in first order.)
    The command enters through an integrator, so that it is straight between
    time steps: held in steps it would alias onto the accelerometers.
    """
    per_volt = shaker.amplifier_gain * shaker.force_factor_n_per_a
    target = numbered(ARMATURE, exciter)
    if shaker.drive == "voltage":
        per_volt /= shaker.coil_resistance_ohm
        damper = shaker.force_factor_n_per_a**2 / shaker.coil_resistance_ohm
        if shaker.coil_lag_s > NEGLIGIBLE_LAG_S:
            target = numbered(COIL, exciter)
            _add_lag(spec, push, damper, shaker.coil_lag_s, exciter)
        else:
            _add_damper(spec, numbered(ARMATURE, exciter), damper)
    coil = spec.add_actuator(name=numbered(COIL, exciter), trntype=mujoco.mjtTrn.mjTRN_JOINT, target=target)
    coil.dyntype = mujoco.mjtDyn.mjDYN_INTEGRATOR
    coil.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    coil.gainprm[0] = per_volt


def _add_lag(
    spec: mujoco.MjSpec, push: NDArray[np.float64], damper_n_s_per_m: float, lag_s: float, exciter: int
) -> None:
    """A node for the coil to push on, which brings its force and a damper d to the armature through a lag τ, exactly.

    In the force-current analogy resistance is a damper and inductance a spring, and the node between them is a body.
    Its mass does no harm: with m = d τ, 2d to the ground, and a spring 2d/τ with a damper d beside it to the armature,
    m s² + 3d s + 2d/τ = (d s + 2d/τ)(1 + τ s). So what reaches the armature of a force on the node is 1/(1 + τ s) of
    it, and the armature feels d s/(1 + τ s) + d s, of which the second part is taken from its own damper. The node's
    poles are -1/τ and -2/τ; the second moves nothing but the node.
    """
    name, mass = numbered(COIL, exciter), damper_n_s_per_m * lag_s
    node = spec.worldbody.add_body(name=name, gravcomp=1.0)
    node.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=push, damping=[2 * damper_n_s_per_m, 0.0, 0.0])
    node.explicitinertial = True
    node.ipos = np.zeros(3)
    node.mass = mass
    node.inertia = np.full(3, 1e-3 * mass)
    between = spec.add_tendon(
        name=name, stiffness=[2 * damper_n_s_per_m / lag_s, 0.0, 0.0], damping=[damper_n_s_per_m, 0.0, 0.0]
    )
    between.wrap_joint(name, 1.0)
    between.wrap_joint(numbered(ARMATURE, exciter), -1.0)
    _add_damper(spec, numbered(ARMATURE, exciter), -damper_n_s_per_m)


def _add_damper(spec: mujoco.MjSpec, name: str, damper_n_s_per_m: float) -> None:
    joint = spec.joint(name)
    joint.damping = [float(joint.damping[0]) + damper_n_s_per_m, 0.0, 0.0]


def hung_mass_kg(scenario: Scenario, airframe_mass_kg: float, run: int) -> float:
    """What the spring carries in a run: airframe, accelerometers, and a transducer and half a stinger a shaker."""
    sensors = len(scenario.acquisition.run_nodes[run]) * scenario.accelerometers.mass_kg
    shakers = 0 if scenario.excitation.kind == "impact" else len(scenario.shakers)
    return airframe_mass_kg + sensors + shakers * (scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg)
