"""The methods built on likelihood and rational fits pass the checks that every identifier must pass."""

from __future__ import annotations

import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.auto import Auto
from vgvt_identifiers.maximum_likelihood import MaximumLikelihood
from vgvt_identifiers.vector_fitting import VectorFitting


@pytest.mark.parametrize(
    "method", [Auto(), pytest.param(MaximumLikelihood(), marks=pytest.mark.slow)], ids=["auto", "maximum-likelihood"]
)
@pytest.mark.parametrize("check", checks(), ids=str)
def test_conformance(check: Check, method: Auto | MaximumLikelihood) -> None:
    check(method)


@pytest.mark.slow
@pytest.mark.parametrize("method", [Auto(poles="common"), VectorFitting()], ids=["auto-common", "vector-fitting"])
@pytest.mark.parametrize("check", checks(), ids=str)
def test_conformance_of_the_others(check: Check, method: Auto | VectorFitting) -> None:
    check(method)
