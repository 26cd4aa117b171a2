"""The study of levels: what its campaigns hold, and that they hold nothing else."""

from __future__ import annotations

import numpy as np
import one_level_or_two as study
import pytest

from vgvt.data import Campaign, ChannelRole, Record

DRIFT = next(t for t in study.TRUTHS if t.name == "run-drift")


def levels_of(campaign: Campaign) -> list[float]:
    """The force of every run, rms."""
    found = []
    for run in campaign.runs:
        (force,) = (k for k, c in enumerate(run.channels) if c.role is ChannelRole.REFERENCE)
        found.append(float(np.std(run.samples[force])))
    return found


def test_the_same_sensors_twice_at_two_levels_or_at_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study.lab, "TRUE_CELLS", 6)
    study.records.cache_clear()
    two, one = (study.campaign_of(DRIFT, levels) for levels in (2, 1))
    half = len(study.RUNS)
    for campaign, ratio in ((two, DRIFT.loud / DRIFT.quiet), (one, 1.0)):
        force = levels_of(campaign)
        np.testing.assert_allclose(np.divide(force[half:], force[:half]), ratio, rtol=0.01)
        dofs = [[c.dof for c in run.channels] for run in campaign.runs]
        assert dofs[:half] == dofs[half:]
        assert campaign.name == "campaign" and not campaign.notes
    study.records.cache_clear()


def test_what_is_nonlinear_is_stepped_in_time() -> None:
    engines = {t.name: t.engine for t in study.TRUTHS if t.source == study.SIMULATION}
    assert {n for n, e in engines.items() if e == "mujoco"} == set(study.NONLINEAR)
    assert len(study.TRUTHS) == 8


def test_only_what_turns_through_finite_angles_is_told_of_them() -> None:
    """The play of the simulator, which has to be driven that hard; nothing else of the scenario is touched."""
    stated = study.nominal()
    told = {t.title: study.told(t) for t in study.TRUTHS}
    assert {n for n, s in told.items() if s.tolerances != stated.tolerances} == {"root-freeplay"}
    play = told["root-freeplay"]
    assert play.tolerances.model_form == pytest.approx(0.012)
    assert play.model_copy(update={"tolerances": stated.tolerances}) == stated


def test_every_joint_comes_from_the_second_laboratory_too() -> None:
    there = [t for t in study.TRUTHS if t.source == study.SECOND]
    assert {t.name for t in there} == set(study.NONLINEAR)
    assert len({t.title for t in study.TRUTHS}) == len(study.TRUTHS)


@pytest.mark.slow
def test_the_second_laboratorys_joints_answer_otherwise_at_another_level() -> None:
    for truth in (t for t in study.TRUTHS if t.source == study.SECOND):
        study.records.cache_clear()
        two, one = (study.campaign_of(truth, levels) for levels in (2, 1))
        half = len(study.RUNS)
        np.testing.assert_allclose(
            np.divide(levels_of(two)[half:], levels_of(two)[:half]), truth.loud / truth.quiet, 0.02
        )
        for campaign, least, most in ((two, 0.02, np.inf), (one, 0.0, 0.01)):
            first, again = (accelerance(campaign.runs[k]) for k in (0, half))
            assert least < np.linalg.norm(first - again) / np.linalg.norm(again) < most
    study.records.cache_clear()


def accelerance(run: Record) -> np.ndarray:
    """A/F (sensors, lines) of a whole record in the swept band."""
    frequency = np.fft.rfftfreq(run.samples.shape[1], 1 / run.sample_rate_hz)
    inside = (frequency > 4.0) & (frequency < 34.0)
    force = np.fft.rfft(run.select(ChannelRole.REFERENCE)[1][0])[inside]
    return np.asarray(np.fft.rfft(run.select(ChannelRole.RESPONSE)[1], axis=1)[:, inside] / force)


def test_the_table_names_the_next_best_that_was_not_named() -> None:
    row = {
        "truth": "run-drift", "source": "simulation", "levels": 2,
        "verdict": "partly_explained", "named": "run-drift", "held_before": 3.0,
        "held_after": 1.0, "rivals": [["run-drift", 100.0, 1.0], ["added-mass", 20.0, 2.0]], "core": "abc", "cpu_s": 7,
    }  # fmt: skip
    text = study.results([study.printed(row)])
    assert (
        "| `run-drift` | simulation | 2 | partly explained | run-drift | 3.00 → 1.00 | added-mass, 80 | 7 | abc |"
        in text
    )


def test_a_case_that_was_run_again_stands_in_place_of_what_was_shown() -> None:
    old = dict.fromkeys(study.COLUMNS, "old")
    shown = [old | {"truth": t.name, "laboratory": t.source, "levels": "2"} for t in study.TRUTHS]
    again = dict(shown[2], verdict="explained")
    rows = study.merged(reversed(shown), [again])
    assert [r["truth"] for r in rows] == [t.name for t in study.TRUTHS]
    assert rows[2]["verdict"] == "explained" and rows[3]["verdict"] == "old"


def test_what_is_shown_is_what_is_kept() -> None:
    page = (study.PAGES / "one-level-or-two.md").read_text(encoding="utf-8")
    assert study.results(study.known()) in page
