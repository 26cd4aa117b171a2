"""The rig: suspension, shaker, stinger and excitation signal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from vgvt.scenario.base import MisfitError, Node, NonNegative, Point, Positive, Table, Whole

# A current that lags by more hardly flows above 8 Hz: the number is in another unit.
_LONGEST_LAG_S = 0.02


class Suspension(Table):
    """One soft spring from a fixed frame to a hook on the aircraft."""

    stiffness_n_per_m: Positive = 130.0
    """Stiffness of the spring along its length."""
    damping_n_s_per_m: NonNegative = 0.4
    """Viscous damping of the spring along its length."""
    hook_m: Point
    """Where the spring holds the aircraft, aircraft axes."""
    free_length_m: Positive = 0.8
    """Length of spring and cord without load; with the sag it sets the pendulum frequency."""
    yaw_stiffness_n_m_per_rad: Positive = 0.05
    """Twist stiffness of spring and cord: keeps the aircraft from turning away."""
    rotation_damping_n_m_s_per_rad: Positive = 0.02
    """Air and hook friction on roll, pitch and yaw of the whole aircraft."""
    pendulum_damping_n_s_per_m: Positive = 0.1
    """Air drag on the slow sideways swing of the whole aircraft."""


class Shaker(Table):
    """Electrodynamic shaker: m x'' + c x' + k x = Bl i - F and V = R i + L di/dt + Bl x'."""

    model: str = ""
    """Make and type, in words."""
    node: Node = 100
    """Node number of the drive point in the campaign's geometry."""
    position_m: Point
    """Drive point on the aircraft, aircraft axes; the shaker stands below it and pushes along +z."""
    attached_to: str = "body"
    """'body' or the name of a beam; one of its cells then ends where it is pushed."""
    drive: Literal["voltage", "current"] = "voltage"
    """What the amplifier controls. Voltage drive damps the coupled system by Bl^2/R, current drive does not."""
    amplifier_gain: Positive = 1.0
    """Volts (voltage drive) or amperes (current drive) at the coil per volt of command."""
    coil_resistance_ohm: Positive
    """R, of coil and leads."""
    coil_inductance_h: NonNegative = 0.0
    """L."""
    force_factor_n_per_a: Positive
    """Bl."""
    armature_mass_kg: Positive
    """Moving mass of the shaker."""
    flexure_stiffness_n_per_m: NonNegative
    """Stiffness that centres the armature."""
    flexure_damping_n_s_per_m: NonNegative
    """Viscous damping of the armature in its flexure."""

    @property
    def coil_lag_s(self) -> float:
        """L/R, by which the current lags behind the voltage."""
        return self.coil_inductance_h / self.coil_resistance_ohm

    @model_validator(mode="after")
    def _inductance_is_in_henry(self) -> Self:
        if self.drive == "voltage" and self.coil_lag_s > _LONGEST_LAG_S:
            raise MisfitError(
                ("coil_inductance_h",),
                f"is {self.coil_inductance_h:g} H, which with {self.coil_resistance_ohm:g} ohm makes the current lag "
                f"by {self.coil_lag_s:.2g} s; no shaker's lags by more than {_LONGEST_LAG_S:g} s",
                "Write the inductance in henry: 0.6 mH is 6e-4.",
            )
        return self


def shakers_apart(tables: Mapping[str, Any]) -> dict[str, Any]:
    """A scenario's tables with several [[shaker]] apart: the first is shaker, the others stand ahead of further_shaker.

    What is no such array is left as it is, to be refused where it stands.
    """
    shakers, further = tables.get("shaker"), tables.get("further_shaker", ())
    if not isinstance(shakers, list) or not shakers or not isinstance(further, list | tuple):
        return dict(tables)
    return {**tables, "shaker": shakers[0], "further_shaker": [*shakers[1:], *further]}


class Stinger(Table):
    """The rod between armature and force transducer: axial only; lateral stiffness is an effect."""

    axial_stiffness_n_per_m: Positive
    """Stiffness along the rod, EA / length for a plain one."""
    axial_damping_n_s_per_m: NonNegative = 0.0
    """Viscous damping along the rod."""
    length_m: Positive = 0.2
    """Length of the rod."""
    mass_kg: NonNegative = 0.0
    """Half rides on the armature, half on the transducer."""


