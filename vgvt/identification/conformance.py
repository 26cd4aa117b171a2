"""The checks every identifier must pass; shipped, so that a plugin's whole test file is three lines.

    import pytest
    from vgvt.identification.conformance import checks

    @pytest.mark.parametrize("check", checks(), ids=str)
    def test_conformance(check):
        check(MyIdentifier())

Each check raises AssertionError with the reason. The campaigns come from
``vgvt.identification.example``, whose modes are known in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import (
    Campaign,
    ChannelRole,
    Direction,
    Dof,
    ModalModel,
    Outcome,
    Record,
    modal_assurance,
)
from vgvt.data.plugin import need_asserts
from vgvt.identification.citations import bibtex_entries
from vgvt.identification.example import Example
from vgvt.identification.isolation import forbidden_imports
from vgvt.identification.protocol import Identifier, Needs
from vgvt.identification.run import run_identifier

FREQUENCY_TOLERANCE = 1e-3
DAMPING_TOLERANCE = 0.05
SHAPE_TOLERANCE = 0.99
OUTPUT_ONLY_FREQUENCY_TOLERANCE = 1e-2
OUTPUT_ONLY_SHAPE_TOLERANCE = 0.97
"""A method without the force sees the excitation's colour as well, and no damping is asked of it."""


@dataclass(frozen=True, slots=True)
class Check:
    """One named check; call it with an identifier. ``str`` gives the name, so ``ids=str`` works in pytest."""

    name: str
    says: str
    run: Callable[[Identifier], None]

    def __call__(self, identifier: Identifier) -> None:
        """Raise AssertionError, with the reason, unless the identifier passes."""
        self.run(identifier)

    def __str__(self) -> str:
        return self.name


def checks() -> tuple[Check, ...]:
    """All checks, in the order in which a new plugin meets them; InputError where Python runs without assert (-O)."""
    need_asserts()
    functions = (
        is_a_frozen_dataclass_that_says_what_it_is,
        imports_nothing_that_knows_the_truth,
        finds_three_separated_modes,
        is_deterministic,
        leaves_its_input_alone,
        ignores_the_order_of_the_runs,
        ignores_the_gain_of_the_sensors,
        follows_the_sign_of_a_sensor,
        stays_inside_the_band,
        survives_a_dead_channel,
        survives_a_channel_that_is_not_finite,
        survives_a_band_of_few_lines,
        claims_nothing_unflagged_from_noise,
        declines_without_a_force_it_needs,
    )
    return tuple(Check(f.__name__, (f.__doc__ or "").splitlines()[0], f) for f in functions)


def is_a_frozen_dataclass_that_says_what_it_is(identifier: Identifier) -> None:
    """Fields are the settings, and it names itself, its source and its needs."""
    name = type(identifier).__name__
    parameters: Any = getattr(identifier, "__dataclass_params__", None)
    assert parameters is not None, f"{name} must be a dataclass: its fields are its settings"
    assert parameters.frozen, f"{name} must be frozen: @dataclass(frozen=True)"
    for attribute in ("name", "summary"):
        value = getattr(identifier, attribute, "")
        assert isinstance(value, str) and value.strip(), f"{name}.{attribute} must be a text"
    assert "\n" not in identifier.summary, f"{name}.summary must be one line"
    assert isinstance(getattr(identifier, "needs", None), Needs), f"{name}.needs must be a Needs flag"
    try:
        bibtex_entries(identifier.citation)
    except (AttributeError, TypeError, ValueError) as error:
        raise AssertionError(f"{name}.citation must be BibTeX of what it implements: {error}") from error


def imports_nothing_that_knows_the_truth(identifier: Identifier) -> None:
    """In a process of its own, import and one identification load no module that knows the answer."""
    seen = forbidden_imports(type(identifier))
    assert not seen, f"{type(identifier).__name__} loads {', '.join(seen)}; an identifier sees the campaign only"


