"""What MuJoCo has to say about a state that no aircraft is in stays out of the user's folder and terminal."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from vgvt.simulation import reduced
from vgvt.simulation.silence import silent


def warned() -> None:
    """A step from nowhere, of which MuJoCo warns."""
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint type="slide"/><geom size="1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.qpos[:] = np.nan
    mujoco.mj_step(model, data)


def test_nothing_is_written_where_it_is_asked_to_be_silent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with silent():
        warned()
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")
    # And not for longer than that.
    warned()
    assert [f.name for f in tmp_path.iterdir()] == ["MUJOCO_LOG.TXT"]


def test_what_the_compiler_warns_of_is_not_printed_over_the_progress_line() -> None:
    """Two hinges that turn the same body about one axis have no inertia of their own."""
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><body><joint axis="0 1 0"/><joint axis="0 1 0"/><geom size="1"/></body>'
        "</worldbody></mujoco>"
    )
    with pytest.warns(UserWarning, match="singular"):
        spec.compile()
    with warnings.catch_warnings(record=True) as said, silent():
        spec.compile()
    assert not said


def test_trial_structures_are_assembled_in_silence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """A fit's trial step may lead to an aircraft of which MuJoCo would warn."""

    def hung(layout: object) -> None:
        warned()
        raise RuntimeError("no rest")

    layout: Any = None
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(reduced, "_hung", hung)
    with pytest.raises(RuntimeError, match="no rest"):
        reduced.structure(layout, ())
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")
