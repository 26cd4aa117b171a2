"""What a reconciliation found, as arrays and labels that a page or a terminal shows: no model, no scenario."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Geometry
from vgvt.data.shown import counted, headed
from vgvt.view.power_account import PowerRow

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

FIGURES = ("factor", "factor_std", "shift", "shift_std", "stated", "calibrated", "calibrated_std")
"""What is known in numbers of a calibrated quantity, as far as it has it."""

Held = Literal["", "channel", "run"]
Standing = Literal[
    "named",
    "lead",
    "equivalent",
    "beaten",
    "refused by held-out data",
    "no plausible thing",
    "too little evidence",
    "its fit had not ended",
]


@dataclass(frozen=True, slots=True)
class ChannelRow:
    """One response of one run, and how it was held out of the fits, if it was."""

    label: str
    held: Held = ""


@dataclass(frozen=True, slots=True, eq=False)
class ModelState:
    """A model against the data: ``predicted`` (C, L) A/F, ``table`` (C, B) χ² per degree of freedom by band.

    ``figures`` are single numbers of the residual by name; ``merits`` {set of data: {figure: value}}.
    """

    predicted: ComplexArray
    table: Array
    figures: dict[str, float | None]
    merits: dict[str, dict[str, float] | None]
    adequate: bool


@dataclass(frozen=True, slots=True, eq=False)
class PlaceRow:
    """A place and the share of the residual that a free force there explains; ``stiffness`` (L,) is its z(ω) in N/m.

    Where something ``turns`` it is a free moment's, in N m/rad.
    What chance explains is taken off: where a place does no better the share is a little below 0.
    """

    label: str
    kind: str
    position_m: tuple[float, float, float] | None
    explained: float
    type: str
    size: float
    unit: str
    stiffness: ComplexArray | None = None
    turns: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class NamelessRow:
    """One thing that has no name, fitted: ``words`` of where and when, ``told`` how well it does, and its law.

    ``law`` (L,) is its dynamic stiffness in ``unit``, or what it adds to a factor of one; ``std`` (L,) one standard
    deviation of its real part, and of its imaginary part; ``read`` (L,) what it reads as, None where that is nothing
    simple. ``kind`` is as a place's.
    """

    words: str
    kind: str
    told: str
    unit: str
    frequency_hz: Array
    law: ComplexArray
    std: ComplexArray
    read: ComplexArray | None = None


@dataclass(frozen=True, slots=True)
class CandidateRow:
    """A fitted candidate: evidence, held-out χ² per degree of freedom before and after, and what became of it.

    Evidence is tempered, untempered, and where an error of the model's form lasts from line to line, which is a bound
    and no figure of a fit that has not ``converged``.
    """

    round: int
    label: str
    gain_nats: float
    raw_nats: float
    lasting_nats: float
    held_out_before: float | None
    held_out_after: float | None
    standing: Standing
    fitted: str = ""
    converged: bool = True


@dataclass(frozen=True, slots=True)
class ElsewhereRow:
    """A named effect at another place where it does as well: ``where`` in words, and what it is there, as a name is.

    ``parameters`` {name: (value, standard deviation, unit)}, ``ranges`` 95 % intervals; ``not_there`` is where the name
    has it.
    """

    where: str
    not_there: str
    parameters: dict[str, tuple[float, float, str]]
    settings: dict[str, object]
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    run_numbers: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class EffectRow:
    """An effect that was named: parameters {name: (value, standard deviation, unit)}, and what would separate it.

    ``ranges`` are 95 % intervals by parameter, ``tests_of_equivalent`` what would separate each ``equivalent``.
    ``run_numbers`` has what the campaign calls the run that a setting counts from 1, by setting; ``elsewhere`` are
    places where it does as well.
    """

    name: str
    summary: str
    parameters: dict[str, tuple[float, float, str]]
    settings: dict[str, object]
    evidence_nats: float
    equivalent: tuple[str, ...]
    held_out_before: float | None
    held_out_after: float | None
    signature: str
    separating_test: str
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    tests_of_equivalent: dict[str, str] = field(default_factory=dict)
    run_numbers: dict[str, int] = field(default_factory=dict)
    elsewhere: tuple[ElsewhereRow, ...] = ()


@dataclass(frozen=True, slots=True)
class PosteriorRow:
    """A calibrated quantity: ``score`` ± ``score_std`` prior standard deviations from what the scenario states.

    ``tolerance`` where the scenario states one: how coarse a chain the data come from is no statement of its.
    ``fresh_std`` is the part of ``score_std`` that noise and tolerances leave, None where it is not known. ``figures``
    are those that the words round, by name: factor or shift, the stated and calibrated value, each with ``_std``, in
    ``unit``.
    """

    name: str
    words: str
    score: float
    score_std: float
    change: str
    stated: str = ""
    calibrated: str = ""
    tolerance: bool = True
    fresh_std: float | None = None
    figures: dict[str, float] = field(default_factory=dict)
    unit: str = ""


@dataclass(frozen=True, slots=True)
class SeenRow:
    """A mode as records show it, and how far both models are from that, before and after, by the same fit of each.

    Deviations hold what such a fit is off on the responses of the model itself. Frequency and damping errors in per
    cent of what was measured, MAC of the shapes over all channels; None where a model does not show the mode.
    """

    frequency_hz: float
    frequency_std_hz: float
    damping_ratio: float
    damping_std: float
    frequency_error_percent: tuple[float | None, float | None]
    damping_error_percent: tuple[float | None, float | None]
    mac: tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class ModeRow:
    """A mode of both models and the error around it, before and after, on train and held-out channels.

    Errors are medians over channels of |predicted - measured| over |measured|, per cent, in a window around the mode.
    ``seen`` is the mode as the records show it, None where they do not.
    """

    before_hz: float | None
    after_hz: float | None
    before_damping_ratio: float | None
    after_damping_ratio: float | None
    mac: float | None
    train_percent: tuple[float, float]
    held_out_percent: tuple[float, float] | None
    seen: SeenRow | None = None


@dataclass(frozen=True, slots=True)
class SuggestionRow:
    """A change of procedure and the evidence that it is expected to put between two explanations."""

    test: str
    rivals: tuple[str, str]
    nats: float
    minutes: float


@dataclass(frozen=True, slots=True, eq=False)
class Account:
    """Everything that the page of a reconciliation shows, of C channels, L lines and B bands.

    ``measured`` and ``sigma`` (C, L); ``bands_hz`` (B + 1,); ``limits`` are the thresholds by name;
    ``located`` says at which model the places were found; ``nameless`` is one thing of no catalogue, where the verdict
    tells of one; ``leads`` come nearest where nothing has a name. ``resimulated`` are the merits {set of data: {figure:
    value}} of the augmented scenario's simulation, None where there was none; ``resimulation_remark`` is what the
    reader must know of it.
    ``turned`` says that the hold-out is another one than that of the first fits. ``noise_per_dof`` is what noise alone
    leaves of fitted data, ``model_form`` the relative error of the model's form in ``sigma``; None where not known.
    """

    title: str
    kind: str
    reasons: tuple[str, ...]
    unexplained: tuple[str, ...]
    facts: dict[str, str]
    geometry: Geometry
    channels: tuple[ChannelRow, ...]
    frequency_hz: Array
    measured: ComplexArray
    sigma: Array
    bands_hz: Array
    before: ModelState
    after: ModelState
    limits: dict[str, float]
    provenance: str
    effects: tuple[EffectRow, ...] = ()
    leads: tuple[EffectRow, ...] = ()
    candidates: tuple[CandidateRow, ...] = ()
    places: tuple[PlaceRow, ...] = ()
    located: str = ""
    nameless: NamelessRow | None = None
    posterior: tuple[PosteriorRow, ...] = ()
    modes: tuple[ModeRow, ...] = ()
    power: tuple[PowerRow, ...] = ()
    tests: tuple[SuggestionRow, ...] = ()
    remarks: tuple[str, ...] = field(default=())
    resimulated: dict[str, dict[str, float] | None] | None = None
    resimulation_remark: str = ""
    turned: bool = False
    noise_per_dof: float | None = None
    model_form: float | None = None

    def __repr__(self) -> str:
        names = ", ".join(e.name for e in self.effects)
        size = f"{counted(len(self.channels), 'channel')}, {counted(self.frequency_hz.size, 'line')}"
        return headed(f"Account of {self.title}: {self.kind.replace('_', ' ')}{names and f', {names}'}; {size}")

    @property
    def changed(self) -> bool:
        """Whether the model after is another one than before."""
        return bool(self.effects)

    @property
    def states(self) -> tuple[tuple[str, ModelState], ...]:
        """The models that are shown, each with what it is called: without an effect there is no before and after."""
        if not self.changed:
            return (("calibrated", self.before),)
        return ("before", self.before), ("after", self.after)

    @property
    def pointed_at(self) -> PlaceRow | None:
        """The place that explains most; None where none explains enough to be told."""
        best = self.places[0] if self.places else None
        return best if best is not None and best.explained >= self.limits.get("place_explained", 0.0) else None
