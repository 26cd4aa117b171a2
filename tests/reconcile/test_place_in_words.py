"""What a verdict says of the place that explains most: a force, or a factor on channels, in a sentence that reads."""

from __future__ import annotations

import pytest

from vgvt.reconcile.evidence.localise import Place, words_of_place
from vgvt.reconcile.evidence.whole_airframe import WHOLE


@pytest.mark.parametrize(
    ("label", "kind", "explained", "type_", "said"),
    [
        ("force at the hook", "structure", 0.77, "unclear", "A free force at the hook would explain 77 % of"),
        ("bending at the root of wing-left", "structure", 0.5, "", "A free bending at the root of wing-left would"),
        ("run 4, 12+Z", "sensor", 0.31, "", "A free factor on run 4, 12+Z would explain 31 % of the residual"),
        ("force channel", "drive", 0.9, "", "A free factor on the force channel would explain 90 % of the residual"),
        (WHOLE, "airframe", 0.7, "", "A free factor on the stiffness of the whole airframe would explain 70 % of the"),
        ("run 4, 12+Z", "sensor", -0.1, "", "No free force or factor at one place would explain 5 % of the residual"),
        ("force at 3+Z", "structure", 0.6, "resonant", "; it looks like something that swings at 8.0 Hz"),
        ("force at 3+Z", "structure", 0.6, "mass", "; it looks like a mass of 8 kg"),
    ],
)
def test_it_reads(label: str, kind: str, explained: float, type_: str, said: str) -> None:
    assert said in words_of_place(Place(label, kind, None, explained, type_, 8.0, "kg", None))