def finds_three_separated_modes(identifier: Identifier) -> None:
    """Without noise, three well-separated modes come out with their frequency, damping and shape."""
    example = Example()
    model = run_identifier(identifier, _campaign(identifier, example))
    _assert_right(identifier, model, example.modes(), complete=True)


def is_deterministic(identifier: Identifier) -> None:
    """The same campaign gives the same claim to the last bit, and nobody's random numbers are drawn."""
    campaign = _campaign(identifier, _noisy())
    state = np.random.get_state(legacy=False)  # noqa: NPY002  the global stream is what is being watched
    first, second = (run_identifier(identifier, campaign) for _ in range(2))
    after = np.random.get_state(legacy=False)  # noqa: NPY002
    for name in ("natural_frequency_hz", "damping_ratio", "shapes"):
        same = np.array_equal(getattr(first, name), getattr(second, name))
        assert same, f"two identifications of one campaign differ in {name}; seed every random number from a setting"
    assert repr(state) == repr(after), "the global random stream of numpy was used; make a generator from a setting"


def leaves_its_input_alone(identifier: Identifier) -> None:
    """The samples, positions and notes of the campaign are as they were."""
    campaign = _campaign(identifier, _noisy())
    before = [r.samples.copy() for r in campaign.runs]
    positions, notes = campaign.geometry.positions_m.copy(), dict(campaign.notes)
    run_identifier(identifier, campaign)
    for record, samples in zip(campaign.runs, before, strict=True):
        assert np.array_equal(record.samples, samples), f"the samples of run {record.run} were changed; work on a copy"
    assert np.array_equal(campaign.geometry.positions_m, positions), "the positions were changed; work on a copy"
    assert campaign.notes == notes, "the notes of the campaign were changed; work on a copy"


def ignores_the_order_of_the_runs(identifier: Identifier) -> None:
    """The order in which runs are listed is no information."""
    campaign = _campaign(identifier, _noisy())
    shuffled = replace(campaign, runs=campaign.runs[::-1])
    _assert_same(run_identifier(identifier, campaign), run_identifier(identifier, shuffled), "the runs are reordered")


def ignores_the_gain_of_the_sensors(identifier: Identifier) -> None:
    """Ten times the response, as with another unit, changes no frequency, damping or shape."""
    campaign = _campaign(identifier, _noisy())
    louder = _with_samples(campaign, lambda r: np.where(_is_response(r)[:, None], 10 * r.samples, r.samples))
    _assert_same(run_identifier(identifier, campaign), run_identifier(identifier, louder), "every response is x 10")


def follows_the_sign_of_a_sensor(identifier: Identifier) -> None:
    """A sensor glued upside down and labelled so, 3-Z for 3+Z, gives the same shape."""
    campaign = _campaign(identifier, _noisy())
    flipped = replace(campaign, runs=tuple(_upside_down(r, node=3) for r in campaign.runs))
    plain, turned = run_identifier(identifier, campaign), run_identifier(identifier, flipped)
    down = Dof(3, Direction.MINUS_Z)
    assert down in turned.dofs, f"the shape must be given at the DOF that was measured, {down}; it has {_names(turned)}"
    _assert_same(plain, turned, "sensor 3+Z is mounted as 3-Z")


def stays_inside_the_band(identifier: Identifier) -> None:
    """In a narrower band it claims the modes inside it, in order, and no other."""
    example, band = Example(), (4.0, 20.0)
    model = run_identifier(identifier, _campaign(identifier, example), band)
    _assert_claim(model, band)
    _assert_right(identifier, model, example.modes().band(*band), complete=True)


def survives_a_dead_channel(identifier: Identifier) -> None:
    """A response that is zero throughout is named in the advice, and what is claimed is right."""
    _survives(identifier, _broken(0.0), "is dead (all zeros)")


def survives_a_channel_that_is_not_finite(identifier: Identifier) -> None:
    """A response of NaN is named in the advice, and what is claimed is right."""
    _survives(identifier, _broken(float("nan")), "is NaN")


