"""Patterns of poles that several responses or runs show.

A pole that one response shows alone may be noise; one that comes up again is a
pattern (Moreno et al., Structural model identification of a small flexible
aircraft, American Control Conference, 2014, figure 4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import PoleCandidate
from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.merged_claim import MergedPole, merged_pole
from vgvt_identifiers.spectra import CampaignSpectra

_FEW_SOURCES = 3


@dataclass(frozen=True, slots=True, eq=False)
class SourcePoles:
    """Poles (n,) in rad/s that one source, a response or a run, shows, with their deviations and a quality (n,).

    ``run`` is the index of the run in the spectra, ``order`` the states of the model they come from.
    """

    run: int
    order: int
    poles: NDArray[np.complex128]
    frequency_std_hz: NDArray[np.float64]
    damping_ratio_std: NDArray[np.float64]
    quality: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PatternOptions:
    """When poles are one pattern and a pattern is worth a look; the settings of the methods explain each."""

    tolerance: float = 0.02
    largest_damping_ratio: float = 0.2
    largest_frequency_std: float = 0.02
    largest_damping_std: float = 0.5
    least_quality: float = 0.0
    least_share: float = 0.1
    weighted: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """One pattern: its pole with deviations, and its members (sources,), -1 where a source lacks it."""

    pole: MergedPole
    members: NDArray[np.intp]
    quality: float

    @property
    def pole_rad_s(self) -> complex:
        """The pole in the upper half plane."""
        ratio = self.pole.damping_ratio
        return complex(2 * np.pi * self.pole.natural_frequency_hz * (-ratio + 1j * np.sqrt(1 - ratio**2)))

    @property
    def seen(self) -> int:
        """How many sources show it."""
        return int((self.members >= 0).sum())


@dataclass(frozen=True, slots=True, eq=False)
class Patterns:
    """The patterns worth a look, in order of frequency, and the fate of every pole (kept ones have an empty text)."""

    patterns: tuple[Pattern, ...]
    sources: tuple[SourcePoles, ...]
    refused: tuple[NDArray[np.object_], ...]

    def dropped(self, pattern: Pattern, why: str) -> Patterns:
        """The same without one pattern; its poles say why."""
        refused = tuple(r.copy() for r in self.refused)
        for source, member in enumerate(pattern.members):
            if member >= 0:
                refused[source][member] = f"{pattern.pole.natural_frequency_hz:.4g} Hz: {why}"
        return Patterns(tuple(p for p in self.patterns if p is not pattern), self.sources, refused)

    def candidates(self) -> tuple[PoleCandidate, ...]:
        """Every pole with its fate, by order and frequency."""
        home = {(i, int(m)): p for p in self.patterns for i, m in enumerate(p.members) if m >= 0}
        rows = []
        for i, source in enumerate(self.sources):
            for j, pole in enumerate(source.poles):
                pattern, text = home.get((i, j)), str(self.refused[i][j])
                if pattern is not None:
                    name = f"{pattern.pole.natural_frequency_hz:.4g} Hz"
                    text = f"{name}: shown by {pattern.seen} of {len(self.sources)}, and the responses need it"
                size = float(abs(pole))
                kept = pattern is not None
                rows.append(PoleCandidate(size / (2 * np.pi), float(-pole.real / size), source.order, kept, text))
        return tuple(sorted(rows, key=lambda c: (c.order, c.frequency_hz)))


def find_patterns(sources: tuple[SourcePoles, ...], spectra: CampaignSpectra, options: PatternOptions) -> Patterns:
    """Groups the poles of all sources by distance, at most one of a source in a pattern."""
    refused = tuple(_refusals(s, options, spectra.added_decay_rad_per_s) for s in sources)
    sound = [np.flatnonzero(r == "") for r in refused]
    modes = tuple(_as_modes(s, keep, spectra) for s, keep in zip(sources, sound, strict=True))
    if not any(m.poles.size for m in modes):
        return Patterns((), sources, refused)
    least = 1 if len(sources) <= _FEW_SOURCES else max(2, int(np.ceil(options.least_share * len(sources))))
    found = []
    for group in _groups(modes, options.tolerance):
        seen = np.flatnonzero(group >= 0)
        members = np.array([sound[i][g] if g >= 0 else -1 for i, g in enumerate(group)])
        if seen.size < least:
            for i in seen:
                refused[i][members[i]] = f"seen by {seen.size} of {len(sources)}; {least} are needed"
            continue
        pole = merged_pole(modes, group) if options.weighted else _plain(modes, group)
        quality = float(np.mean([sources[i].quality[members[i]] for i in seen]))
        found.append(Pattern(pole, members, quality))
    return Patterns(_without_shadows(found, refused), sources, refused)


def _groups(modes: tuple[RunModes, ...], tolerance: float) -> NDArray[np.intp]:
    """Groups (M, sources) of poles, -1 where a source has none to give."""
    full = [i for i, m in enumerate(modes) if m.poles.size]
    groups = common_modes(tuple(modes[i] for i in full), tolerance)
    table = np.full((len(groups), len(modes)), -1)
    table[:, full] = groups
    return table


def _refusals(source: SourcePoles, options: PatternOptions, added_decay_rad_per_s: float) -> NDArray[np.object_]:
    """Why a pole is out of the question (n,), empty texts for the others."""
    size = np.abs(source.poles)
    ratio = -source.poles.real / size
    texts = np.full(size.size, "", dtype=object)
    texts[source.damping_ratio_std > options.largest_damping_std * np.abs(ratio)] = "its damping ratio is not known"
    texts[source.frequency_std_hz * 2 * np.pi > options.largest_frequency_std * size] = "its frequency is not known"
    few = f"amplitude coherence below {options.least_quality:g}: it does not decay as its root says"
    texts[source.quality < options.least_quality] = few
    # A window's damping is none of the structure's.
    own = source.poles + added_decay_rad_per_s
    heavy = -own.real > options.largest_damping_ratio * np.abs(own)
    texts[heavy] = f"damping ratio above {options.largest_damping_ratio:g}"
    texts[ratio <= 0] = "unstable: negative damping"
    return texts


def _as_modes(source: SourcePoles, keep: NDArray[np.intp], spectra: CampaignSpectra) -> RunModes:
    """Poles of a source in the shape in which poles of runs are recognised; it has no shape of its own."""
    run = spectra.runs[source.run]
    blank = np.zeros((keep.size, 0), complex)
    std = (source.frequency_std_hz[keep], source.damping_ratio_std[keep])
    return RunModes(run.run, run.reference, (), source.poles[keep], blank, *std)


def _plain(modes: tuple[RunModes, ...], group: NDArray[np.intp]) -> MergedPole:
    """Plain mean over the members, as the paper averages, with the deviation that their scatter gives it."""
    poles = np.array([m.poles[i] for m, i in zip(modes, group, strict=True) if i >= 0])
    frequency, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    if poles.size == 1:
        return merged_pole(modes, group)
    spread = [float(x.std(ddof=1) / np.sqrt(x.size)) for x in (frequency, damping)]
    return MergedPole(float(frequency.mean()), float(damping.mean()), spread[0], spread[1], ())


def _without_shadows(found: list[Pattern], refused: tuple[NDArray[np.object_], ...]) -> tuple[Pattern, ...]:
    """Leaves out the rest of a pattern that linkage has cut in two: same pole within its width, other sources."""
    kept: list[Pattern] = []
    for pattern in sorted(found, key=lambda p: -p.seen):
        twin = next((k for k in kept if _shadow(pattern, k)), None)
        if twin is None:
            kept.append(pattern)
            continue
        for source, member in enumerate(pattern.members):
            if member >= 0:
                refused[source][member] = f"lies beside the pattern at {twin.pole.natural_frequency_hz:.4g} Hz"
    return tuple(sorted(kept, key=lambda p: p.pole.natural_frequency_hz))


def _shadow(small: Pattern, large: Pattern) -> bool:
    both = int(((small.members >= 0) & (large.members >= 0)).sum())
    distance = abs(small.pole_rad_s.imag - large.pole_rad_s.imag)
    return both <= 0.25 * small.seen and distance < 2 * max(-large.pole_rad_s.real, -small.pole_rad_s.real)
