"""Where K is not symmetric a residue has two vectors, and all residues together are the inverse of the dynamics."""

from __future__ import annotations

import numpy as np

from vgvt.simulation.linear import LinearModel
from vgvt.simulation.modes import driven_vectors, eigenpairs


def unsymmetric(freedoms: int) -> LinearModel:
    """A chain whose stiffness is a hundredth short of symmetry, two of its poles 1e-4 apart."""
    generator = np.random.default_rng(4)
    lean = generator.standard_normal((freedoms, freedoms))
    squares = np.linspace(10.0, 60.0, freedoms) ** 2
    squares[3] = squares[2] * 1.0002
    return LinearModel(
        mass=np.eye(freedoms) + 0.001 * (lean + lean.T),
        damping=np.diag(0.01 * np.sqrt(squares)),
        stiffness=np.diag(squares) + 3.0 * lean,
        displacement=np.eye(freedoms),
        equilibrium=np.zeros(freedoms),
    )


def test_residues_of_all_modes_are_the_inverse() -> None:
    model = unsymmetric(9)
    poles, vectors = eigenpairs(model)
    assert poles.size == 9
    driven = driven_vectors(model, poles, vectors)
    for s in (12.0j, 30.3j, 1.0 + 44.0j):
        wanted = np.linalg.inv(s**2 * model.mass + s * model.damping + model.stiffness)
        got = (vectors / (s - poles)) @ driven.T + (vectors.conj() / (s - poles.conj())) @ driven.conj().T
        np.testing.assert_allclose(got, wanted, atol=1e-10 * np.abs(wanted).max())


def test_they_are_the_shapes_where_it_is_symmetric() -> None:
    model = unsymmetric(9)
    even = LinearModel(
        model.mass, model.damping, (model.stiffness + model.stiffness.T) / 2, model.displacement, model.equilibrium
    )
    poles, vectors = eigenpairs(even)
    np.testing.assert_allclose(driven_vectors(even, poles, vectors), vectors, atol=1e-9 * np.abs(vectors).max())
