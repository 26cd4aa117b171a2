"""An identifier named the way a bench names its entries."""

from __future__ import annotations

import pytest

from vgvt.data import InputError
from vgvt.identification.registry import make_identifier


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("era:order=16", "--identifier era --setting order=16"),
        ("era:order=16,cut=3", "--identifier era --setting order=16 --setting cut=3"),
        ("era:", "--identifier era --setting KEY=VALUE"),
    ],
)
def test_settings_behind_a_colon_are_told_to_come_on_their_own(name: str, advice: str) -> None:
    with pytest.raises(InputError, match="no such identifier") as caught:
        make_identifier(name)
    assert advice in caught.value.advice


def test_a_name_that_there_is_not_gets_the_names_there_are() -> None:
    with pytest.raises(InputError) as caught:
        make_identifier("eraa:order=16")
    assert "known: " in caught.value.advice