KIND_KEYS: dict[str, dict[str, bool]] = {
    "linear-chirp": {"unrecorded_s": False},
    "logarithmic-chirp": {"unrecorded_s": False},
    "stepped-sine": {"points": True, "settle_s": True},
    "random": {"unrecorded_s": False},
    "burst-random": {"blocks": True, "burst_fraction": True},
    "multisine": {"blocks": True, "lines": True, "crest_iterations": False, "unrecorded_s": False},
    "impact": {"blocks": True},
}
"""The keys that a kind of excitation has of its own, and whether it needs them."""
RANDOM_KINDS = ("random", "burst-random", "multisine")
"""Kinds that are another signal for every shaker and run."""
UNRECORDED_NOTE = "unrecorded_s"
"""Of a campaign: how long the shaker had run when its records began."""


class Excitation(Table):
    """The command sent to the amplifier in every run.

    All kinds share the band, the duration, the amplitude and the silences around them; the other
    keys belong to some kinds, as their texts say, and are refused with the rest.
    """

    kind: Literal[
        "linear-chirp", "logarithmic-chirp", "stepped-sine", "random", "burst-random", "multisine", "impact"
    ] = "linear-chirp"
    """Shape of the command; a linear chirp passes every frequency at the same rate, a logarithmic one every octave.
    impact: no command, the hammer of [hammer] strikes; start_hz and stop_hz then only name the band of interest."""
    start_hz: NonNegative
    """First frequency of a sweep, lower edge of a random band."""
    stop_hz: Positive
    """Last frequency of a sweep, which may run downwards; upper edge of a random band."""
    duration_s: Positive
    """Length of the excitation, all dwells or blocks together."""
    amplitude_v: Positive = 1.0
    """Peak of a sine; root mean square of random noise (inside its bursts) and of a multisine."""
    lead_in_s: NonNegative = 0.0
    """Silence before the excitation, inside the record."""
    unrecorded_s: NonNegative | None = None
    """Chirps, random and multisine: so long the shaker runs before the record begins, whose first sample finds the
    aircraft ringing. A part of duration_s, in place of a lead-in."""
    ring_down_s: NonNegative = 0.0
    """Silence after the excitation, inside the record."""
    taper_s: NonNegative = 0.0
    """Cosine rise and fall at both ends of the excitation, and of every burst."""
    points: Whole | None = Field(default=None, ge=2)
    """stepped-sine: how many frequencies, both ends included; each gets its share of duration_s."""
    settle_s: NonNegative | None = None
    """stepped-sine: part of a dwell that waits for the response to settle; the rest is integrated over."""
    blocks: Whole | None = Field(default=None, ge=1)
    """burst-random: how many bursts, each with its silence. multisine: how many periods. impact: how many hits.
    They share duration_s."""
    burst_fraction: Positive | None = Field(default=None, lt=1)
    """burst-random: part of a block that is noise; in the rest the response dies out."""
    lines: Literal["full", "odd"] | None = None
    """multisine: excite all lines 1 / period apart, or the odd ones, which leaves the even to show nonlinearity."""
    crest_iterations: Whole | None = Field(default=None, ge=0, le=10000)
    """multisine: steps of phase optimisation towards a lower peak; left out, the phases stay random."""
    shakers: Literal["uncorrelated", "orthogonal", "sequential"] | None = None
    """Several shakers: signals of their own (random kinds only; what is taken when left out), one signal whose sign
    changes from repeat to repeat as in a Hadamard matrix, or one shaker at a time, the others still attached."""

    @model_validator(mode="after")
    def _keys_belong_to_the_kind(self) -> Self:
        own = KIND_KEYS[self.kind]
        for key in (k for keys in KIND_KEYS.values() for k in keys):
            given = getattr(self, key) is not None
            if given and key not in own:
                owners = " or ".join(repr(kind) for kind, keys in KIND_KEYS.items() if key in keys)
                raise MisfitError((key,), f"does not belong to kind {self.kind!r}", f"It is a key of kind {owners}.")
            if not given and own.get(key):
                raise MisfitError((key,), f"is missing, and kind {self.kind!r} needs it", f"Write {key} = ….")
        return self

    @model_validator(mode="after")
    def _sweep_goes_somewhere(self) -> Self:
        if self.start_hz == self.stop_hz:
            raise MisfitError(("stop_hz",), f"is {self.stop_hz:g} like start_hz", "A sweep needs two frequencies.")
        if self.kind == "logarithmic-chirp" and self.start_hz == 0:
            raise MisfitError(("start_hz",), "is 0, which no octave reaches", "Start a logarithmic sweep above 0 Hz.")
        whole = "duration_s" if self.burst_s == self.duration_s else "a burst's length"
        if 2 * self.taper_s > self.burst_s:
            raise MisfitError(
                ("taper_s",),
                f"is {self.taper_s:g}, more than half of {whole} {self.burst_s:g}",
                "Shorten it; it is there twice, at the rise and at the fall.",
            )
        return self

    @model_validator(mode="after")
    def _dwells_and_blocks_are_long_enough(self) -> Self:
        low, high = self.band_hz
        if self.points is not None and self.settle_s is not None:
            cycles = (self.duration_s / self.points - self.settle_s) * low
            if cycles < 1 - 1e-9:
                raise MisfitError(
                    ("settle_s",),
                    f"is {self.settle_s:g} and leaves {max(cycles, 0.0):.2g} cycles at {low:g} Hz of each dwell of "
                    f"{self.duration_s / self.points:.3g} s to integrate over",
                    "Leave one cycle at least: settle less, make duration_s longer, or take fewer points.",
                )
        period = self.duration_s / (self.blocks or 1)
        if self.kind in RANDOM_KINDS and (high - low) * period < 4:
            raise MisfitError(
                ("blocks",) if self.blocks else ("duration_s",),
                f"leaves {period:.3g} s, too short to tell frequencies apart from {low:g} to {high:g} Hz",
                f"Give it {4 / (high - low):.3g} s at least, or widen the band.",
            )
        return self

    @model_validator(mode="after")
    def _record_begins_while_it_is_excited(self) -> Self:
        if self.before_record_s >= self.duration_s:
            raise MisfitError(
                ("unrecorded_s",),
                f"is {self.before_record_s:g} and leaves nothing of duration_s {self.duration_s:g} to record",
                "Shorten it, or make duration_s longer: that holds it.",
            )
        if self.before_record_s > 0 and self.lead_in_s > 0:
            raise MisfitError(
                ("lead_in_s",),
                f"is {self.lead_in_s:g}, silence inside a record that begins when the shaker has run for "
                f"unrecorded_s {self.before_record_s:g}",
                "Write one of the two: a record begins at rest, or while the aircraft rings.",
            )
        return self

    @property
    def before_record_s(self) -> float:
        """How long the shaker has run when the record begins."""
        return self.unrecorded_s or 0.0

    @property
    def shaker_signals(self) -> Literal["uncorrelated", "orthogonal", "sequential"]:
        """How the commands of several shakers differ."""
        return self.shakers or "uncorrelated"

    @property
    def record_s(self) -> float:
        """Length of the record: lead-in, what is recorded of the excitation, and ring-down."""
        return self.whole_s - self.before_record_s

    @property
    def whole_s(self) -> float:
        """How long it all takes, recorded or not: lead-in, excitation and ring-down."""
        return self.lead_in_s + self.duration_s + self.ring_down_s

    @property
    def burst_s(self) -> float:
        """Length of what fades in and out: a burst, or the whole excitation."""
        if self.burst_fraction is None:
            return self.duration_s
        return self.burst_fraction * self.duration_s / (self.blocks or 1)

    @property
    def band_hz(self) -> tuple[float, float]:
        """The excited band, low to high."""
        return (min(self.start_hz, self.stop_hz), max(self.start_hz, self.stop_hz))

    @property
    def recorded_band_hz(self) -> tuple[float, float]:
        """What the record holds of the band, low to high: a sweep has left its beginning when that begins late."""
        passed = self.before_record_s / self.duration_s
        if self.kind == "linear-chirp":
            begun_hz = self.start_hz + passed * (self.stop_hz - self.start_hz)
        elif self.kind == "logarithmic-chirp":
            begun_hz = self.start_hz * (self.stop_hz / self.start_hz) ** passed
        else:
            return self.band_hz
        return (min(begun_hz, self.stop_hz), max(begun_hz, self.stop_hz))
