from typing import Literal

import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.subspace import Subspace


@pytest.mark.parametrize("check", checks(), ids=str)
def test_subspace_conforms(check: Check) -> None:
    check(Subspace(replicates=1))


@pytest.mark.slow
@pytest.mark.parametrize("check", checks(), ids=str)
@pytest.mark.parametrize("weighting", ["moesp", "n4sid"])
def test_subspace_without_weighting_conforms(check: Check, weighting: Literal["moesp", "n4sid"]) -> None:
    check(Subspace(weighting=weighting))
