"""Curve-fitting frequency domain decomposition of the responses alone, for sensors that were measured together.

Without the force the spectra peak where excitation and structure together do: on a shaker, at the combined
resonances of shaker and aircraft. It is right for ambient or other broad-band excitation that nobody measured.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from vgvt.data import Campaign, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.bell_modes import BellMode, BellOptions, bell_modes, second_peaks
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.cfdd import CITATION
from vgvt_identifiers.density_peaks import density_peaks
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.output_spectra import Decomposition, output_only
from vgvt_identifiers.steady_responses import steady_responses

_SEGMENTS = 10
_FEWEST_LINES = 40


@dataclass(frozen=True, slots=True)
class CfddOutputOnly:
    """Bells of the singular values of Welch's matrix of the responses; fields are the settings."""

    name: ClassVar[str] = "cfdd-output-only"
    summary: ClassVar[str] = "Singular values of the responses' spectral matrix without a force, a bell fitted per mode"
    citation: ClassVar[str] = CITATION
    needs: ClassVar[Needs] = Needs.OUTPUT_ONLY | Needs.TIME_HISTORIES

    segment_s: float = field(default=0.0, metadata={"doc": "length of a Welch segment; 0 takes a tenth of the record"})
    numerator: Literal["quadratic", "constant"] = field(
        default="quadratic", metadata={"doc": "of the fraction: quadratic takes up neighbouring modes"}
    )
    least_mac: float = field(default=0.8, metadata={"doc": "lines of a bell resemble the shape at its peak so much"})
    drop_db: float = field(default=20.0, metadata={"doc": "how far down from its peak a bell reaches, in dB of power"})
    prominence_db: float = field(default=3.0, metadata={"doc": "least rise of a peak over its saddle, in dB of power"})
    false_alarm: float = field(default=0.01, metadata={"doc": "chance that scatter alone makes one peak somewhere"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a fitted pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "segment_s": (0.0, 1e6),
            "least_mac": (0.0, 0.999),
            "drop_db": (3.0, 60.0),
            "prominence_db": (0.0, 60.0),
            "false_alarm": (1e-12, 0.5),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        check_bounds(self, bounds)

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes behind the peaks of the first singular value inside ``band_hz``; shapes have largest entry 1."""
        responses = steady_responses(campaign, band_hz)
        if responses.problem:
            return ModalModel.empty(Outcome.DECLINED, (*responses.remarks, responses.problem))
        segment = self.segment_s or responses.duration_s / _SEGMENTS
        width = band_hz[1] - band_hz[0]
        if segment > responses.duration_s / 2 or segment * width < _FEWEST_LINES:
            segment = min(responses.duration_s / 4, max(segment, 1.5 * _FEWEST_LINES / width))
        remarks = responses.remarks
        if segment * width < _FEWEST_LINES:
            why = (
                f"segments of {segment:.3g} s leave under {_FEWEST_LINES} lines in the band: widen it or record longer"
            )
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why))
        found = output_only(responses.channels, responses.samples, responses.sample_rate_hz, band_hz, segment)
        modes, left_out = self._modes(found)
        if not modes:
            why = "no peak of the first singular value stands out of its scatter as the bell of one mode"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, *left_out, why), dofs=found.dofs)
        return flag_non_modes(campaign, _claim(found, modes, (*remarks, *left_out)))

    def _modes(self, found: Decomposition) -> tuple[tuple[BellMode, ...], tuple[str, ...]]:
        options = BellOptions(self.least_mac, self.drop_db, self.numerator == "quadratic", self.largest_damping_ratio)
        peaks = [(line, 0) for line in density_peaks(found, self.prominence_db, self.false_alarm)]
        modes, left_out = bell_modes(found, peaks, options)
        extra = second_peaks(found, modes, self.false_alarm)
        return bell_modes(found, [*peaks, *extra], options) if extra else (modes, left_out)


def _claim(found: Decomposition, modes: tuple[BellMode, ...], remarks: tuple[str, ...]) -> ModalModel:
    vectors = np.array([m.bell.vector for m in modes])
    largest = vectors[np.arange(len(modes)), np.argmax(np.abs(vectors), axis=1)]
    return ModalModel(
        natural_frequency_hz=np.array([m.fit.natural_frequency_hz for m in modes]),
        damping_ratio=np.array([m.fit.damping_ratio for m in modes]),
        shapes=vectors / largest[:, None],
        dofs=found.dofs,
        natural_frequency_std_hz=np.array([m.fit.natural_frequency_std_hz for m in modes]),
        damping_ratio_std=np.array([m.fit.damping_ratio_std for m in modes]),
        flags=tuple(m.flags for m in modes),
        advice=remarks,
    )
