import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.ssi_cov import SsiCov


@pytest.mark.parametrize("check", checks(), ids=str)
def test_ssi_cov_conforms(check: Check) -> None:
    check(SsiCov())
