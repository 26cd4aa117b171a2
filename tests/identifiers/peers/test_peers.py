"""Adapters to other libraries: absent, they say what to install; present, they keep the contract and find the modes."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from vgvt.data import InputError, Outcome
from vgvt.identification import (
    absent_identifiers,
    available_identifiers,
    make_identifier,
    run_identifier,
)
from vgvt.identification.conformance import checks
from vgvt.identification.example import Example
from vgvt_identifiers.peers import pyoma2_ssi, sdypy_lscf
from vgvt_identifiers.peers.pyoma2_ssi import Pyoma2Ssi
from vgvt_identifiers.peers.sdypy_lscf import SdypyLscf

PEERS = [Pyoma2Ssi(), SdypyLscf()]
FAILS = {("pyoma2-ssi", "stays_inside_the_band")}  # without noise, a spurious pole at the edge of a narrow band passes
POLES = 2 * np.pi * np.array([-0.05 + 5.0j, -0.05 - 5.0j, -0.1 + 12.0j, complex(np.nan)])


@pytest.fixture
def nothing_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = importlib.util.find_spec

    def without(name: str, package: str | None = None):  # type: ignore[no-untyped-def]
        return None if name.split(".")[0] in ("pyoma2", "sdypy") else real(name, package)

    monkeypatch.setattr(importlib.util, "find_spec", without)


@pytest.mark.parametrize("peer", PEERS, ids=lambda p: p.name)
@pytest.mark.usefixtures("nothing_installed")
def test_an_absent_library_costs_one_line_of_advice(peer: Pyoma2Ssi | SdypyLscf) -> None:
    assert peer.name not in available_identifiers()  # nor among the default entries of the bench
    assert absent_identifiers()[peer.name] == "pip install 'vgvt[peers]'"
    with pytest.raises(InputError, match="which is not installed") as refused:
        make_identifier(peer.name)
    assert "pip install 'vgvt[peers]'" in str(refused.value)
    claim = run_identifier(peer, Example(stations=2, duration_s=4.0, sweep_s=3.0).campaign())
    assert claim.outcome is Outcome.DECLINED
    assert "pip install 'vgvt[peers]'" in claim.advice[0]


@pytest.mark.parametrize("peer", PEERS, ids=lambda p: p.name)
def test_settings_out_of_bounds_are_refused(peer: Pyoma2Ssi | SdypyLscf) -> None:
    with pytest.raises(InputError, match="largest_order = 1000"):
        type(peer)(largest_order=1000)


def test_pyoma2_table_keeps_the_upper_poles_with_their_shapes_and_shifts_them() -> None:
    poles = np.column_stack([np.full(4, np.nan), POLES, [*POLES[2:], *POLES[:2]]])
    shapes = np.arange(4 * 3 * 2).reshape(4, 3, 2).astype(complex)
    second, fourth = pyoma2_ssi.pole_table(poles, shapes, 2, 3.0)
    assert (second.order, fourth.order) == (2, 4)
    np.testing.assert_allclose(second.poles_rad_s, POLES[[0, 2]] + 2j * np.pi * 3.0)
    np.testing.assert_array_equal(second.vectors, shapes[[0, 2], 1])
    np.testing.assert_allclose(fourth.poles_rad_s, POLES[[2, 0]] + 2j * np.pi * 3.0)
    np.testing.assert_array_equal(fourth.vectors, shapes[[0, 2], 2])


def test_sdypy_table_keeps_stable_poles_of_the_upper_half() -> None:
    (only,) = sdypy_lscf.pole_table([np.append(POLES, 0.1 + 3j)])
    assert only.order == 2
    np.testing.assert_allclose(only.poles_rad_s, POLES[[0, 2]])
    assert only.vectors.shape == (2, 1)


@pytest.mark.slow
@pytest.mark.parametrize("check", checks(), ids=str)
@pytest.mark.parametrize("peer", PEERS, ids=lambda p: p.name)
def test_conformance(peer: Pyoma2Ssi | SdypyLscf, check) -> None:  # type: ignore[no-untyped-def]
    for requirement in peer.requires:
        if not requirement.present:
            pytest.skip(f"{requirement.module} is not installed")
    if (peer.name, str(check)) in FAILS:
        with pytest.raises(AssertionError):
            check(peer)
    else:
        check(peer)
