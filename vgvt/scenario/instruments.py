"""The instruments: force transducer, accelerometers and data acquisition."""

from __future__ import annotations

from typing import Self

from pydantic import Field, field_validator, model_validator

from vgvt.data.dof import Direction
from vgvt.scenario.base import Finite, NonNegative, Positive, Table


class NoiseSpectrum(Table):
    """One-sided amplitude spectral density against frequency, log-log in between, flat outside."""

    frequency_hz: tuple[Positive, ...] = Field(min_length=1)
    density: tuple[Positive, ...] = Field(min_length=1)
    """In the sensor's own unit per root hertz: g/√Hz for accelerometers, N/√Hz for force."""

    @model_validator(mode="after")
    def _a_function_of_frequency(self) -> Self:
        if len(self.frequency_hz) != len(self.density):
            raise ValueError(
                f"frequency_hz has {len(self.frequency_hz)} entries and density {len(self.density)}; pair them"
            )
        if any(b <= a for a, b in zip(self.frequency_hz, self.frequency_hz[1:], strict=False)):
            raise ValueError("frequency_hz must increase from entry to entry")
        return self


class Transducer(Table):
    """Force transducer between stinger and structure; it measures the force at its sensing element."""

    model: str = ""
    sensitivity_v_per_n: Positive
    conditioner_gain: Positive = 1.0
    mass_kg: NonNegative
    """All of it; it rides on the aircraft."""
    end_mass_kg: NonNegative
    """The part between sensing element and structure: F_structure = F_measured - end_mass * a."""
    high_pass_hz: NonNegative = 0.0
    """First-order corner of the AC-coupled chain; 0 is DC coupled."""
    noise: NoiseSpectrum | None = None

    @model_validator(mode="after")
    def _end_mass_is_part_of_mass(self) -> Self:
        if self.end_mass_kg > self.mass_kg:
            raise ValueError(
                f"end_mass_kg {self.end_mass_kg} is more than the whole transducer, mass_kg {self.mass_kg}"
            )
        return self


class Grid(Table):
    """Where accelerometers can be put: columns of equal length."""

    node: tuple[int, ...] = Field(min_length=1)
    x_m: tuple[Finite, ...]
    y_m: tuple[Finite, ...]
    z_m: tuple[Finite, ...] | None = None
    """Left out, the points lie at the height of the surface that they are on."""
    direction: tuple[str, ...] | None = None
    """Measuring direction of each point, like '+Z' (also when left out) or '-X'."""
    attached_to: tuple[str, ...] | None = None
    """'body' or a beam for each point; left out, the part whose planform holds the point."""

    @field_validator("direction")
    @classmethod
    def _directions_exist(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for text in value or ():
            if Direction.from_label(text).is_rotation:
                raise ValueError(f"{text!r} is a rotation; accelerometers measure translations like '+Z'")
        return value

    @model_validator(mode="after")
    def _columns_of_equal_length(self) -> Self:
        for name in ("x_m", "y_m", "z_m", "direction", "attached_to"):
            column = getattr(self, name)
            if column is not None and len(column) != len(self.node):
                raise ValueError(f"column {name} has {len(column)} entries but node has {len(self.node)}")
        if len(set(self.node)) != len(self.node):
            raise ValueError("node numbers must be unique")
        return self


class Accelerometers(Table):
    """The roving accelerometers: all of one type, their mass moves with them from run to run."""

    model: str = ""
    sensitivity_v_per_g: Positive
    conditioner_gain: Positive = 1.0
    mass_kg: NonNegative
    """One sensor with what of its cable moves along."""
    high_pass_hz: NonNegative = 0.0
    """First-order corner of the AC-coupled chain; 0 is DC coupled."""
    noise: NoiseSpectrum | None = None
    grid: Grid


class Acquisition(Table):
    """The converter and the plan of runs."""

    model: str = ""
    sample_rate_hz: Positive
    bits: int = Field(default=24, ge=2, le=32)
    range_v: Positive = 10.0
    """Full scale of every input, plus and minus."""
    noise_v_per_rthz: NonNegative = 0.0
    """White noise of the converter's inputs, one-sided."""
    runs: tuple[tuple[int, ...], ...] = Field(min_length=1)
    """The nodes that carry an accelerometer in each run, in the order of the channels."""
