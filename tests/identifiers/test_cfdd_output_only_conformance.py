import pytest

from vgvt.identification.conformance import Check, checks
from vgvt_identifiers.cfdd_output_only import CfddOutputOnly


@pytest.mark.parametrize("check", checks(), ids=str)
def test_cfdd_output_only_conforms(check: Check) -> None:
    check(CfddOutputOnly())
