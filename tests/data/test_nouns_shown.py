"""What nouns show at a prompt: a few lines with units, of half-empty ones too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import (
    Campaign,
    Channel,
    ChannelRole,
    Dof,
    FrequencyResponseSet,
    FrfFit,
    Geometry,
    ModalModel,
    ModeScore,
    ModeStatus,
    Outcome,
    Quantity,
    Record,
    RigidBodyProperties,
    Scorecard,
    Truth,
)
from vgvt.data.shown import brief, counted, cut, headed, in_columns, listed
from vgvt.simulation import SimulationResult

D = Dof.from_label
FORCE = Channel("f", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, D("9+Z"))
DRIVE = Channel("command", Quantity.GENERAL, ChannelRole.DRIVE)
BODY = RigidBodyProperties(6.24, np.array([0.5, 0.0, 0.02]), np.diag([1.0, 2.0, 3.0]))
LONGEST_LINE, MOST_LINES = 250, 15


def campaign(responses: int = 40, runs: int = 2) -> Campaign:
    """Runs of two seconds at 50 Hz; the second is overloaded."""
    nodes = (*range(100, 100 + responses), 9)
    sensors = [Channel(f"a{n}", Quantity.ACCELERATION, ChannelRole.RESPONSE, D(f"{n}+Z")) for n in nodes[:-1]]
    channels = (FORCE, DRIVE, *sensors)
    records = [
        Record(run, 50.0, channels, np.zeros((len(channels), 100)), ("a100", "a101") if run == 2 else ())
        for run in range(1, runs + 1)
    ]
    positions = np.arange(3.0 * len(nodes)).reshape(-1, 3)
    return Campaign("long", Geometry(nodes, positions, ((100, 101),)), tuple(records), (2.0, 20.0))


def model(modes: int = 30, **changes: object) -> ModalModel:
    """Modes from 1 Hz on, 1 Hz apart, at forty points."""
    whole = ModalModel(
        np.arange(1.0, modes + 1.0),
        np.full(modes, 0.0123),
        np.ones((modes, 40), complex),
        tuple(D(f"{n}+Z") for n in range(100, 140)),
        natural_frequency_std_hz=np.full(modes, 0.00123),
        references=(D("9+Z"),),
        residues=np.ones((modes, 40, 1), complex),
        labels=tuple(f"mode {k}" for k in range(1, modes + 1)),
        method="era",
    )
    return replace(whole, **changes)


def frf(**changes: object) -> FrequencyResponseSet:
    """Forty responses at a thousand lines."""
    dofs = tuple(D(f"{n}+Z") for n in range(100, 140))
    values = np.ones((40, 1, 1000), complex)
    return replace(
        FrequencyResponseSet(dofs, (D("9+Z"),), np.arange(1000) / 50, values, (1,) * 40, variance=np.abs(values)),
        **changes,
    )


def scorecard(rows: int) -> Scorecard:
    """Found modes, a claim without a true one, and one that nobody could see."""
    found = tuple(ModeScore(ModeStatus.FOUND, k, k + 0.1, 0.01, 0.011, 0.99, label="bending") for k in range(1, rows))
    hidden = ModeScore(ModeStatus.UNREACHED, 99.0)
    return Scorecard("era", "quick", (2.0, 20.0), (*found, ModeScore(ModeStatus.FALSE, claimed_hz=50.0)), (hidden,))


def truth(runs: int = 2) -> Truth:
    return Truth("quick", BODY, model(), tuple(range(1, runs + 1)), (model(),) * runs, (model(),) * runs)


SHOWN = [
    (SimulationResult(campaign(), truth(), {"simulate": 1.2, "truth": 0.3}), "<SimulationResult in 1.5 s>"),
    (
        campaign(),
        "<Campaign long: 2 runs of 2 s at 50 Hz, 40 responses, force at 9+Z, 2 to 20 Hz; overloaded in run 2>",
    ),
    (campaign().runs[1], "<Record of run 2: 42 channels, 2 s at 50 Hz, overloaded: a100, a101>"),
    (FORCE, "<Channel f: reference, excitation force at 9+Z in N>"),
    (DRIVE, "<Channel command: drive, general in V>"),
    (campaign().response_dofs[:2], "(<100+Z>, <101+Z>)"),
    (campaign().geometry, "<Geometry: 41 nodes, 1 line, x 0 to 120 m, y 1 to 121 m, z 2 to 122 m>"),
    (
        frf(),
        "<FrequencyResponseSet: accelerances in (m/s^2)/N, 40 responses, force at 9+Z, 1000 lines from 0 to 19.98 Hz, "
        "with variance>",
    ),
    (model(), "<ModalModel (era): 30 modes, 40 points, force at 9+Z>"),
    (truth(), "<Truth of quick: 6.24 kg, 30 modes bare, 2 runs>"),
    (scorecard(30), "<Scorecard of era on quick: 29 found, 0 missed, 1 false, 1 unreached; 2 to 20 Hz>"),
    (
        scorecard(30).modes[0],
        "<ModeScore: found, true Hz 1.000, claimed Hz 1.100, Δf % +10.00, true ζ % 1.00, claimed ζ % 1.10, "
        "Δζ % +10.0, MAC 0.990, bending>",
    ),
    (
        FrfFit(
            (D("1+Z"), D("2+Z")), (D("9+Z"),), np.array([[99.0], [50.0]]), np.arange(3.0), np.array([0.0, 0.2, 0.1])
        ),
        "<FrfFit: 2 responses, force at 9+Z; NRMSE fit in the median 74.5 %, worst 50.0 % (at 2+Z); "
        "ν-gap at most 0.200, at 1 Hz>",
    ),
    (BODY, "<RigidBodyProperties: 6.24 kg, centre of gravity (0.5, 0, 0.02) m, moments of inertia 1, 2, 3 kg m^2>"),
]


@pytest.mark.parametrize(("thing", "first"), SHOWN, ids=lambda value: type(value).__name__)
def test_a_noun_says_what_it_is(thing: object, first: str) -> None:
    assert brief(thing) == first
    lines = repr(thing).splitlines()
    assert len(lines) <= MOST_LINES and max(map(len, lines)) <= LONGEST_LINE


def test_modes_are_a_table_that_is_cut() -> None:
    _, head, first, *_, last = repr(model()).splitlines()
    assert head.split("  ")[0] == "mode" and "damping %" in head
    assert first.split() == ["1", "1.000", "0.0012", "1.23", "mode", "1"]
    assert last == "… and 20 more"


def test_what_is_not_known_has_no_column() -> None:
    plain = replace(model(2), natural_frequency_std_hz=None, damping_ratio=np.array([np.nan, 0.01]), labels=())
    assert repr(plain).splitlines()[1:] == [
        "mode  frequency Hz  damping %",
        "   1         1.000",
        "   2         2.000       1.00",
    ]
    assert "±" not in repr(replace(model(2), natural_frequency_std_hz=np.full(2, np.nan)))


def test_a_model_without_modes_says_why() -> None:
    none = ModalModel.empty(Outcome.NOTHING_FOUND, ("too little force",), "era", (D("1+Z"),))
    assert repr(none) == "<ModalModel (era): no modes, 1 point, nothing found>\ntoo little force"
    assert repr(ModalModel.empty(Outcome.DECLINED, ())) == "<ModalModel: no modes, no points, declined>"
    assert "without the force" in repr(model(1, output_only=True))


def test_half_empty_nouns_are_shown() -> None:
    lines = np.zeros(1000, bool)
    assert "no lines" in repr(frf().lines(lines))
    unknown = FrequencyResponseSet((), (), np.empty(0), np.empty((0, 0, 0), complex), (), Quantity.UNKNOWN)
    assert repr(unknown) == "<FrequencyResponseSet: responses, no responses, force at none, no lines>"
    assert repr(truth(0)) == "<Truth of quick: 6.24 kg, 30 modes bare, no runs>"
    assert repr(Truth("quick", BODY, model(0), (1,), (model(0),), (model(0),))).endswith("as tested in run 1:")
    assert repr(Scorecard("era", "quick", (2.0, 20.0), ())).count("\n") == 0
    assert repr(ModeScore(ModeStatus.MISSED, 3.0, mac=np.nan)) == "<ModeScore: missed, true Hz 3.000>"
    assert repr(FrfFit((), (), np.empty((0, 0)), np.empty(0), np.empty(0))).startswith("<FrfFit: no responses")
    assert repr(Geometry((), np.empty((0, 3)))) == "<Geometry: no nodes, no lines>"
    silent = Record(1, 50.0, (DRIVE,), np.zeros((1, 50)))
    assert "no responses, no measured force" in repr(
        Campaign("c", Geometry((), np.empty((0, 3))), (silent,), (0.0, 1.0))
    )


def test_what_is_long_is_cut() -> None:
    assert (counted(0, "run"), counted(1, "run"), counted(2, "run")) == ("no runs", "1 run", "2 runs")
    assert listed(range(6)) == "0, 1, 2, 3 … and 2 more" and listed(range(4)) == "0, 1, 2, 3" and listed(()) == "none"
    assert cut("word\n  word") == "word word" and cut("x" * 500) == "x" * 239 + "…"
    assert headed("a", ["b"] * 4, most=2) == "<a>\nb\nb\n… and 2 more"
    assert in_columns(("n", "word"), []) == ""
    assert in_columns(("n", "word"), [("1", "a"), ("10", "bc")], words=("word",)) == " n  word\n 1  a\n10  bc"
