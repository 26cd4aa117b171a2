import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.quadrature import Quadrature


@pytest.mark.parametrize("check", checks(), ids=str)
def test_quadrature_conforms(check: Check) -> None:
    check(Quadrature())


@pytest.mark.slow
@pytest.mark.parametrize("check", checks(), ids=str)
def test_quadrature_with_the_correction_conforms(check: Check) -> None:
    check(Quadrature(correction="stahle-forlifer"))
