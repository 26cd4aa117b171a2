"""A modal model as a state space: same frequency response, fewest states, nothing else."""

from __future__ import annotations

import control
import numpy as np
import pytest

from vgvt.data import Direction, Dof, InputError, ModalModel, Quantity, synthesise
from vgvt.identification import to_state_space

MOTIONS = (Quantity.DISPLACEMENT, Quantity.VELOCITY, Quantity.ACCELERATION)
FREQUENCY_HZ = np.linspace(0.5, 40, 311)


def structure(modes: int, dofs: int, references: int, seed: int = 4) -> ModalModel:
    """A structure with real normal modes of mass 1 kg, so with imaginary residues."""
    generator = np.random.default_rng(seed)
    frequency = np.sort(generator.uniform(3, 30, modes))
    damping = generator.uniform(0.005, 0.03, modes)
    shapes = generator.standard_normal((modes, dofs))
    labels = tuple(Dof(i + 1, Direction.PLUS_Z) for i in range(dofs))
    damped = 2 * np.pi * frequency * np.sqrt(1 - damping**2)
    residues = shapes[:, :, None] * shapes[:, None, :references] / (2j * damped[:, None, None])
    return ModalModel(
        frequency, damping, shapes.astype(complex), labels, references=labels[:references], residues=residues
    )


def response(system: control.StateSpace) -> np.ndarray:
    return np.asarray(system(2j * np.pi * FREQUENCY_HZ, squeeze=False))


@pytest.mark.parametrize("quantity", MOTIONS)
@pytest.mark.parametrize("references", [1, 3])
def test_its_frequency_response_is_the_synthesised_one(quantity: Quantity, references: int) -> None:
    model = structure(5, 7, references)
    system = to_state_space(model, quantity)
    expected = synthesise(model, FREQUENCY_HZ, quantity).values
    assert np.abs(response(system) - expected).max() < 1e-10 * np.abs(expected).max()
    assert system.nstates == 2 * len(model)
    assert system.isctime()


def test_poles_and_labels_are_those_of_the_model() -> None:
    model = structure(4, 3, 2)
    system = to_state_space(model)
    poles = np.sort_complex(system.poles())
    expected = np.sort_complex(np.concatenate([model.poles, model.poles.conj()]))
    assert poles == pytest.approx(expected, rel=1e-9)
    assert system.input_labels == [str(r) for r in model.references]
    assert system.output_labels == [str(d) for d in model.dofs]


def test_residues_that_references_do_not_share_take_states_of_their_own() -> None:
    model = structure(3, 6, 3)
    assert model.residues is not None
    generator = np.random.default_rng(8)
    mixed = model.residues + 0.1j * generator.standard_normal(model.residues.shape) * np.abs(model.residues).max()
    loose = ModalModel(
        model.natural_frequency_hz, model.damping_ratio, model.shapes, model.dofs,
        references=model.references, residues=mixed,
    )  # fmt: skip
    system = to_state_space(loose, Quantity.DISPLACEMENT)
    expected = synthesise(loose, FREQUENCY_HZ, Quantity.DISPLACEMENT).values
    assert np.abs(response(system) - expected).max() < 1e-10 * np.abs(expected).max()
    assert system.nstates == 2 * 3 * len(model)


def test_only_the_velocity_jump_of_wrong_residues_is_left_out() -> None:
    model = structure(3, 4, 1)
    assert model.residues is not None
    wrong = ModalModel(
        model.natural_frequency_hz, model.damping_ratio, model.shapes, model.dofs,
        references=model.references, residues=model.residues * np.exp(0.05j),
    )  # fmt: skip
    missing = synthesise(wrong, FREQUENCY_HZ).values - response(to_state_space(wrong))
    jump = 2 * wrong.residues.real.sum(axis=0)[:, :, None] * (2j * np.pi * FREQUENCY_HZ)
    assert np.abs(missing - jump).max() < 1e-9 * np.abs(jump).max()


def test_it_refuses_what_has_no_size_and_what_is_no_motion() -> None:
    model = structure(2, 3, 1)
    bare = ModalModel(model.natural_frequency_hz, model.damping_ratio, model.shapes, model.dofs)
    with pytest.raises(InputError, match="no residues"):
        to_state_space(bare)
    with pytest.raises(InputError, match="no modes"):
        to_state_space(model.band(100, 200))
    with pytest.raises(InputError, match="no motion"):
        to_state_space(model, Quantity.REACTION_FORCE)
