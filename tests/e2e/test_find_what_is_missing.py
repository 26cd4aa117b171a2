"""The tutorial that hides something and lets it be found prints what the program says."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from vgvt.cli import main
from vgvt.scenario import load_scenario

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorials" / "find-what-is-missing.md"
HIDDEN = {"mass_kg": 0.03, "frequency_hz": 12.0, "damping_ratio": 0.02, "x_m": 0.85, "y_m": 1.0}
NUMBER = r"(?<![\w.])\d+(?:\.\d+)?"


def cells(kind: str) -> list[str]:
    """What stands in the page's cells of a kind."""
    found = re.findall(rf"^```{kind}\n(.*?)^```", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return [str(cell) for cell in found]


def commands() -> list[list[str]]:
    """Words of every command, without the program's own name."""
    return [shlex.split(line.removeprefix("$ "))[1:] for cell in cells("console") for line in cell.splitlines()]


def as_one_line(text: str) -> str:
    """Without the breaks that the width of a terminal makes, and the table's last column of one number."""
    return re.sub(r"\s+", " ", re.sub(r" {3,}\d+ *$", "", text, flags=re.MULTILINE))


def the_parameters(said: str) -> dict[str, tuple[float, float]]:
    """Value and deviation of each parameter that is told."""
    told = re.findall(rf"(\w+) = ({NUMBER}) ± ({NUMBER})", as_one_line(said))
    return {name: (float(value), float(deviation)) for name, value, deviation in told}


def the_verdict(said: str) -> str:
    """The first sentence that a command prints, without its figures."""
    return re.sub(NUMBER, "·", as_one_line(said.split("\n\n")[0]).strip())


def test_what_is_hidden_is_what_the_page_says(tmp_path: Path) -> None:
    (written,) = cells("toml")
    (tmp_path / "surprise.toml").write_text(written, encoding="utf-8")
    (effect,) = load_scenario(tmp_path / "surprise.toml").effect
    assert effect.model_dump(exclude_defaults=True).items() >= HIDDEN.items()
    assert [words[:2] for words in commands()] == [
        ["simulate", "surprise.toml"],
        ["reconcile", "runs/surprise"],
        ["run", "reconciled/surprise-quick/reconciled.toml"],
        ["simulate", "quick"],
        ["reconcile", "runs/quick"],
        ["reconcile", "runs/surprise"],
    ]
    printed, _ = cells("text")
    told = the_parameters(printed)
    assert told.keys() == HIDDEN.keys()
    assert all(abs(value - HIDDEN[name]) < 3 * deviation for name, (value, deviation) in told.items())


@pytest.mark.slow
@pytest.mark.parametrize(("steps", "printed"), [((0, 1), 0), ((3, 4), 1)], ids=["hidden", "nothing"])
def test_the_commands_say_what_the_page_prints(
    steps: tuple[int, ...],
    printed: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "surprise.toml").write_text(cells("toml")[0], encoding="utf-8")
    for step in steps:
        capsys.readouterr()
        assert main(commands()[step]) == 0
    said, page = capsys.readouterr().out, cells("text")[printed]
    assert the_verdict(said) == the_verdict(page)
    now, then = the_parameters(said), the_parameters(page)
    assert now.keys() == then.keys()
    # The same records, the same search: what differs is rounding.
    assert all(abs(now[name][0] - value) < 0.2 * deviation for name, (value, deviation) in then.items())
