"""The simulator's chain of rigid links converges to the closed-form frequencies of uniform beams.

A clamp (half a hinge at the root) and torsion make the chain second order. In free bending it does better: rods of
length h on hinges have the stiffness EI k^4 (1 - (k h)^2/6 + (k h)^4/80) and the mass m (1 - (k h)^2/6 + (k h)^4/72);
the second-order terms cancel and -(k h)^4/1440 of the frequency remains. Torsion leaves -(k h)^2/24.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from uniform_beams import CLAMPED_FREE, FREE_FREE, UniformBeam, cantilever, free_beam, virtual_test

from vgvt.data import Dof, ModalModel
from vgvt.simulation import truth_of

CELLS = (4, 8, 16, 32)
BEAM = UniformBeam()
"""Its first bending and torsion modes lie between 2 and 40 Hz, far from one another."""


@dataclass(frozen=True)
class Case:
    """How a beam is held, what it does, the exact frequencies, the phase per length and the law of convergence."""

    clamped: bool
    torsion: bool
    exact_hz: NDArray[np.float64]
    order: int

    def errors(self) -> NDArray[np.float64]:
        """Relative errors (cells, modes) of the bare airframe's frequencies."""
        return np.array([self.found_hz(cells) / self.exact_hz - 1 for cells in CELLS])

    def found_hz(self, cells: int) -> NDArray[np.float64]:
        """The simulator's frequencies for as many modes as are known exactly."""
        airframe = cantilever(BEAM, cells) if self.clamped else free_beam(BEAM, cells)
        bare = truth_of(virtual_test(airframe, BEAM.length_m, mirror=not self.clamped)).bare
        found = split_modes(bare)[int(self.torsion)]
        assert found.size >= self.exact_hz.size, f"{cells} cells: {found.size} modes, {self.exact_hz.size} expected"
        return found[: self.exact_hz.size]


CLAMPED_BENDING = Case(True, False, BEAM.bending_hz(CLAMPED_FREE)[:2], 2)
CLAMPED_TORSION = Case(True, True, BEAM.torsion_hz(np.array([1.0])), 2)
FREE_BENDING = Case(False, False, BEAM.bending_hz(FREE_FREE, 2 * BEAM.length_m)[:3], 4)
FREE_TORSION = Case(False, True, BEAM.torsion_hz(np.array([2.0, 4.0]), 2 * BEAM.length_m), 2)


def split_modes(model: ModalModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies of the bending and of the torsion modes, told apart ahead of the axis and behind it at the tip."""
    ahead, behind = (model.at((Dof.from_label(label),)).shapes[:, 0] for label in ("15+Z", "16+Z"))
    bending = np.abs(ahead + behind) > np.abs(ahead - behind)
    return model.natural_frequency_hz[bending], model.natural_frequency_hz[~bending]


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(CLAMPED_BENDING, id="cantilever-bending"),
        pytest.param(CLAMPED_TORSION, id="cantilever-torsion"),
        pytest.param(FREE_BENDING, id="free-bending"),
        pytest.param(FREE_TORSION, id="free-torsion"),
    ],
)
def test_frequencies_converge_at_the_expected_order(case: Case) -> None:
    error = np.abs(case.errors())
    assert np.all(np.diff(error, axis=0) < 0), f"more cells must be more exact:\n{error}"
    order = -np.polyfit(np.log(CELLS[1:]), np.log(error[1:]), 1)[0]
    np.testing.assert_allclose(order, case.order, atol=0.1, err_msg=f"errors\n{error}")
    assert np.all(error[-1] < 1e-3)


def test_free_bending_errs_by_the_fourth_power_of_the_phase_per_link() -> None:
    phase = FREE_FREE[:3] / (2 * 32)
    np.testing.assert_allclose(FREE_BENDING.errors()[-1], -(phase**4) / 1440, rtol=0.1)


def test_free_torsion_errs_by_the_square_of_the_phase_per_link() -> None:
    phase = np.pi * np.array([1.0, 2.0]) / (2 * 32)
    np.testing.assert_allclose(FREE_TORSION.errors()[-1], -(phase**2) / 24, rtol=0.02)


def test_default_cells_are_within_half_a_per_cent_of_the_first_clamped_mode() -> None:
    """Twelve links serve the modes that a ground vibration test looks at; the second mode is within one per cent."""
    error = np.abs(CLAMPED_BENDING.found_hz(12) / CLAMPED_BENDING.exact_hz - 1)
    assert error[0] < 0.005
    assert error[1] < 0.01
