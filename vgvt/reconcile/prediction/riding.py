"""What sensors and the transducer weigh in the coordinates of a structure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.prediction.grouping import Group
from vgvt.reconcile.question.data import MeasuredChannel
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Riders:
    """The sensors, of ``masses_kg`` (S,), that a group's structure carries at its places ``rows`` (S,).

    Where they are ``roving`` they are those of all ``runs`` of the campaign, which the structure has in the mean and
    but for what they weigh along their axes, with which each run is loaded by itself; else those of one run.
    """

    rows: NDArray[np.intp]
    masses_kg: Array
    runs: int
    roving: bool

    @classmethod
    def of(cls, channels: Sequence[MeasuredChannel], group: Group) -> Riders:
        """Of a group of a campaign with ``channels``.

        Its own sensors are where it has them, those of other groups at the points they are meant to be: an effect that
        does nothing yet may part runs, and the mean is not to jump with that.
        """
        nodes: dict[int, list[int]] = {}
        for channel in channels:
            nodes.setdefault(channel.run, []).append(channel.dof.node)
        if len(set(map(tuple, nodes.values()))) == 1:
            (first, *_) = (channels[i].run for i in group.channels)
            own = np.array([k for k, i in enumerate(group.channels) if channels[i].run == first])
            return cls(group.rows[own], group.masses_kg[own], 1, False)
        rows, masses = group.rows, group.masses_kg
        mine = set(group.channels.tolist())
        away = [c.dof.node for i, c in enumerate(channels) if i not in mine]
        if away:
            place = {site: k for k, site in enumerate(group.structure.places)}
            home = {p.dof.node: place[p.site] for p in group.plan.grid}
            rows = np.concatenate([rows, [home[node] for node in away]])
            masses = np.concatenate([masses, np.full(len(away), masses.mean())])
        return cls(rows, masses, len(nodes), True)

    def weighing(self, mass_kg: float) -> Riders:
        """The same sensors, each with one mass."""
        return replace(self, masses_kg=np.full(self.rows.size, mass_kg))

    def inertia(self, s: Structure) -> Array:
        """What a structure carries of them, (n, n)."""
        moved = s.jacobian[self.rows]
        total = (moved * self.masses_kg[:, None, None]).reshape(-1, s.drive.size).T @ moved.reshape(-1, s.drive.size)
        if not self.roving:
            return np.asarray(total)
        axis = s.axis[self.rows]
        return np.asarray(total - (axis.T * self.masses_kg) @ axis) / self.runs

    def by_rows(self, axis: Array, moved: Array) -> Array:
        """Change (m, m) of :meth:`inertia` where roving sensors' rows ``axis`` (S, m) alone change by ``moved``.

        What cells lack turns the rows that sensors read, and not the links that carry them.
        """
        change = (axis.T * self.masses_kg) @ moved / self.runs
        return np.asarray(-change - change.T)


def riding(drive: Array, known: NDArray[np.bool_]) -> Array:
    """What a transducer of 1 kg adds to the inertia (n, n) by moving otherwise than the joints that are ``known`` (n,).

    On a mount that gives it goes where the push goes, not where the structure below it does.
    """
    bare = np.where(known, drive, 0.0)
    return np.asarray(np.outer(drive, drive) - np.outer(bare, bare))
