"""A Hati-like test: twenty points in two rows per wing, five modes, noise, two identifiers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from vgvt.data import (
    Campaign,
    Channel,
    ChannelRole,
    Direction,
    Dof,
    FrequencyResponseSet,
    Geometry,
    ModalModel,
    ModeScore,
    ModeStatus,
    Quantity,
    Record,
    RigidBodyProperties,
    Scorecard,
    Truth,
    modal_assurance,
    synthesise,
)

INCH = 0.0254
FORWARD_IN = ((17.87, 19.03), (27.14, 22.77), (36.42, 26.52), (45.69, 30.27), (54.96, 34.01))
AFT_IN = ((16.00, 23.66), (25.27, 27.41), (34.54, 31.16), (43.81, 34.90), (53.09, 38.65))
DRIVE = Dof(100, Direction.PLUS_Z)
FREQUENCY_HZ = np.array([7.93, 13.85, 15.97, 19.21, 31.9])
DAMPING = np.array([0.014, 0.011, 0.012, 0.018, 0.015])
LABELS = (
    "1st symmetric bending",
    "antisymmetric torsion",
    "1st antisymmetric bending",
    "symmetric torsion",
    "2nd symmetric bending",
)


@dataclass(frozen=True)
class Example:
    """Everything a report needs."""

    campaign: Campaign
    frf: FrequencyResponseSet
    truth: Truth
    claims: dict[str, ModalModel]
    scorecards: dict[str, Scorecard]


def planform() -> tuple[np.ndarray, ...]:
    half = [(0, 0), (0.331, 0.194), (0.842, 1.464), (0.943, 1.5275), (1.164, 1.5275), (0.700, 0.372), (0.852, 0)]
    ring = [(x, y, 0.0) for x, y in half] + [(x, -y, 0.0) for x, y in reversed(half[1:-1])]
    return (np.array(ring),)


def positions() -> dict[int, tuple[float, float, float]]:
    """Nodes 1 to 10 on the right wing, 11 to 20 on the left, forward and aft in turn."""
    found = {}
    for side, first in ((1, 1), (-1, 11)):
        for k, pair in enumerate(zip(FORWARD_IN, AFT_IN, strict=True)):
            for row, (y, x) in enumerate(pair):
                found[first + 2 * k + row] = (x * INCH, side * y * INCH, 0.0)
    return found | {100: (25 * INCH, 4.5 * INCH, 0.0)}


def hati_geometry() -> Geometry:
    place = positions()
    rows = [tuple(range(start, start + 10, 2)) for start in (1, 2, 11, 12)]
    ribs = [(start + 2 * k, start + 2 * k + 1) for start in (1, 11) for k in range(5)]
    return Geometry(tuple(place), np.array(list(place.values())), (*rows, *ribs), planform())


def mode_shapes(place: np.ndarray) -> np.ndarray:
    x, y = place[:, 0], place[:, 1]
    out = np.abs(y) / 1.5
    chordwise = (x - (0.395 + 0.405 * np.abs(y))) / 0.15
    return np.array(
        [
            out**2 - 0.22,
            np.sign(y) * (0.8 * chordwise * out + 0.25 * (out**2 - 0.3)),
            np.sign(y) * (1.3 * out**2 - 0.55 * out) + 0.08,
            chordwise * out + 0.2 * (out**2 - 0.35),
            4.4 * out**2 - 3.4 * out**3 - 0.9 * out**4 - 0.25,
        ]
    )


def true_model() -> ModalModel:
    place = positions()
    dofs = tuple(Dof(node, Direction.PLUS_Z) for node in place)
    shapes = mode_shapes(np.array(list(place.values()))).astype(complex)
    omega = 2 * np.pi * FREQUENCY_HZ * np.sqrt(1 - DAMPING**2)
    residues = shapes[:, :, None] * shapes[:, [-1], None] / (2j * omega[:, None, None] * 0.6)
    return ModalModel(
        FREQUENCY_HZ, DAMPING, shapes, dofs, references=(DRIVE,), residues=residues, labels=LABELS, method="truth"
    )


def hati_campaign() -> Campaign:
    runs = []
    for run in range(1, 11):
        sensors = tuple(Dof(2 * run - 1 + k, Direction.PLUS_Z) for k in range(2))
        channels = (
            Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, DRIVE),
            *(Channel(f"acc{d.node}", Quantity.ACCELERATION, ChannelRole.RESPONSE, d) for d in sensors),
        )
        runs.append(Record(run, 2000.0, channels, np.zeros((3, 4), dtype=np.float32)))
    return Campaign("hati-like", hati_geometry(), tuple(runs), (3.0, 35.0), {"Excitation": "chirp 1 to 35 Hz, 60 s"})


def noisy_frf(truth: ModalModel, dofs: tuple[Dof, ...], generator: np.random.Generator) -> FrequencyResponseSet:
    frequency = np.arange(60, 6000) / 60.0
    clean = synthesise(truth.at(dofs), frequency, runs=tuple((d.node + 1) // 2 for d in dofs))
    noise = generator.normal(size=(*clean.values.shape, 2)) @ np.array([1, 1j])
    return replace(clean, values=clean.values + 0.03 * noise)


def perturbed(truth: ModalModel, dofs: tuple[Dof, ...], generator: np.random.Generator, keep: list[int]) -> ModalModel:
    seen = truth.at(dofs).select(keep)
    size = seen.shapes.shape
    noise = 0.08 * (generator.normal(size=size) + 0.5j * generator.normal(size=size))
    return replace(
        seen,
        natural_frequency_hz=seen.natural_frequency_hz * (1 + 0.004 * generator.normal(size=size[0])),
        damping_ratio=seen.damping_ratio * (1 + 0.15 * generator.normal(size=size[0])),
        shapes=seen.shapes + noise,
        natural_frequency_std_hz=np.full(size[0], 0.03),
        labels=(),
    )


def with_false_mode(model: ModalModel, frequency_hz: float) -> ModalModel:
    frequency = np.append(model.natural_frequency_hz, frequency_hz)
    order = np.argsort(frequency)
    shapes = np.vstack([model.shapes, model.shapes[0] * np.exp(1j * np.linspace(0, 2.5, len(model.dofs)))])
    return ModalModel(
        frequency[order], np.append(model.damping_ratio, 0.03)[order], shapes[order], model.dofs,
        method="quadrature", advice=("two peaks closer than 0.3 Hz were merged",),
    )  # fmt: skip


def card_of(name: str, truth: ModalModel, claim: ModalModel, partner: dict[int, int]) -> Scorecard:
    """A scorecard by hand: true mode to claimed mode."""
    mac = modal_assurance(truth.at(claim.dofs).shapes, claim.shapes)
    rows = []
    for i in range(len(truth)):
        j = partner.get(i)
        known = {"true_hz": float(truth.natural_frequency_hz[i]), "true_damping_ratio": float(truth.damping_ratio[i])}
        row = ModeScore(ModeStatus.MISSED, label=truth.labels[i], true_index=i, true_spread_hz=0.02, **known)
        if j is not None:
            row = replace(row, status=ModeStatus.FOUND, mac=float(mac[i, j]), **claimed(claim, j))
        rows.append(row)
    spare = set(range(len(claim))) - set(partner.values())
    rows += [ModeScore(ModeStatus.FALSE, **claimed(claim, j)) for j in spare]
    rows.sort(key=lambda r: r.true_hz or r.claimed_hz or 0.0)
    return Scorecard(name, "hati-like", (3.0, 35.0), tuple(rows))


def claimed(claim: ModalModel, j: int) -> dict[str, float]:
    std = claim.natural_frequency_std_hz
    stated = {} if std is None else {"claimed_std_hz": float(std[j])}
    hertz, ratio = float(claim.natural_frequency_hz[j]), float(claim.damping_ratio[j])
    return {"claimed_hz": hertz, "claimed_damping_ratio": ratio, "claimed_index": j, **stated}


@pytest.fixture(scope="session")
def example() -> Example:
    generator = np.random.default_rng(7)
    model, campaign = true_model(), hati_campaign()
    dofs = campaign.response_dofs
    quadrature = with_false_mode(perturbed(model, dofs, generator, [0, 2, 3, 4]), 23.82)
    plscf = replace(perturbed(model, dofs, generator, [0, 1, 2, 3, 4]), method="plscf")
    body = RigidBodyProperties(6.24, np.array([0.603, 0.0, 0.0]), np.diag([2.8, 0.48, 2.9]))
    return Example(
        campaign=campaign,
        frf=noisy_frf(model, dofs, generator),
        truth=Truth("hati-like", body, model, (1,), (model,), (model,)),
        claims={"quadrature": quadrature, "plscf": plscf},
        scorecards={
            "quadrature": card_of("quadrature", model, quadrature, {0: 0, 2: 1, 3: 2, 4: 4}),
            "plscf": card_of("plscf", model, plscf, {k: k for k in range(5)}),
        },
    )
