"""Names for true modes: which kind of motion carries the energy, and on which sides."""

from __future__ import annotations

from collections import Counter

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.airframe import ROOT_JOINTS, AirframeParts
from vgvt.simulation.chain import Link

_RIGID_NAMES = {
    "slide-x": "fore-aft swing",
    "slide-y": "sideways swing",
    "slide-z": "heave",
    "yaw": "yaw",
    "pitch": "pitch",
    "roll": "roll",
}
_ORDINALS = {1: "1st", 2: "2nd", 3: "3rd"}


def mode_labels(parts: AirframeParts, model: mujoco.MjModel, vectors: NDArray[np.complex128]) -> tuple[str, ...]:
    """Labels like '1st symmetric bending' or 'heave' for modes ``vectors`` (nv, R), in their order.

    Elastic or rigid by where the strain energy is not: a mode whose springs hold
    less than the suspension's share keeps the name of its largest rigid motion.
    """
    stiffness = np.array([float(model.joint(j).stiffness[0]) for j in range(model.njnt)])
    names = [model.joint(j).name for j in range(model.njnt)]
    kinds = sorted({name.split("/")[1] for name in names if "/" in name})
    counted: Counter[str] = Counter()
    labels = []
    for vector in vectors.T:
        real = _in_phase(vector)
        energy = stiffness * real**2
        share = {k: sum(e for e, n in zip(energy, names, strict=True) if n.endswith("/" + k)) for k in kinds}
        label = _label(parts, model, real, share)
        counted[label] += 1
        elastic = label not in _RIGID_NAMES.values() and label != "shaker"
        count = counted[label]
        labels.append(f"{_ORDINALS.get(count, f'{count}th')} {label}" if elastic else label)
    return tuple(labels)


def _in_phase(vector: NDArray[np.complex128]) -> NDArray[np.float64]:
    """The real shape nearest to a complex one, for a phase that makes the sum of squares real."""
    phase = np.angle((vector**2).sum()) / 2
    return np.asarray((vector * np.exp(-1j * phase)).real)


def _label(parts: AirframeParts, model: mujoco.MjModel, real: NDArray[np.float64], share: dict[str, float]) -> str:
    rigid = np.array([abs(real[model.joint(name).dofadr[0]]) for name in ROOT_JOINTS])
    elastic = np.array([abs(real[j]) for j in range(real.size) if "/" in model.joint(j).name])
    # Rotations in rad count with one metre of arm, so that a degree of pitch is no small thing beside a slide.
    if not elastic.size or elastic.sum() < 0.1 * rigid.max():
        return _RIGID_NAMES[ROOT_JOINTS[int(np.argmax(rigid))]]
    kind = max(share, key=lambda k: share[k])
    return f"{_symmetry(parts, model, real, kind)}{kind}"


def _symmetry(parts: AirframeParts, model: mujoco.MjModel, real: NDArray[np.float64], kind: str) -> str:
    """'symmetric ', 'antisymmetric ' or '' from the mirrored beams' hinge angles."""
    same = opposite = 0.0
    for name in (b.name for b in parts.airframe.beam if b.mirror):
        right, left = (
            np.array([real[model.joint(f"{link.name}/{kind}").dofadr[0]] for link in chain.links if _has(link, kind)])
            for chain in (parts.chains[f"{name}-right"], parts.chains[f"{name}-left"])
        )
        # Torsion turns about axes that both point outboard: equal pitch is an opposite angle.
        left = -left if kind == "torsion" else left
        same += float(((right + left) ** 2).sum())
        opposite += float(((right - left) ** 2).sum())
    if same == opposite == 0.0:
        return ""
    return "symmetric " if same >= opposite else "antisymmetric "


def _has(link: Link, kind: str) -> bool:
    return any(hinge.kind == kind for hinge in link.hinges)
