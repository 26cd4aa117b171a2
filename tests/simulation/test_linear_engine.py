"""The linear engine is exact: for a command that is one cubic, against the matrix exponential, whatever the poles."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

from vgvt.simulation.linear import LinearModel
from vgvt.simulation.linear_engine import prepared, respond
from vgvt.simulation.state_space import StateSpace

Array = NDArray[np.float64]
RATE = 50.0


def model_of(state_matrix: Array, inputs: Array, rows: Array, feedthrough: Array) -> StateSpace:
    nothing = np.zeros((0, 0))
    return StateSpace(LinearModel(*[nothing] * 4, np.zeros(0)), state_matrix, inputs, rows, feedthrough)


def poles_at(*poles: complex) -> Array:
    """A real matrix with these poles and their conjugates, mixed by a random change of coordinates."""
    blocks = [np.array([[p.real, p.imag], [-p.imag, p.real]]) if p.imag else np.array([[p.real]]) for p in poles]
    diagonal = scipy.linalg.block_diag(*blocks)
    mix = np.random.default_rng(3).standard_normal(diagonal.shape)
    return np.asarray(mix @ diagonal @ np.linalg.inv(mix))


def cubic_exactly(model: StateSpace, coefficients: Array, samples: int) -> Array:
    """Outputs to u_i(t) = sum c_ij t^j from rest: t^0 … t^3 become states, the rest is one matrix exponential."""
    n, _inputs = model.inputs.shape
    whole = np.zeros((n + 4, n + 4))
    whole[:n, :n] = model.state_matrix
    whole[:n, n:] = model.inputs @ coefficients
    for j in (1, 2, 3):
        whole[n + j, n + j - 1] = j
    state = np.append(np.zeros(n), [1.0, 0.0, 0.0, 0.0])
    step = scipy.linalg.expm(whole / RATE)
    rows = np.hstack([model.output_matrix, model.feedthrough_rows @ coefficients])
    outputs = []
    for _ in range(samples):
        outputs.append(rows @ state)
        state = step @ state
    return np.array(outputs).T


@pytest.mark.parametrize(
    "poles",
    [(-0.3 + 12j, -0.02 + 3j), (-40 + 900j, -5000.0, -2.0), (0.0 + 5j, 0.0), (-1e-4 + 0.2j, -0.5 + 100j)],
    ids=["light", "stiff", "undamped and drifting", "slower than the record"],
)
@pytest.mark.parametrize("inputs", [1, 2])
def test_one_cubic_is_answered_as_by_the_matrix_exponential(poles: tuple[complex, ...], inputs: int) -> None:
    generator = np.random.default_rng(1)
    system = poles_at(*(complex(p) for p in poles))
    n, samples = len(system), 5000
    model = model_of(
        system,
        generator.standard_normal((n, inputs)),
        generator.standard_normal((3, n)),
        generator.standard_normal((3, inputs)),
    )
    # Of order one at the end of the record, and not zero at its start.
    coefficients = generator.standard_normal((inputs, 4)) / (samples / RATE) ** np.arange(4)
    command = coefficients @ (np.arange(samples) / RATE) ** np.arange(4)[:, None]
    wanted = cubic_exactly(model, coefficients, samples)
    got = respond(model, command, RATE)
    assert np.abs(got - wanted).max() < 1e-9 * np.abs(wanted).max()


def test_a_command_prepared_once_is_the_command(rng_seed: int = 4) -> None:
    generator = np.random.default_rng(rng_seed)
    model = model_of(poles_at(-0.3 + 12j), np.ones(2), np.eye(2), np.zeros(2))
    command = generator.standard_normal(300)
    np.testing.assert_array_equal(respond(model, command, RATE), respond(model, prepared(command), RATE))


def test_inputs_add_up() -> None:
    """Superposition: both at once is the sum of each alone."""
    generator = np.random.default_rng(5)
    system, gains = poles_at(-0.3 + 12j, -2 + 40j), generator.standard_normal((4, 2))
    commands = generator.standard_normal((2, 400))
    rows = generator.standard_normal((2, 4))
    both = respond(model_of(system, gains, rows, np.ones((2, 2))), commands, RATE)
    alone = [respond(model_of(system, gains[:, i], rows, np.ones(2)), commands[i], RATE) for i in (0, 1)]
    np.testing.assert_allclose(both, alone[0] + alone[1], atol=1e-12 * np.abs(both).max())
