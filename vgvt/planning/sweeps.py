"""The sweeps that a search may try with each mount: of the band and level that are free, in the time that there is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from vgvt.data import InputError
from vgvt.planning.budget import Mount
from vgvt.planning.limits import has_time_for, most_given_v, too_long
from vgvt.planning.wish import Wish
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import RANDOM_KINDS, Excitation
from vgvt.simulation.command import peak_command_v

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
        for excitation in _excitations(scenario, wish):
            try:
                sweeps.append(_at_level(scenario, _timed(scenario, excitation, wish, mount), wish))
            except InputError as error:
                refused.append(error)
        if sweeps:
            found[mount] = tuple(sweeps)
    if not found:
        raise refused[0]
    return found


def _excitations(scenario: Scenario, wish: Wish) -> Iterator[Excitation]:
    """The scenario's own and, with a free band, sweeps around the targets that its converter can follow."""
    e, most_v, most_hz = scenario.excitation, most_given_v(scenario), scenario.acquisition.sample_rate_hz / 2
    yield e
    if "band" not in wish.free:
        return
    # A sine of the same root mean square, where that is what the amplitude is of.
    amplitude_v = min(e.amplitude_v * (math.sqrt(2) if e.kind in RANDOM_KINDS else 1.0), most_v)
    low, high = wish.targets[0][1], wish.targets[-1][1]
    starts = {round(low * factor, 1) for factor in _BELOW} | {e.band_hz[0]}
    stops = {round(high * factor, 1) for factor in _ABOVE} | {e.band_hz[1]}
    for kind in ("linear-chirp", "logarithmic-chirp"):
        for start in sorted(s for s in starts if s > 0):
            for stop in sorted(s for s in stops if start < s < most_hz):
                keys = {"kind": kind, "start_hz": start, "stop_hz": stop, "amplitude_v": amplitude_v}
                kept = {key: getattr(e, key) for key in ("lead_in_s", "ring_down_s", "taper_s", "unrecorded_s")}
                yield Excitation(duration_s=e.duration_s, **keys, **kept)  # type: ignore[arg-type]


def _at_level(scenario: Scenario, sweep: Sweep, wish: Wish) -> Sweep:
    """The sweep at the level whose largest peak is the wish's, where that is free."""
    if "level" not in wish.free:
        return sweep
    e, amplitude_v = sweep.excitation, min(wish.largest_peak_v, most_given_v(scenario))
    if e.kind in RANDOM_KINDS:
        peak_v = peak_command_v(sweep.in_place_of(scenario), wish.run_count(scenario) * sweep.repeats)
        # Of noise that lasts as long as before the rounding leaves what it was.
        amplitude_v = float(f"{wish.largest_peak_v * e.amplitude_v / peak_v:.6g}")
    return replace(sweep, excitation=e.model_copy(update={"amplitude_v": amplitude_v}))


def _timed(scenario: Scenario, e: Excitation, wish: Wish, mount: Mount) -> Sweep:
    """An excitation that fits into the minutes, lasting as long as they allow where that is free; else InputError."""
    swept = scenario.model_copy(update={"excitation": e})
    if "sweep-time" in wish.free:
        duration, repeats = wish.budget.sweep(swept, wish.run_count(scenario), mount)
        return Sweep(e.model_copy(update={"duration_s": duration}), repeats)
    if not has_time_for(swept, wish, mount):
        raise too_long(swept, wish)
    return Sweep(e, scenario.acquisition.repeats)
