"""The sweeps that a search may try with each mount: of the band and level that are free, in the time that there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from vgvt.data import InputError
from vgvt.planning.budget import Mount
from vgvt.planning.limits import has_time_for, too_long
from vgvt.planning.wish import Wish
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Excitation

_BELOW, _ABOVE = (0.6, 0.75, 0.85), (1.1, 1.25)


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """An excitation and how often each run repeats it."""

    excitation: Excitation
    repeats: int

    def in_place_of(self, scenario: Scenario) -> Scenario:
        """A scenario with this sweep instead of its own."""
        acquisition = scenario.acquisition.model_copy(update={"repeats": self.repeats})
        return scenario.model_copy(update={"excitation": self.excitation, "acquisition": acquisition})


def affordable_sweeps(scenario: Scenario, wish: Wish) -> dict[Mount, tuple[Sweep, ...]]:
    """For every mount that leaves time for one the sweeps to try, the scenario's own first where it fits.

    InputError, of the first sweep that was tried, where there is time for none with any mount.
    """
    found, refused = {}, []
    for mount in wish.mounts:
        sweeps = []
        for excitation in _excitations(scenario.excitation, wish):
            try:
                sweeps.append(_timed(scenario, _at_level(excitation, wish), wish, mount))
            except InputError as error:
                refused.append(error)
        if sweeps:
            found[mount] = tuple(sweeps)
    if not found:
        raise refused[0]
    return found


def _excitations(e: Excitation, wish: Wish) -> Iterator[Excitation]:
    """The scenario's own and, with a free band, sweeps around the targets, linear and logarithmic."""
    yield e
    if "band" not in wish.free:
        return
    low, high = wish.targets[0][1], wish.targets[-1][1]
    starts = {round(low * factor, 1) for factor in _BELOW} | {e.band_hz[0]}
    stops = {round(high * factor, 1) for factor in _ABOVE} | {e.band_hz[1]}
    for kind in ("linear-chirp", "logarithmic-chirp"):
        for start in sorted(s for s in starts if s > 0):
            for stop in sorted(s for s in stops if s > start):
                keys = {"kind": kind, "start_hz": start, "stop_hz": stop, "amplitude_v": e.amplitude_v}
                silences = {"lead_in_s": e.lead_in_s, "ring_down_s": e.ring_down_s, "taper_s": e.taper_s}
                yield Excitation(duration_s=e.duration_s, **keys, **silences)  # type: ignore[arg-type]


def _at_level(e: Excitation, wish: Wish) -> Excitation:
    return e.model_copy(update={"amplitude_v": wish.largest_amplitude_v}) if "level" in wish.free else e


def _timed(scenario: Scenario, e: Excitation, wish: Wish, mount: Mount) -> Sweep:
    """An excitation that fits into the minutes, lasting as long as they allow where that is free; else InputError."""
    swept = scenario.model_copy(update={"excitation": e})
    if "sweep-time" in wish.free:
        duration, repeats = wish.budget.sweep(swept, wish.run_count(scenario), mount)
        return Sweep(e.model_copy(update={"duration_s": duration}), repeats)
    if not has_time_for(swept, wish, mount):
        raise too_long(swept, wish)
    return Sweep(e, scenario.acquisition.repeats)
