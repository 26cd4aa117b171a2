"""The instruments: force transducer, accelerometers and data acquisition."""

from __future__ import annotations

import re
from typing import Self

from pydantic import Field, PrivateAttr, field_validator, model_validator

from vgvt.scenario.base import Finite, MisfitError, Node, NonNegative, Positive, Table, Whole


class NoiseSpectrum(Table):
    """One-sided amplitude spectral density against frequency, log-log in between, flat outside."""

    frequency_hz: tuple[Positive, ...] = Field(min_length=1)
    """Frequencies at which the density is given, rising."""
    density: tuple[Positive, ...] = Field(min_length=1)
    """In the sensor's own unit per root hertz: g/√Hz for accelerometers, N/√Hz for force."""

    @model_validator(mode="after")
    def _a_function_of_frequency(self) -> Self:
        if len(self.frequency_hz) != len(self.density):
            raise MisfitError(
                ("density",),
                f"has {len(self.density)} entries but frequency_hz has {len(self.frequency_hz)}",
                "Give one density a frequency.",
            )
        for i in range(1, len(self.frequency_hz)):
            if self.frequency_hz[i] <= self.frequency_hz[i - 1]:
                raise MisfitError(
                    ("frequency_hz", i),
                    f"is {self.frequency_hz[i]:g}, not above the entry before it",
                    "Sort the entries by frequency.",
                )
        return self


class Transducer(Table):
    """Force transducer between stinger and structure; it measures the force at its sensing element."""

    model: str = ""
    """Make and type, in words."""
    sensitivity_v_per_n: Positive
    """Volts per newton, before the conditioner's gain."""
    conditioner_gain: Positive = 1.0
    """Gain between sensor and converter."""
    mass_kg: NonNegative
    """All of it; it rides on the aircraft."""
    end_mass_kg: NonNegative
    """The part between sensing element and structure: F_structure = F_measured - end_mass * a."""
    range_n: Positive | None = None
    """Full scale, plus and minus: more force reads as this, and marks the record as overloaded; left out, none does."""
    high_pass_hz: NonNegative = 0.0
    """First-order corner of the AC-coupled chain; 0 is DC coupled."""
    noise: NoiseSpectrum | None = None
    """The sensor's own noise; left out, there is none."""

    @model_validator(mode="after")
    def _end_mass_is_part_of_mass(self) -> Self:
        if self.end_mass_kg > self.mass_kg:
            raise MisfitError(
                ("end_mass_kg",),
                f"is {self.end_mass_kg:g}, more than the whole transducer's mass_kg {self.mass_kg:g}",
                "Write the part between sensing element and structure.",
            )
        return self


