"""Adapter to pyOMA-2: its covariance-driven subspace realisation of the campaign's impulse responses.

pyOMA-2 is made for responses to an unmeasured, steady excitation. A roving test with a swept force is none,
but the force of each run turns it into impulse responses, free decays of one and the same
structure, and the covariances of free decays have its poles; James, Carne and Lauffer, The natural excitation
technique (NExT), Modal Analysis 10(4), 1995. Poles and shapes at every order are pyOMA-2's; the
choice among them without clicks, and the residues, are those of the other methods here.
"""

from __future__ import annotations

import contextlib
import io
import logging
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel
from vgvt.identification import Needs, Requirement
from vgvt_identifiers.impulse import ImpulseResponses, impulse_responses
from vgvt_identifiers.peers.table_claim import claim_of_tables, spectra_or_reason
from vgvt_identifiers.stabilisation import PolesAtOrder

_CITATION = """\
@article{pasca2022pyoma,
  author = {Pasca, Dag Pasquale and Aloisio, Angelo and Rosso, Marco Martino and Sotiropoulos, Stefanos},
  title = {{PyOMA} and {PyOMA\\_GUI}: A {Python} Module and Software for Operational Modal Analysis},
  journal = {SoftwareX},
  volume = {20},
  pages = {101216},
  year = {2022},
}

@article{peeters1999reference,
  author = {Peeters, Bart and De Roeck, Guido},
  title = {Reference-Based Stochastic Subspace Identification for Output-Only Modal Analysis},
  journal = {Mechanical Systems and Signal Processing},
  volume = {13},
  number = {6},
  pages = {855--878},
  year = {1999},
}
"""
_LARGEST_HANKEL = 900


@dataclass(frozen=True, slots=True)
class Pyoma2Ssi:
    """pyOMA-2's SSI of impulse responses, stabilised; fields are the settings."""

    name: ClassVar[str] = "pyoma2-ssi"
    summary: ClassVar[str] = (
        "pyOMA-2's covariance-driven subspace method on impulse responses, stabilised without clicks"
    )
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS
    requires: ClassVar[tuple[Requirement, ...]] = (Requirement("pyoma2", "vgvt[peers]"),)

    poles: Literal["per-run", "common"] = field(
        default="per-run", metadata={"doc": "each run by itself and merged, or all runs as if measured at once"}
    )
    largest_order: int = field(default=40, metadata={"doc": "most states of a model"})
    block_rows: int = field(default=40, metadata={"doc": "block rows of the Hankel matrix, fewer for many sensors"})
    samples: int = field(default=1200, metadata={"doc": "length of the impulse responses, at twice the highest line"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "largest_order": (4, 200),
            "block_rows": (4, 500),
            "samples": (100, 100_000),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(self.name, f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The poles inside ``band_hz`` that stay over the orders, of every run or shared, with residues and shapes."""
        spectra = spectra_or_reason(campaign, band_hz)
        if isinstance(spectra, ModalModel):
            return spectra
        sets = [run.accelerance for run in spectra.runs]
        if self.poles == "common":
            sets = [np.vstack(sets)]
        tables = [self._table(impulse_responses(spectra.frequency_hz, part, self.samples)) for part in sets]
        return claim_of_tables(campaign, spectra, tables, band_hz, self.largest_damping_ratio)

    def _table(self, decays: ImpulseResponses) -> list[PolesAtOrder]:
        from pyoma2.algorithms import SSI
        from pyoma2.setup import SingleSetup

        channels, samples = decays.values.shape
        rows = max(min(self.block_rows, _LARGEST_HANKEL // channels, samples // 4), 4)
        order = min(self.largest_order, (rows - 1) * channels) // 2 * 2
        limits: Any = {"xi_max": 1.0, "mpc_lim": None, "mpd_lim": None, "CoV_max": None}
        with _quiet():
            setup = SingleSetup(decays.values.T.copy(), fs=1 / decays.step_s)
            method = SSI(name="ssi", br=rows, ordmax=order, step=2, hc=limits)
            setup.add_algorithms(method)
            setup.run_by_name("ssi")
        return pole_table(method.result.Lambds, method.result.Phi_poles, 2, decays.shift_hz)


def pole_table(
    poles_rad_s: NDArray[np.complex128], shapes: NDArray[np.complex128], step: int, shift_hz: float
) -> list[PolesAtOrder]:
    """Rows of a table of poles (n, orders), rad/s, and shapes (n, orders, D), NaN where an order has no more.

    The first column is order 0, the next ones rise by ``step``; ``shift_hz`` is added to every frequency.
    """
    table = []
    for column in range(1, poles_rad_s.shape[1]):
        pole = poles_rad_s[:, column]
        sound = np.isfinite(pole) & np.isfinite(shapes[:, column]).all(axis=1) & (pole.imag > 0)
        moved = pole[sound] + 2j * np.pi * shift_hz
        table.append(PolesAtOrder(column * step, moved, shapes[sound, column]))
    return table


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without the library's progress bars and log lines; its logger is left as it was."""
    logger = logging.getLogger("pyoma2")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            yield
    finally:
        logger.setLevel(level)
