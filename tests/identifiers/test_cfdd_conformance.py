import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.cfdd import Cfdd


@pytest.mark.parametrize("check", checks(), ids=str)
def test_cfdd_conforms(check: Check) -> None:
    check(Cfdd())


@pytest.mark.slow
@pytest.mark.parametrize("check", checks(), ids=str)
def test_cfdd_with_poles_of_every_run_conforms(check: Check) -> None:
    check(Cfdd(poles="per-run"))
