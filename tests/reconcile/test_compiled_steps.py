"""Joints are stepped in machine code where there is a place for it, and are stepped anyway where there is none."""

from __future__ import annotations

import subprocess
import sys
import warnings
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.reconcile.mechanics import compiled_steps
from vgvt.reconcile.mechanics.law import Law
from vgvt.reconcile.mechanics.march import Memory, marched

POLES = np.array([-1.0 + 40.0j, -2.0 + 90.0j])
MEMORY = Memory(
    POLES, np.array([[1.0, 0.4], [-0.3, 0.8]]) + 0j, -1j * np.array([[1e-3, 3e-4], [5e-4, 1e-3]]), 1e-6 * np.eye(2)
)
LAWS = [
    [[Law(900.0, play=1e-3), Law(1500.0, cubic=3e6, rest=-2e-3)]],
    [[Law(900.0, friction=2.0), Law(1500.0, friction=0.5, cubic=3e6)]],
]


def reactions() -> list[NDArray[np.float64]]:
    motion = 1e-2 * np.sin(np.array([[[50.0], [47.0]]]) * np.arange(400) / 500)
    return [marched(motion, MEMORY, laws, 1 / 500) for laws in LAWS]


@pytest.fixture(autouse=True)
def as_in_a_new_process() -> Iterator[None]:
    """What was found out about this machine is forgotten before and behind every test."""
    forget()
    yield
    forget()


def forget() -> None:
    compiled_steps._failed.clear()
    compiled_steps._compiled.cache_clear()


def refused(*_: object) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("broken", ["no folder", "a full disk", "no compiler"])
def test_where_machine_code_has_no_place_joints_are_stepped_all_the_same(
    monkeypatch: pytest.MonkeyPatch, broken: str
) -> None:
    wanted = reactions()
    assert not compiled_steps._failed
    forget()
    if broken == "no folder":
        monkeypatch.setattr("numba.core.caching.CacheImpl._locator_classes", [])
    elif broken == "a full disk":
        # Where nothing is kept yet, that is told when it has been compiled.
        monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.load", lambda self, key: None)
        monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", refused)
    else:
        monkeypatch.setitem(sys.modules, "numba", None)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = reactions()
    assert list(compiled_steps._failed) == ([True, False] if broken == "no compiler" else [True])
    # Once, where it takes much longer; without a folder it is seconds.
    assert ["without machine code" in str(w.message) for w in told] == [True] * (broken == "no compiler")
    for got, meant in zip(found, wanted, strict=True):
        assert np.abs(meant).max() > 0.1
        np.testing.assert_allclose(got, meant, rtol=0, atol=1e-9 * np.abs(meant).max())


def test_what_runs_away_is_not_a_number_in_plain_python_either(monkeypatch: pytest.MonkeyPatch) -> None:
    """Quietly: a fit's trial steps do so."""
    compiled_steps._failed.update({True: OSError(), False: OSError()})
    growing = Memory(np.array([900.0 + 40.0j]), np.ones((1, 1)) + 0j, np.ones((1, 1)) + 0j, 1e-6 * np.eye(1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = marched(np.ones((1, 1, 3000)), growing, [[Law(900.0, cubic=3e6)]], 1 / 500)
    assert np.isnan(found[0, 0, -1])


@pytest.mark.skipif(sys.platform != "linux", reason="a call of the Linux kernel")
def test_in_a_process_that_may_not_execute_what_it_writes() -> None:
    """As hardened systems have it: there loading the compiler fails already."""
    script = f"""
import ctypes, sys
if ctypes.CDLL(None).prctl(65, 1, 0, 0, 0):
    sys.exit(5)
sys.path.insert(0, {str(__file__).rpartition("/")[0]!r})
import test_compiled_steps as t
print(*(float(abs(r).max()) for r in t.reactions()))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120)
    if done.returncode == 5:
        pytest.skip("this kernel knows no PR_SET_MDWE")
    assert done.returncode == 0, done.stderr
    found = [float(word) for word in done.stdout.split()]
    assert found == pytest.approx([float(np.abs(r).max()) for r in reactions()], rel=1e-9)
