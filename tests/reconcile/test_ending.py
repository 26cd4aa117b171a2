"""What a record's end leaves out: against a simulated record, and its slopes against differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from vgvt.reconcile.mechanics.ending import Ending, left_out, left_out_slopes
from vgvt.reconcile.mechanics.response import Matrices, Slopes, accelerances

COORDINATES, ROWS, PARAMETERS = 3, 4, 3
RUNS = (np.array([0, 1]), np.array([2, 3]))
MASSES = np.array([0.05, 0.02, 0.0, 0.0])
NAMES = ("mass", "damping", "stiffness", "drive", "axis", "tilt")
RATE_HZ, LENGTH_S, TAPER_S = 250.0, 12.0, 1.5
SAMPLES, TAPERED = round(RATE_HZ * LENGTH_S), round(RATE_HZ * TAPER_S)
LINES = np.arange(48, 168, 5)
HZ = LINES * RATE_HZ / SAMPLES


def structure(seed: int = 4) -> Matrices:
    """Modes at 5, 8.4 and 12 Hz, the second of which rings for minutes."""
    g = np.random.default_rng(seed)
    shapes = np.eye(COORDINATES) + 0.3 * g.standard_normal((COORDINATES, COORDINATES))
    omega, ratio = 2 * np.pi * np.array([5.0, 8.4, 12.0]), np.array([0.02, 0.001, 0.01])
    back = np.linalg.inv(shapes)
    mass, stiffness = back.T @ back, back.T @ np.diag(omega**2) @ back
    damping = back.T @ np.diag(2 * ratio * omega) @ back
    axis = g.standard_normal((ROWS, COORDINATES))
    return Matrices(
        mass, damping, stiffness, g.standard_normal(COORDINATES), axis, g.standard_normal(axis.shape), np.zeros(ROWS)
    )


def sweep(stop_s: float) -> np.ndarray:
    """From 3 to 15 Hz within a time, then nothing."""
    t = np.arange(SAMPLES) / RATE_HZ
    phase = 2 * np.pi * (3 * t + 0.5 * 12 / stop_s * t**2)
    fade = np.clip(np.minimum(t / 0.3, (stop_s - t) / 0.3), 0, 1)
    return np.asarray(np.sin(phase) * np.sin(np.pi / 2 * fade) ** 2)


def answers(m: Matrices, rows: np.ndarray, masses: np.ndarray, force: np.ndarray, finer: int = 8) -> np.ndarray:
    """Readings (rows, samples) in time by the exponential of the system, the force straight between finer samples."""
    n = COORDINATES
    heavy = m.mass + (m.axis[rows].T * masses) @ m.axis[rows]
    system = np.zeros((2 * n + 2, 2 * n + 2))
    system[:n, n : 2 * n] = np.eye(n)
    system[n : 2 * n, :n], system[n : 2 * n, n : 2 * n] = (-np.linalg.solve(heavy, k) for k in (m.stiffness, m.damping))
    system[n : 2 * n, 2 * n] = np.linalg.solve(heavy, m.drive)
    system[2 * n, 2 * n + 1] = 1.0
    fine = np.fft.irfft(np.pad(np.fft.rfft(force), (0, (finer - 1) * force.size // 2)), finer * force.size) * finer
    step = 1 / (finer * RATE_HZ)
    march = scipy.linalg.expm(system * step)
    to_acceleration = system[n : 2 * n]
    state, out = np.zeros(2 * n + 2), []
    for k in range(fine.size - 1):
        state[2 * n], state[2 * n + 1] = fine[k], (fine[k + 1] - fine[k]) / step
        if k % finer == 0:
            out.append(m.axis[rows] @ (to_acceleration @ state) + m.tilt[rows] @ state[:n])
        state = march @ state
    return np.array(out).T


def window_of(tapered: int, samples: int = SAMPLES) -> np.ndarray:
    """One, and half a cosine at the end."""
    window = np.ones(samples)
    window[samples - tapered :] = 0.5 * (1 + np.cos(np.pi * (np.arange(tapered) + 0.5) / max(tapered, 1)))
    return window


def quotient(force: np.ndarray, answered: np.ndarray, tapered: int) -> np.ndarray:
    """What a campaign's analysis makes of a record: the quotient of tapered spectra, at the lines."""
    window = window_of(tapered)
    return np.asarray(np.fft.rfft(answered * window)[:, LINES] / np.fft.rfft(force * window)[LINES])


def ending(force: np.ndarray, tapered: int = TAPERED) -> Ending:
    return Ending.of(force, RATE_HZ, tapered, HZ, np.fft.rfft(force * window_of(tapered))[LINES])


