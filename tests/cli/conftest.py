"""The command line in-process, on a small campaign whose answer is known in closed form."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vgvt.cli import main
from vgvt.data import Campaign, Direction, Dof, ModalModel, RigidBodyProperties, Truth
from vgvt.identification.example import DRIVE_NODE, Example, plate_shapes

PLATE = Example(frequency_hz=(6.3, 13.7), damping_ratio=(0.012, 0.009), stations=3, noise_m_s2=1e-3, duration_s=20.0)


@dataclass(frozen=True)
class Result:
    """What a command left: its exit status and its two streams."""

    status: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """The one JSON object on stdout; fails when there is more or less than one, or a NaN in it."""
        document = json.loads(self.out, parse_constant=_refuse)
        assert isinstance(document, dict)
        return document


def _refuse(constant: str) -> float:
    raise AssertionError(f"{constant} is not JSON")


Command = Callable[..., Result]


@pytest.fixture
def vgvt(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """Run a command line in an empty folder; no traceback may appear, whatever it is."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Result:
        capsys.readouterr()
        status = main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return Result(status, out, err)

    return run


def plate_truth() -> Truth:
    """The exact modal model of the plate, with residues, as the truth of every run."""
    shapes = plate_shapes(PLATE.positions_m(), len(PLATE.frequency_hz))
    modes = PLATE.modes()
    residues = shapes * shapes[:, -1:] / (2j * modes.poles.imag[:, None] * PLATE.modal_mass_kg)
    drive = Dof(DRIVE_NODE, Direction.PLUS_Z)
    model: ModalModel = replace(
        modes,
        dofs=(*modes.dofs, drive),
        shapes=shapes.astype(complex),
        references=(drive,),
        residues=residues[..., None],
        labels=("first", "second"),
    )
    runs = tuple(range(1, PLATE.stations + 1))
    body = RigidBodyProperties(6.24, np.array([0.6, 0.0, 0.0]), np.diag([2.8, 0.48, 2.9]))
    return Truth("quick", body, model, runs, (model,) * len(runs), (model,) * len(runs))


@pytest.fixture(scope="session")
def plate_campaign() -> Campaign:
    """The plate's campaign."""
    return PLATE.campaign()


@pytest.fixture
def simulations(monkeypatch: pytest.MonkeyPatch, plate_campaign: Campaign) -> list[str]:
    """Let the plate stand in for the simulation; the list grows by a scenario's name at every simulation."""
    import vgvt.simulation

    done: list[str] = []

    def simulate(scenario: Any, *, engine: str | None = None, progress: Any = None) -> vgvt.simulation.SimulationResult:
        done.append(scenario.name)
        if progress is not None:
            progress(0.5, "half way")
        return vgvt.simulation.SimulationResult(plate_campaign, plate_truth(), {"simulate": 0.1})

    monkeypatch.setattr(vgvt.simulation, "simulate", simulate)
    return done


@pytest.fixture
def campaign_file(tmp_path: Path, plate_campaign: Campaign) -> Path:
    """The plate's campaign on disk."""
    from vgvt.files import write_campaign

    path = tmp_path / "plate.nc"
    write_campaign(path, plate_campaign)
    return path
