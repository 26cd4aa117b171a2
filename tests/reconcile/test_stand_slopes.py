"""What a stand says an effect would change, against whole predictions: joints that are new, and channels alone."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.stand import Stand


@pytest.fixture(scope="module")
def stand(tmp_path_factory: pytest.TempPathFactory) -> Stand:
    """On the nominal aircraft of a small campaign."""
    case = problem(tmp_path_factory.mktemp("cache"), 1)
    return Stand.of(fit(case, (), np.zeros(case.size), np.zeros(0), ()))


def alike(one: np.ndarray, other: np.ndarray) -> float:
    """Cosine."""
    return float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))


def test_a_stiff_joint_more_is_no_part_of_its_slope(stand: Stand) -> None:
    """At a size that nobody could see it is one coordinate more, and its slope is what is seen at sizes that matter."""
    root = Hypothesis(available_effects()["root-compliance"], {"side": "right"})
    torsion = next(p for p in root.parameters if p.name == "torsion")
    none = {"bending": 0.0, "torsion": 0.0}
    found = stand.slope(root, none, torsion)
    near, far = (stand.change(root, {**none, "torsion": t}) for t in (0.02, 0.03))
    assert found is not None and near is not None and far is not None
    wanted = (far - near) / 0.01
    assert alike(found, wanted) > 0.9
    assert alike(stand.projected(found), stand.projected(wanted)) > 0.95
    assert np.linalg.norm(stand.projected(found)) == pytest.approx(np.linalg.norm(stand.projected(wanted)), rel=0.15)
    # Nor does the joint alone do anything: so stiff, it leaves the aircraft as it is, but for what its size says.
    joint = stand.change(root, {**none, "torsion": 1e-6})
    assert joint is not None
    assert np.linalg.norm(joint) == pytest.approx(1e-6 * np.linalg.norm(wanted), rel=0.2)


def test_a_joint_that_is_large_where_it_begins_to_be_plausible_has_the_slope_of_a_small_one(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    """Where a body's halves rock within the band, a first-order change from none is anything: it was the slope."""
    case = problem(tmp_path_factory.mktemp("cache"), 1)
    stand = Stand.of(fit(case, (), np.full(case.size, 0.3), np.zeros(0), ()))
    halves = Hypothesis(available_effects()["carry-through-torsion"])
    (size,) = halves.parameters
    found = stand.slope(halves, {size.name: 0.0}, size)
    near, far = (stand.change(halves, {size.name: s}) for s in (1e-6, 3e-6))
    assert found is not None and near is not None and far is not None
    wanted = (far - near) / 2e-6
    assert alike(found, wanted) > 0.99
    assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(wanted), rel=0.1)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("channel-delay", {"channels": "3+Z", "delay_s": 1e-3}),
        ("channel-gain", {"channels": "sensor-2", "gain_error": 0.1}),
        ("loose-sensor-mount", {"node": 6, "period_s": 0.03, "damping_ratio": 0.1}),
    ],
)
def test_what_happens_to_channels_alone_needs_no_structure(
    stand: Stand, name: str, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    hypothesis = Hypothesis(available_effects()[name], values)
    null = stand.fit
    whole = anchor(null.problem, null.u, (hypothesis,), np.zeros(0), slopes=False).predict(null.u, np.zeros(0))
    wanted = data_misfit(null.problem, whole, null.sigma) - stand.misfit[: null.points]
    monkeypatch.setattr("vgvt.reconcile.search.stand.anchor", None)
    found = stand.change(hypothesis, {})
    assert found is not None
    np.testing.assert_allclose(found[: null.points], wanted, atol=1e-6 * np.abs(wanted).max())
    assert np.abs(wanted).max() > 1


def test_what_is_hung_on_vanishes_with_its_mass_and_needs_one_size_alone(stand: Stand) -> None:
    absorber = Hypothesis(available_effects()["local-absorber"], {"x_m": 0.9, "y_m": 1.1})
    mass = next(p for p in absorber.parameters if p.name == "mass_kg")
    middle = {"frequency_hz": 12.0, "damping_ratio": 0.03}
    asked: list[float] = []
    change = Stand._linear_change

    def counted(self: Stand, hypothesis: Hypothesis, values: dict[str, float]) -> object:
        asked.append(values["mass_kg"])
        return change(self, hypothesis, values)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stand, "_linear_change", counted)
        found = stand.slope(absorber, {**middle, "mass_kg": 0.0}, mass)
    assert len(asked) == 1
    near, far = (stand.change(absorber, {**middle, "mass_kg": m}) for m in (1e-5, 2e-5))
    assert found is not None and near is not None and far is not None
    assert alike(found, far - near) > 0.999