def survives_a_band_of_few_lines(identifier: Identifier) -> None:
    """A band too short to tell anything, away from all modes, gives no mode and a reason."""
    model = run_identifier(identifier, _campaign(identifier, Example()), (19.0, 19.2))
    _assert_claim(model, (19.0, 19.2))
    assert len(model) == 0, f"claims {model.natural_frequency_hz} Hz in 19.0 to 19.2 Hz, where there is no mode"


def claims_nothing_unflagged_from_noise(identifier: Identifier) -> None:
    """Of sensors that record noise alone, every mode claimed carries a flag that doubts it."""
    campaign = _campaign(identifier, Example())
    generator = np.random.default_rng(20160915)

    def noise(record: Record) -> NDArray[np.floating]:
        return np.where(_is_response(record)[:, None], generator.standard_normal(record.samples.shape), record.samples)

    model = run_identifier(identifier, _with_samples(campaign, noise))
    _assert_claim(model, campaign.band_hz)
    doubted = [any("doubt" in flag or "noise" in flag for flag in flags) for flags in model.flags]
    sure = model.natural_frequency_hz[~np.array(doubted, dtype=bool)] if doubted else model.natural_frequency_hz
    assert sure.size == 0, f"claims modes at {sure} Hz of pure noise; claim none, or flag them with 'doubtful'"


def declines_without_a_force_it_needs(identifier: Identifier) -> None:
    """On a campaign without a force it declines with a reason if it needs one, and never crashes."""
    campaign = without_force(Example().campaign())
    model = run_identifier(identifier, campaign)
    _assert_claim(model, campaign.band_hz)
    if Needs.FORCE_REFERENCE in identifier.needs:
        assert model.outcome is Outcome.DECLINED, f"must decline without a force, but ended as {model.outcome}"


def without_force(campaign: Campaign) -> Campaign:
    """The same campaign as an output-only one."""

    def strip(record: Record) -> Record:
        keep = [i for i, c in enumerate(record.channels) if c.role is ChannelRole.RESPONSE]
        return replace(record, channels=tuple(record.channels[i] for i in keep), samples=record.samples[keep])

    return replace(campaign, runs=tuple(strip(r) for r in campaign.runs))


def _campaign(identifier: Identifier, example: Example) -> Campaign:
    """A roving sweep with its force, or for methods without one all sensors at once under steady white forces."""
    return example.ambient_campaign() if Needs.OUTPUT_ONLY in identifier.needs else example.campaign()


def _noisy() -> Example:
    """For claims that are compared with each other: of exact records rounding chooses among orders that are as good."""
    return Example(noise_m_s2=0.02, force_noise_n=0.002, seed=3)


def _is_response(record: Record) -> NDArray[np.bool_]:
    return np.array([c.role is ChannelRole.RESPONSE for c in record.channels])


def _with_samples(campaign: Campaign, change: Callable[[Record], NDArray[np.floating]]) -> Campaign:
    return replace(campaign, runs=tuple(replace(r, samples=change(r)) for r in campaign.runs))


def _upside_down(record: Record, node: int) -> Record:
    channels, samples = list(record.channels), record.samples.copy()
    for i, channel in enumerate(channels):
        if channel.dof == Dof(node, Direction.PLUS_Z) and channel.role is ChannelRole.RESPONSE:
            channels[i] = replace(channel, dof=Dof(node, Direction.MINUS_Z))
            samples[i] = -samples[i]
    return replace(record, channels=tuple(channels), samples=samples)


def _broken(value: float) -> Callable[[Record], NDArray[np.floating]]:
    """Samples with the response at node 4 set to a value: zero throughout, or NaN for a while."""

    def change(record: Record) -> NDArray[np.floating]:
        samples = record.samples.copy()
        for i, channel in enumerate(record.channels):
            if channel.dof == Dof(4, Direction.PLUS_Z):
                samples[i, (0 if value == 0 else 100) :] = value
        return samples

    return change