class Grid(Table):
    """Where accelerometers can be put: columns of equal length."""

    node: tuple[Node, ...] = Field(min_length=1)
    """Number of each point; runs and results name points by it."""
    x_m: tuple[Finite, ...]
    """Aft of the nose."""
    y_m: tuple[Finite, ...]
    """To the right of the plane of symmetry."""
    z_m: tuple[Finite, ...] | None = None
    """Left out, the points lie at the height of the surface that they are on."""
    direction: tuple[str, ...] | None = None
    """Measuring direction of each point, like '+Z' (also when left out) or '-X'."""
    attached_to: tuple[str, ...] | None = None
    """'body' or a beam for each point; left out, the part whose planform holds the point."""

    @field_validator("direction")
    @classmethod
    def _directions_exist(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for i, text in enumerate(value or ()):
            if re.fullmatch(r"[+-]?[XYZ]", text, re.IGNORECASE) is None:
                raise MisfitError((i,), f"is {text!r}, not a direction to measure in", "Write '+Z' or '-X'.")
        return value

    @model_validator(mode="after")
    def _columns_of_equal_length(self) -> Self:
        for name in ("x_m", "y_m", "z_m", "direction", "attached_to"):
            column = getattr(self, name)
            if column is not None and len(column) != len(self.node):
                raise MisfitError(
                    (name,), f"has {len(column)} entries but node has {len(self.node)}", "Give one entry a node."
                )
        for i, node in enumerate(self.node):
            if node in self.node[:i]:
                raise MisfitError(("node", i), f"is {node}, which is taken", "Give every point a number of its own.")
        return self


class Accelerometers(Table):
    """The roving accelerometers: all of one type, their mass moves with them from run to run."""

    model: str = ""
    """Make and type, in words."""
    sensitivity_v_per_g: Positive
    """Volts per g of 9.80665 m/s², before the conditioner's gain."""
    conditioner_gain: Positive = 1.0
    """Gain between sensor and converter."""
    mass_kg: NonNegative
    """One sensor with what of its cable moves along."""
    range_g: Positive | None = None
    """Full scale, plus and minus, in g of 9.80665 m/s²: more reads as this, and marks the record as overloaded; left
    out, nothing does."""
    high_pass_hz: NonNegative = 0.0
    """First-order corner of the AC-coupled chain; 0 is DC coupled."""
    noise: NoiseSpectrum | None = None
    """The sensors' own noise, each its own; left out, there is none."""
    grid: Grid
    """The points where an accelerometer can sit."""


class Acquisition(Table):
    """The converter and the plan of runs."""

    model: str = ""
    """Make and type, in words."""
    sample_rate_hz: Positive
    """Samples per second of every channel; all are sampled at once."""
    bits: Whole = Field(default=24, ge=2, le=32)
    """Resolution of the converter over plus and minus range_v."""
    range_v: Positive = 10.0
    """Full scale of every input, plus and minus."""
    noise_v_per_rthz: NonNegative = 0.0
    """White noise of the converter's inputs, one-sided."""
    runs: tuple[tuple[Node, ...], ...] = Field(min_length=1)
    """The nodes that carry an accelerometer in each run, in the order of the channels."""
    repeats: Whole = Field(default=1, ge=1)
    """How often each of them is run, one after the other: records to average, and to see the scatter by."""
    levels: tuple[Positive, ...] | None = None
    """How hard each of runs is driven, in times excitation.amplitude_v (with a hammer: hammer.peak_force_n); left out,
    all alike. Only other levels show whether something depends on the level of force."""

    @model_validator(mode="after")
    def _a_level_for_every_run(self) -> Self:
        if self.levels is not None and len(self.levels) != len(self.runs):
            raise MisfitError(
                ("levels",), f"has {len(self.levels)} entries but runs has {len(self.runs)}", "Give one level a run."
            )
        return self

    @property
    def run_nodes(self) -> tuple[tuple[int, ...], ...]:
        """The nodes of every run of the campaign, repeats included, in the order of the records."""
        return tuple(nodes for nodes in self.runs for _ in range(self.repeats))

    @property
    def loudest(self) -> float:
        """How hard the loudest run is driven."""
        return max(self.levels or (1.0,))

    def level_in(self, run: int) -> float:
        """How hard a run (from 0) is driven; where all are alike any further one is like them."""
        return 1.0 if self.levels is None else self.levels[run // self.repeats]

    def with_runs(self, runs: tuple[tuple[int, ...], ...], levels: tuple[float, ...] | None = None) -> Self:
        """The same converter with other runs, each once, and their levels (default: all alike)."""
        return self.model_copy(update={"runs": runs, "repeats": 1, "levels": levels})

    # No key of a file: a campaign is written down as one that begins with itself.
    _counted: tuple[int, ...] = PrivateAttr(default=())

    def counted_as(self, runs: tuple[int, ...]) -> Self:
        """The same plan, its runs counted from 1 as these runs of a campaign that was there before.

        What changes from run to run has come as far in each as in the run that it counts as: a run that is made once
        more after the last of four counts as the fourth, and so does every run of another campaign after them.
        """
        changed = self.model_copy()
        changed._counted = runs
        return changed

    def as_counted(self, run: int) -> tuple[Self, int]:
        """The plan of the campaign that a run (from 0) counts in, the run's own sensors in it, and which it is there.

        The plan itself where runs count as they come.
        """
        counted = self._counted
        # Asked for every effect in every run, and nearly all runs count as they come.
        if not counted or len(counted) != len(own := self.run_nodes):
            return self, run
        place = counted[run] - 1
        runs = [own[min(k, len(own) - 1)] for k in range(max(counted))]
        runs[place] = own[run]
        return self.with_runs(tuple(runs)).counted_as(()), place

    def with_runs_of(self, other: Self) -> Self:
        """The same converter with another plan's runs, counted as they are there."""
        changes = {"runs": other.runs, "repeats": other.repeats, "levels": other.levels}
        return self.model_copy(update=changes).counted_as(other._counted)
