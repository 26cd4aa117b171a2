"""Adapter to sdypy-EMA: its least-squares complex frequency estimator on the campaign's accelerances.

Poles at every order are sdypy-EMA's; the choice among them without clicks, and
the residues of every run, are those of the other methods here.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel
from vgvt.identification import Needs, Requirement
from vgvt_identifiers.peers.table_claim import claim_of_tables, spectra_or_reason
from vgvt_identifiers.stabilisation import PolesAtOrder

_CITATION = """\
@software{zaletelj2020sdypy,
  author = {Zaletelj, Klemen and Bregar, Toma{\\v{z}} and Gorjup, Domen and Slavi{\\v{c}}, Janko},
  title = {{sdypy-EMA}: Experimental Modal Analysis in {Python}},
  url = {https://github.com/sdypy/sdypy-EMA},
}

@phdthesis{verboven2002frequency,
  author = {Verboven, Peter},
  title = {Frequency-Domain System Identification for Modal Analysis},
  school = {Vrije Universiteit Brussel},
  year = {2002},
}
"""


@dataclass(frozen=True, slots=True)
class SdypyLscf:
    """sdypy-EMA's LSCF poles, stabilised, and residues for them; fields are the settings."""

    name: ClassVar[str] = "sdypy-lscf"
    summary: ClassVar[str] = "sdypy-EMA's least-squares complex frequency method, stabilised without clicks"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS
    requires: ClassVar[tuple[Requirement, ...]] = (Requirement("sdypy.EMA", "vgvt[peers]"),)

    largest_order: int = field(default=30, metadata={"doc": "highest order of the denominator, in pairs of poles"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {"largest_order": (2, 200), "largest_damping_ratio": (1e-6, 1.0)}
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(self.name, f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The poles inside ``band_hz`` that stay over the orders, shared by all runs, with residues and shapes."""
        spectra = spectra_or_reason(campaign, band_hz)
        if isinstance(spectra, ModalModel):
            return spectra
        accelerance = np.vstack([run.accelerance for run in spectra.runs])
        table = self._poles(spectra.frequency_hz, accelerance)
        return claim_of_tables(campaign, spectra, [table], band_hz, self.largest_damping_ratio)

    def _poles(self, frequency_hz: NDArray[np.float64], accelerance: NDArray[np.complex128]) -> list[PolesAtOrder]:
        from sdypy import EMA

        # The method's axis starts at 0 Hz; filled up here, as rounding may cost the library's own filling a line.
        step = float(frequency_hz[-1] - frequency_hz[0]) / (frequency_hz.size - 1)
        below = round(float(frequency_hz[0]) / step)
        axis = step * np.arange(below + frequency_hz.size)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a limit that falls between two lines
            model = EMA.Model(
                frf=np.pad(accelerance, ((0, 0), (below, 0))),
                freq=axis,
                lower=float(axis[below]),
                upper=float(axis[-1]),
                pol_order_high=self.largest_order,
                frf_form="accelerance",
            )
            model.get_poles(method="lscf", show_progress=False)
        return pole_table(model.all_poles)


def pole_table(poles_of_orders: list[NDArray[np.complex128]]) -> list[PolesAtOrder]:
    """Rows of the poles, rad/s, of orders 2, 4, 6 ...; a common denominator has no shapes, so vectors are all alike."""
    table = []
    for place, poles in enumerate(poles_of_orders):
        sound = poles[np.isfinite(poles) & (poles.imag > 0) & (poles.real < 0)]
        table.append(PolesAtOrder(2 * (place + 1), sound, np.ones((sound.size, 1), complex)))
    return table