def _survives(identifier: Identifier, change: Callable[[Record], NDArray[np.floating]], state: str) -> None:
    example = Example()
    campaign = _with_samples(_campaign(identifier, example), change)
    model = run_identifier(identifier, campaign)
    _assert_claim(model, campaign.band_hz)
    named = any("4+Z" in text or "a4" in text for text in model.advice)
    assert named, f"channel a4 (4+Z) {state}, and the advice does not name it: {model.advice}"
    sound = tuple(d for d in model.dofs if d.node != 4)
    if len(model):
        _assert_right(identifier, model.at(sound), example.modes(), complete=False)


def _assert_claim(model: ModalModel, band: tuple[float, float]) -> None:
    f = model.natural_frequency_hz
    assert np.isfinite(f).all() and np.isfinite(model.damping_ratio).all(), "a frequency or damping is not finite"
    assert np.isfinite(model.shapes).all(), "a shape is not finite; leave out the DOFs that were not measured"
    assert np.all(np.diff(f) >= 0), "modes must be in order of frequency"
    assert np.all((f >= band[0]) & (f <= band[1])), f"claims {f} Hz outside the band {band}"
    if len(model) == 0:
        assert model.outcome is not Outcome.FOUND, "found nothing, but the outcome says found"
        assert model.advice, "claims nothing and does not say why (advice)"


def _assert_right(identifier: Identifier, model: ModalModel, truth: ModalModel, complete: bool) -> None:
    """Every true mode is claimed within tolerance; ``complete`` also forbids any other claim."""
    blind = Needs.OUTPUT_ONLY in identifier.needs
    tolerance = OUTPUT_ONLY_FREQUENCY_TOLERANCE if blind else FREQUENCY_TOLERANCE
    here = truth.at(model.dofs)
    claimed = model.natural_frequency_hz
    assert claimed.size, f"found no mode: {model.outcome}, {model.advice}"
    for i, true_hz in enumerate(here.natural_frequency_hz):
        nearest = int(np.argmin(np.abs(claimed - true_hz)))
        error = abs(claimed[nearest] / true_hz - 1)
        assert error < tolerance, f"no mode within {tolerance:.1%} of {true_hz} Hz; claims {claimed} Hz"
        mac = float(modal_assurance(model.shapes[nearest], here.shapes[i])[0, 0])
        wanted = OUTPUT_ONLY_SHAPE_TOLERANCE if blind else SHAPE_TOLERANCE
        assert mac > wanted, f"the shape at {true_hz} Hz has a MAC of {mac:.3f}, below {wanted}"
        if not blind:
            wrong = abs(model.damping_ratio[nearest] / here.damping_ratio[i] - 1)
            assert wrong < DAMPING_TOLERANCE, f"the damping ratio at {true_hz} Hz is {wrong:.0%} wrong"
    if complete:
        assert len(model) == len(truth), f"claims {claimed} Hz, but there are modes at {truth.natural_frequency_hz} Hz"


def _assert_same(first: ModalModel, second: ModalModel, what: str) -> None:
    """Two claims agree far within the tolerance of the claims themselves, at the DOFs of the first."""
    assert len(first) == len(second), f"{len(first)} modes become {len(second)} when {what}"
    if not len(first):
        raise AssertionError(f"no mode to compare: {first.outcome}, {first.advice}")
    frequency = np.abs(second.natural_frequency_hz / first.natural_frequency_hz - 1).max()
    assert frequency < 1e-6, f"frequencies move by {frequency:.1e} when {what}"
    damping = np.abs(second.damping_ratio - first.damping_ratio).max() / np.abs(first.damping_ratio).max()
    assert damping < 1e-4, f"damping ratios move by {damping:.1e} when {what}"
    shapes = np.diag(modal_assurance(first.shapes, second.at(first.dofs).shapes))
    assert shapes.min() > 1 - 1e-6, f"shapes change (MAC {shapes.min():.6f}) when {what}"


def _names(model: ModalModel) -> str:
    return ", ".join(map(str, model.dofs))
