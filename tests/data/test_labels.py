"""Degrees of freedom, channels and suggestions: labels mean one thing and come back as written."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vgvt.data import Channel, ChannelRole, Direction, Dof, InputError, Quantity
from vgvt.data.suggestion import choose_one_of, nearest


@given(st.integers(0, 10**6), st.sampled_from(list(Direction)))
def test_a_label_comes_back_as_the_same_dof(node: int, direction: Direction) -> None:
    dof = Dof(node, direction)
    assert Dof.from_label(dof.label) == dof
    assert Dof.from_label(f" {dof.label.lower()} ") == dof


@pytest.mark.parametrize(("text", "label"), [("12Z", "12+Z"), ("12 - rx", "12-RX"), ("7s", "7S"), ("0+y", "0+Y")])
def test_ways_of_writing(text: str, label: str) -> None:
    assert str(Dof.from_label(text)) == label


@pytest.mark.parametrize("text", ["", "12", "Z", "12+W", "12++Z", "1.5+Z", "-3+Z", "12+ZZ", "12+RS"])
def test_what_is_no_label_is_refused_with_the_form(text: str) -> None:
    with pytest.raises(ValueError, match=r"12\+Z"):
        Dof.from_label(text)


@pytest.mark.parametrize("direction", list(Direction))
def test_the_code_says_sign_axis_and_kind(direction: Direction) -> None:
    assert direction.sign == (-1 if direction.value < 0 else 1)
    assert direction.is_rotation == (abs(direction.value) in (4, 5, 6))
    length = 0.0 if direction is Direction.SCALAR else 1.0
    assert np.linalg.norm(direction.unit_vector) == length
    assert Direction.from_label(direction.label) is direction


def test_opposite_directions_are_one_dof_without_its_sign() -> None:
    assert Dof.from_label("3-Z").unsigned == Dof.from_label("3+Z").unsigned == Dof(3, Direction.PLUS_Z)


def test_a_channel_takes_the_si_unit_of_its_quantity() -> None:
    channel = Channel("a", Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof.from_label("1+Z"))
    assert channel.unit == "m/s^2"
    assert Channel("d", Quantity.GENERAL, ChannelRole.DRIVE).unit == "V"


@pytest.mark.parametrize("role", [ChannelRole.RESPONSE, ChannelRole.REFERENCE])
def test_a_measured_channel_needs_a_place(role: ChannelRole) -> None:
    with pytest.raises(ValueError, match=r"needs a degree of freedom, like 12\+Z"):
        Channel("a", Quantity.ACCELERATION, role)


def test_suggestions_find_the_word_meant() -> None:
    known = ("hati-unsymmetric", "hati-symmetric", "quick")
    assert nearest("hati-unsymetric", known) == "hati-unsymmetric"
    # The words of a name in another order, before a name that is only spelt like it.
    assert nearest("unsymmetric_hati", known) == "hati-unsymmetric"
    assert nearest("mass-added", ("added-mass", "mass-adder")) == "added-mass"
    assert nearest("QUICK", known) == "quick"
    assert nearest("qui", known) == "quick"
    assert nearest("unsymmetric", known) == "hati-unsymmetric"
    assert nearest("hati", known) == "hati-symmetric"
    assert nearest("surge", ("suspension-surge", "suspension-damping")) == "suspension-surge"
    assert nearest("surge", ("suspension-surge", "entrained-surge")) is None
    assert nearest("zzz", known) is None
    assert choose_one_of("quik", known).startswith("did you mean 'quick'?")
    assert choose_one_of("quik", (*known, *(f"name-{i}" for i in range(40)))) == "did you mean 'quick'?"
    assert choose_one_of("zzz", known) == "choose one of: hati-symmetric, hati-unsymmetric, quick"


def test_an_input_error_says_where_what_and_what_to_do() -> None:
    error = InputError("a.toml, mass", "negative", "write a positive number")
    assert str(error) == "a.toml, mass: negative\n  write a positive number"
    assert isinstance(error, ValueError)
