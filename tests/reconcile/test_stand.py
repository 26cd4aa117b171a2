"""What an effect would change at a fitted model: slopes free of curvature, and sizes at which the unknowns follow."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.prediction.surrogate import Anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.scan import start_values
from vgvt.reconcile.search.stand import Stand, step_from_neutral


@pytest.fixture(scope="module")
def stand(tmp_path_factory: pytest.TempPathFactory) -> Stand:
    """At the calibrated scenario."""
    return Stand.of(calibrate(problem(tmp_path_factory.mktemp("cache"), 1)))


def heavier() -> Hypothesis:
    """Heavier sensors: the unknowns hold the sensors' mass, within a few per cent of its own."""
    return Hypothesis(available_effects()["roving-sensor-mass"])


def test_the_slope_holds_no_curvature(stand: Stand) -> None:
    """What the unknowns cannot imitate is small in the slope, and more in a difference over a large step."""
    hypothesis = heavier()
    (mass,) = hypothesis.parameters
    slope = stand.slope(hypothesis, {}, mass)
    assert slope is not None
    own = np.linalg.norm(stand.projected(slope))
    far, near = (stand.change(hypothesis, {"mass_kg": m}) for m in (5e-3, 1e-6))
    assert far is not None
    assert near is not None
    assert np.linalg.norm(near / 1e-6 - slope) < 0.02 * np.linalg.norm(slope)
    assert np.linalg.norm(stand.projected(far)) / 5e-3 > 2 * own
    step = step_from_neutral(mass)
    rough = stand.change(hypothesis, {"mass_kg": step})
    assert rough is not None
    exact = near / 1e-6
    assert np.linalg.norm(slope - exact) < 0.2 * np.linalg.norm(rough / step - exact)


def test_the_unknowns_follow_what_they_can_imitate(stand: Stand) -> None:
    """A tenth of a gram more costs little once the sensors' mass has moved, and much before."""
    hypothesis, values = heavier(), {"mass_kg": 2e-4}
    moved = stand.change(hypothesis, values)
    followed = stand.followed(hypothesis, values)
    assert moved is not None
    assert followed is not None
    still = stand.misfit + moved
    assert followed[0] - stand.cost < 0.1 * (float(still @ still) - stand.cost)
    assert np.abs(followed[1] - stand.fit.u).max() > 0.1


def test_following_never_ends_above_where_it_began(stand: Stand) -> None:
    """Whatever the size: the best point on the way is given back."""
    hypothesis = Hypothesis(available_effects()["root-compliance"], {"side": "right", "torsion": 0.0})
    for size in (0.002, 0.3):
        values = {"bending": size}
        moved, followed = stand.change(hypothesis, values), stand.followed(hypothesis, values)
        assert moved is not None
        assert followed is not None
        still = stand.misfit + moved
        assert followed[0] <= float(still @ still) * (1 + 1e-9)


def test_a_fit_is_needed_to_stand_on(stand: Stand) -> None:
    """What is left after projection is orthogonal to everything the scores do."""
    assert isinstance(stand.fit, Fit)
    np.testing.assert_allclose(stand.basis.T @ stand.left, 0, atol=1e-6 * np.linalg.norm(stand.misfit))


def test_a_response_that_runs_away_is_no_candidate(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    """A marched joint can diverge: the variant is impossible, and the screen goes on."""
    shape = stand.fit.problem.measured.values.shape
    monkeypatch.setattr(Anchor, "mechanical", lambda self, u, e, **ended: np.full(shape, np.nan + 0j))
    assert stand.change(heavier(), {"mass_kg": 1e-3}) is None
    assert stand.followed(heavier(), {"mass_kg": 1e-3}) is None


# A flap hangs on one link, where an item of the airframe is shared by the two around it.
TAKEN_OFF = {"control-surface"}


@pytest.mark.parametrize("name", sorted({n for n, c in available_effects().items() if c.linear} - TAKEN_OFF))
def test_nothing_is_there_of_an_effect_at_no_size(stand: Stand, name: str) -> None:
    """A damper that stayed behind its spring was taken for the slope of the spring: 0.4 N/m seemed to get a name."""
    variants = candidates(stand.fit.problem, {name: available_effects()[name]})
    hypothesis = variants[len(variants) // 2]
    sizes = [p for p in hypothesis.parameters if p.neutral is not None]
    none = {p.name: float(p.neutral or 0.0) for p in sizes}
    for p in sizes:
        step = step_from_neutral(p)
        small, whole = (
            stand._linear_change(hypothesis, {**start_values(hypothesis), **none, p.name: none[p.name] + share * step})
            for share in (0.01, 1.0)
        )
        # A joint more is there at any size, and is known for that.
        if small is not None and whole is not None and not whole[1]:
            assert np.linalg.norm(small[0]) < 0.1 * np.linalg.norm(whole[0]) + 1e-9, p.name
