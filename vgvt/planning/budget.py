"""The budget of a test: minutes in the lab, accelerometers, and what setting up takes of the minutes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from vgvt.data import InputError
from vgvt.data.key_paths import key_path
from vgvt.scenario.explain import problems_of
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Excitation

MOUNT_EFFECT = "mount-compliance"


@dataclass(frozen=True, slots=True)
class Mount:
    """A way to fix the force transducer, the parameters of the effect that stands for it, and whether it must cure."""

    name: str
    words: str
    effect: tuple[tuple[str, float], ...] = ()
    cures: bool = True


AS_DESCRIBED = Mount("as-described", "as the scenario describes it")
CLAY = Mount(
    "modelling-clay",
    "modelling clay, a disc 13 mm across and 3 mm thick",
    (("compliance_m_per_n", 2.5e-5), ("loss_factor", 0.5), ("frequency_hz", 10.0)),
    cures=False,
)
MOUNTS = (AS_DESCRIBED, CLAY)


@dataclass(frozen=True, slots=True)
class Budget:
    """What there is to spend; the minutes of setting up are estimates to be replaced by a lab's own.

    ``setup_minutes`` to place the accelerometers of one run, ``mount_minutes`` to fix the transducer with what
    must cure, ``clay_minutes`` with what need not. One sweep takes ``longest_sweep_s`` at most, more
    time goes into repeats.
    """

    minutes: float
    sensors: int
    setup_minutes: float = 0.5
    mount_minutes: float = 5.0
    clay_minutes: float = 1.0
    longest_sweep_s: float = 300.0

    def minutes_of(self, scenario: Scenario, mount: Mount = AS_DESCRIBED, runs: int | None = None) -> float:
        """What a scenario's campaign takes: fixing the transducer, placing sensors run by run, and the records.

        In its own runs, or in another number of ``runs`` with its repeats.
        """
        count = len(scenario.acquisition.runs) if runs is None else runs
        records = count * scenario.acquisition.repeats * scenario.excitation.whole_s / 60
        return self._fixed(count, mount) + records

    def sweep(self, scenario: Scenario, runs: int, mount: Mount) -> tuple[float, int]:
        """Seconds of one sweep and how often each run repeats it, so that ``runs`` fill the budget.

        InputError where they leave less than a sweep takes, or less than what a scenario's excitation is made of.
        """
        excitation = scenario.excitation
        silence, shortest_s = excitation.lead_in_s + excitation.ring_down_s, self.shortest_sweep_s(scenario)
        if self.longest_sweep_s < shortest_s:
            raise InputError(
                "--longest-sweep",
                f"is {self.longest_sweep_s:g} s, but from {excitation.band_hz[0]:g} Hz on a sweep takes "
                f"{shortest_s:.3g} s at least",
                f"write {math.ceil(shortest_s)} or more",
            )
        each = (self.minutes - self._fixed(runs, mount)) * 60 / runs
        repeats = max(math.ceil(each / (self.longest_sweep_s + silence)), 1)
        duration = math.floor(10 * (each / repeats - silence)) / 10
        if duration < shortest_s:
            raise InputError(
                "--minutes",
                f"{self.minutes:g} min leave {max(each, 0):.0f} s for each of {runs} runs with their silences",
                "give more minutes, more accelerometers at once, or fewer points",
            )
        self._check_fits(excitation, duration)
        return duration, repeats

    def _check_fits(self, excitation: Excitation, duration_s: float) -> None:
        """InputError where dwells, blocks or a taper need a longer excitation: no file of such a plan could be read."""
        keys = excitation.model_dump(exclude_none=True) | {"duration_s": duration_s}
        try:
            Excitation.model_validate(keys)
        except ValidationError as error:
            first = problems_of(error)[0]
            advice = first.advice[:1].lower() + first.advice[1:]
            raise InputError(
                "--minutes",
                f"{self.minutes:g} min leave an excitation of {duration_s:g} s, for which excitation."
                f"{key_path(first.key)} {first.text}",
                f"give more minutes, a longer --longest-sweep, or change the scenario: {advice}",
            ) from None

    @staticmethod
    def shortest_sweep_s(scenario: Scenario) -> float:
        """A sweep shorter than this is no test: ten cycles of its lowest frequency, or two seconds, all recorded."""
        excitation = scenario.excitation
        return excitation.before_record_s + max(2.0, 10 / max(excitation.band_hz[0], 0.1))

    def _fixed(self, runs: int, mount: Mount) -> float:
        return (self.mount_minutes if mount.cures else self.clay_minutes) + runs * self.setup_minutes

    def as_dict(self) -> dict[str, Any]:
        """The budget with the keys of the JSON contract."""
        return {
            "minutes": self.minutes,
            "sensors": self.sensors,
            "setup_minutes": self.setup_minutes,
            "mount_minutes": self.mount_minutes,
            "clay_minutes": self.clay_minutes,
            "longest_sweep_s": self.longest_sweep_s,
        }