@pytest.mark.parametrize(("stop_s", "tapered"), [(9.0, TAPERED), (11.9, TAPERED), (9.0, 0)])
def test_a_record_that_ends_ringing_is_foretold(stop_s: float, tapered: int) -> None:
    """With a rest after the sweep, shorter than the decay; with none, the taper in its midst; cut off without one."""
    m, force = structure(), sweep(stop_s)
    endless = accelerances(m, 2 * np.pi * HZ, RUNS, tuple(MASSES[r] for r in RUNS))
    found = endless + left_out(m, 2 * np.pi * HZ, RUNS, tuple(MASSES[r] for r in RUNS), (ending(force, tapered),) * 2)
    read = np.concatenate([quotient(force, answers(m, rows, MASSES[rows], force), tapered) for rows in RUNS])
    # Under the taper the force is where the last lines are: these the analysis leaves out.
    clear = HZ < 12.0
    size = np.abs(read[:, clear]).max(axis=1, keepdims=True)
    assert (np.abs(endless - read)[:, clear] / size).max() > 0.1
    assert (np.abs(found - read)[:, clear] / size).max() < 5e-4


def twins() -> Matrices:
    """Two modes that do not know of each other and are alike, and one at 12 Hz: each pole of theirs is there twice."""
    omega, ratio = 2 * np.pi * np.array([8.4, 8.4, 12.0]), np.array([0.002, 0.002, 0.01])
    return replace(
        structure(), mass=np.eye(3), damping=np.diag(2 * ratio * omega), stiffness=np.diag(omega**2)
    )  # fmt: skip


@pytest.mark.parametrize(
    ("made", "own", "tapered"),
    [(structure, MASSES, TAPERED), (structure, MASSES, 0), (twins, 0 * MASSES, TAPERED), (twins, 0 * MASSES, 0)],
)
def test_slopes_agree_with_differences(made: Callable[[], Matrices], own: np.ndarray, tapered: int) -> None:
    m, force = made(), sweep(9.0)
    g = np.random.default_rng(7)
    changes = {n: g.standard_normal((PARAMETERS, *getattr(m, n).shape)) * np.abs(getattr(m, n)).mean() for n in NAMES}
    for name in ("mass", "damping", "stiffness"):
        changes[name] = 1e-2 * (changes[name] + changes[name].transpose(0, 2, 1))
    slopes = Slopes(**changes, masses_kg=0.1 * g.standard_normal((PARAMETERS, ROWS)))
    ends, omega, step = (ending(force, tapered),) * 2, 2 * np.pi * HZ, 1e-6
    found = left_out_slopes(m, omega, RUNS, tuple(own[r] for r in RUNS), ends, slopes)
    for k in range(PARAMETERS):
        sides = []
        for sign in (1, -1):
            there = replace(m, **{n: getattr(m, n) + sign * step * changes[n][k] for n in NAMES})
            heavy = own + sign * step * slopes.masses_kg[k]
            sides.append(left_out(there, omega, RUNS, tuple(heavy[r] for r in RUNS), ends))
        difference = (sides[0] - sides[1]) / (2 * step)
        assert np.abs(difference).max() > 1e-2
        np.testing.assert_allclose(found[k], difference, atol=1e-3 * np.abs(difference).max())


def test_a_record_that_ends_at_rest_leaves_nothing_out() -> None:
    m, force = structure(), sweep(9.0)
    quick = replace(m, damping=m.damping + 20 * m.mass)
    masses = tuple(MASSES[r] for r in RUNS)
    assert left_out(m, 2 * np.pi * HZ, RUNS, masses, (ending(force),) * 2).any()
    assert not left_out(quick, 2 * np.pi * HZ, RUNS, masses, (ending(force),) * 2).any()


@pytest.mark.parametrize("stop_s", [9.0, 11.9])
def test_a_force_is_thinned_where_it_is_sampled_faster_than_the_band_asks_for(stop_s: float) -> None:
    """As exact with a sweep that the taper meets: its start is where steps of different length join."""
    m, slow, omega = structure(), sweep(stop_s), 2 * np.pi * HZ
    finer, masses = 8, tuple(MASSES[r] for r in RUNS)
    fast = np.fft.irfft(np.pad(np.fft.rfft(slow), (0, (finer - 1) * SAMPLES // 2)), finer * SAMPLES) * finer
    tapered = finer * TAPERED
    window = window_of(tapered, fast.size)
    thinned = Ending.of(fast, finer * RATE_HZ, tapered, HZ, np.fft.rfft(fast * window)[LINES])
    assert thinned.past.size < 0.2 * fast.size
    ends = [left_out(m, omega, RUNS, masses, (e,) * 2) for e in (thinned, ending(slow))]
    clear = HZ < 12.0
    size = np.abs(accelerances(m, omega, RUNS, masses)).max(axis=1, keepdims=True)
    assert (np.abs(ends[0] - ends[1]) / size)[:, clear].max() < 5e-4
