import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.plscf import Plscf


@pytest.mark.parametrize("check", checks(), ids=str)
def test_plscf_conforms(check: Check) -> None:
    check(Plscf())


@pytest.mark.slow
@pytest.mark.parametrize("check", checks(), ids=str)
def test_plscf_with_common_poles_conforms(check: Check) -> None:
    check(Plscf(poles="common"))
