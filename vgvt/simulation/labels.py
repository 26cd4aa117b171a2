"""Names for true modes: which kind of motion carries the energy, and on which sides."""

from __future__ import annotations

from collections import Counter

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from vgvt.simulation.airframe import ROOT_JOINTS, AirframeParts
from vgvt.simulation.chain import Chain

_RIGID_NAMES = {
    "slide-x": "fore-aft swing",
    "slide-y": "sideways swing",
    "slide-z": "heave",
    "yaw": "yaw",
    "pitch": "pitch",
    "roll": "roll",
}
_ORDINALS = {1: "1st", 2: "2nd", 3: "3rd"}


def mode_labels(
    parts: AirframeParts, model: mujoco.MjModel, mass: NDArray[np.float64], vectors: NDArray[np.complex128]
) -> tuple[str, ...]:
    """Labels like '1st symmetric bending' or 'heave' for modes ``vectors`` (nv, R), in their order.

    ``mass`` (nv, nv) is the inertia that the modes belong to, that at their equilibrium: an aircraft with a
    lump on one wing may hang at ten degrees of roll.

    A mode is rigid where more than half of its kinetic energy is that of a motion without deformation,
    the M-orthogonal projection on the six coordinates of the centre body; free of the ground that share is 0 for
    every elastic mode, and a soft suspension leaves it near 1 for the others. Rigid names are given one to one
    so that the energy they account for is largest: of two pendulum modes that both swing and pitch,
    each gets one of the words. Where the joint of an effect, NAME/kind, has most of the
    kinetic energy, the mode is that: '1st absorber'.
    """
    names = [model.joint(j).name for j in range(model.njnt)]
    links = {link.name for chain in parts.chains.values() for link in chain.links}
    elastic = [j for j, name in enumerate(names) if name.split("/")[0] in links]
    added = [j for j, name in enumerate(names) if "/" in name and j not in elastic]
    stiffness = np.array([float(model.joint(j).stiffness[0]) for j in range(model.njnt)])
    shapes = [_in_phase(vector) for vector in vectors.T]
    own = [_label_of_added(names, added, mass, real) for real in shapes]
    shares = np.array([_rigid_shares(model, mass, real) for real in shapes]).reshape(-1, len(ROOT_JOINTS))
    rigid = [k for k, label in enumerate(own) if label is None and (not elastic or shares[k].sum() > 0.5)]
    named = dict(zip(rigid, _rigid_names(shares[rigid]), strict=True))
    counted: Counter[str] = Counter()
    labels = []
    for k, real in enumerate(shapes):
        label = own[k] or named.get(k) or _elastic_label(parts, model, elastic, real, stiffness * real**2)
        counted[label] += 1
        count = counted[label]
        numbered = label not in (*_RIGID_NAMES.values(), "shaker") or count > 1
        labels.append(f"{_ORDINALS.get(count, f'{count}th')} {label}" if numbered else label)
    return tuple(labels)


def _in_phase(vector: NDArray[np.complex128]) -> NDArray[np.float64]:
    """The real shape nearest to a complex one, for a phase that makes the sum of squares real."""
    phase = np.angle((vector**2).sum()) / 2
    return np.asarray((vector * np.exp(-1j * phase)).real)


def _label_of_added(
    names: list[str], added: list[int], mass: NDArray[np.float64], real: NDArray[np.float64]
) -> str | None:
    """The kind of effects' joints that have more than half of a mode's kinetic energy in their own motion."""
    energy: Counter[str] = Counter()
    for j in added:
        energy[names[j].split("/")[1]] += mass[j, j] * real[j] ** 2
    total = float(real @ mass @ real)
    return next((kind for kind, own in energy.items() if own > 0.5 * total), None)


def _rigid_shares(model: mujoco.MjModel, mass: NDArray[np.float64], real: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share (6,) of a mode's kinetic energy in each rigid motion: along the axes with, and turning about, the CG."""
    root = [int(model.joint(name).dofadr[0]) for name in ROOT_JOINTS]
    momentum = mass[root] @ real
    body = mass[np.ix_(root, root)]
    motion = np.linalg.solve(body, momentum)
    translation, turning = motion[:3] + np.linalg.solve(body[:3, :3], body[:3, 3:] @ motion[3:]), motion[3:]
    # The Schur complement is the inertia about the centre of gravity.
    inertia = body[3:, 3:] - body[3:, :3] @ np.linalg.solve(body[:3, :3], body[:3, 3:])
    energy = np.concatenate([translation * momentum[:3], turning * (inertia @ turning)])
    return np.asarray(energy / (real @ mass @ real))


def _rigid_names(shares: NDArray[np.float64]) -> list[str]:
    """A name for each rigid mode from its shares (R, 6), none twice among the best six."""
    names = [_RIGID_NAMES[ROOT_JOINTS[k]] for k in shares.argmax(axis=1)]
    for row, column in zip(*linear_sum_assignment(-shares), strict=True):
        names[row] = _RIGID_NAMES[ROOT_JOINTS[column]]
    return names


def _elastic_label(
    parts: AirframeParts,
    model: mujoco.MjModel,
    elastic: list[int],
    real: NDArray[np.float64],
    energy: NDArray[np.float64],
) -> str:
    """The kind of hinge that holds most of the strain energy, and the symmetry of the angles."""
    share: Counter[str] = Counter()
    for j in elastic:
        share[model.joint(j).name.split("/")[1]] += energy[j]
    kind = max(share, key=lambda k: share[k])
    return f"{_symmetry(parts, model, real, kind)}{kind}"


def _symmetry(parts: AirframeParts, model: mujoco.MjModel, real: NDArray[np.float64], kind: str) -> str:
    """'symmetric ', 'antisymmetric ' or '' from the mirrored beams' hinge angles."""
    same = opposite = 0.0
    for name in (n.removesuffix("-right") for n in parts.chains if n.endswith("-right")):
        if f"{name}-left" not in parts.chains:
            continue
        right, left = (_hinge_angles(parts.chains[f"{name}-{side}"], model, real, kind) for side in ("right", "left"))
        # A joint that one side alone has, soft root or not, says nothing about symmetry.
        cells = sorted(right.keys() & left.keys())
        # Torsion turns about axes that both point outboard: equal pitch is an opposite angle.
        sign = -1.0 if kind == "torsion" else 1.0
        same += sum((right[c] + sign * left[c]) ** 2 for c in cells)
        opposite += sum((right[c] - sign * left[c]) ** 2 for c in cells)
    if same == opposite == 0.0:
        return ""
    return "symmetric " if same >= opposite else "antisymmetric "


def _hinge_angles(chain: Chain, model: mujoco.MjModel, real: NDArray[np.float64], kind: str) -> dict[str, float]:
    """The angle of every hinge of a kind, by its link's name without the beam's."""
    return {
        link.name.removeprefix(chain.name): float(real[model.joint(f"{link.name}/{kind}").dofadr[0]])
        for link in chain.links
        if any(hinge.kind == kind for hinge in link.hinges)
    }
