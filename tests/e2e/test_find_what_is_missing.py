"""The tutorial that hides something and lets it be found prints what the program says, verdicts and figures."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vgvt.cli import main
from vgvt.effects import available_effects
from vgvt.scenario import bundled_scenarios, load_scenario

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "tutorials" / "find-what-is-missing.md").read_text(encoding="utf-8")
HOW_TO = (DOCS / "how-to" / "close-the-loop.md").read_text(encoding="utf-8")
HIDDEN = {"mass_kg": 0.06, "frequency_hz": 12.0, "damping_ratio": 0.02, "x_m": 0.83, "y_m": -1.05}
BENDING_STIFFNESS_N_M2 = 303.4
RECONCILED = "reconciled/surprise-quick/reconciled.toml"
NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:e[+-]?\d+)?)")


@dataclass
class Told:
    """A folder in which the page's commands were given: what each of them printed, and the verdicts as objects."""

    folder: Path
    printed: list[str] = field(default_factory=list)
    verdicts: list[Any] = field(default_factory=list)


def cells(kind: str) -> list[str]:
    """What stands in the page's cells of a kind."""
    return [str(cell) for cell in re.findall(rf"^```{kind}\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)]


def commands() -> list[list[str]]:
    """Words of every command, without the program's own name."""
    return [shlex.split(line.removeprefix("$ "))[1:] for cell in cells("console") for line in cell.splitlines()]


def hide(folder: Path) -> Path:
    """Write the page's scenario into a folder."""
    (text,) = cells("toml")
    (folder / "surprise.toml").write_text(text, encoding="utf-8")
    return folder / "surprise.toml"


def without_time(text: str) -> str:
    """What a command printed, but for how long it took."""
    return re.sub(r"^\d+ s; ", "", text, flags=re.MULTILINE)


def assert_same(page: str, said: str) -> None:
    """The same words in the same order, and figures that differ by no more than another processor's rounding does."""
    left, right = (NUMBER.split(" ".join(re.sub(r"[─\s]+", " ", text).split())) for text in (page, said))
    assert left[::2] == right[::2]
    for told, now in zip(left[1::2], right[1::2], strict=True):
        last_place = 0.1 * float(told) if "e" in told else 10.0 ** -len(told.partition(".")[2])
        assert float(told) == pytest.approx(float(now), rel=0.02, abs=1.01 * last_place), (told, now)


def test_what_is_hidden_is_what_the_page_says(tmp_path: Path) -> None:
    scenario, stated = load_scenario(hide(tmp_path)), load_scenario("quick")
    different = {"name", "summary", "lesson", "seed", "airframe", "effect"}
    assert {key for key, value in scenario if value != getattr(stated, key)} == different
    (effect,) = scenario.effect
    assert effect.model_dump(exclude_defaults=True).items() >= HIDDEN.items()
    wing, believed = (np.array(s.airframe.beam[0].stations.bending_stiffness_n_m2) for s in (scenario, stated))
    assert np.unique(wing) == [BENDING_STIFFNESS_N_M2]
    assert np.allclose(wing / believed, 0.96, atol=1e-4)
    assert stated.tolerances.stiffness_scale == 0.10


def test_the_page_reads_what_it_has_made(tmp_path: Path) -> None:
    hide(tmp_path)
    made = set()
    for verb, what, *options in commands():
        if verb == "simulate":
            assert what == "surprise.toml" or what in bundled_scenarios()
            made.add(f"runs/{load_scenario(tmp_path / what if what.endswith('.toml') else what).name}")
        elif verb == "run":
            assert what == RECONCILED
        else:
            assert what in made
        named = dict(zip(options[::2], options[1::2], strict=True))
        assert named.get("--scenario", "quick") == "quick"
        assert named.get("--without", "local-absorber") in available_effects()
    assert [words[0] for words in commands()] == [
        "simulate", "identify", "reconcile", "run", "simulate", "reconcile", "reconcile",
    ]  # fmt: skip


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Told]:
    """Every command of the page in one folder: nobody who reads it has two."""
    from vgvt.reconcile import loop

    told = Told(tmp_path_factory.mktemp("found"))
    hide(told.folder)
    reconcile = loop.reconcile

    def kept(*arguments: Any, **options: Any) -> Any:
        told.verdicts.append(reconcile(*arguments, **options))
        return told.verdicts[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(told.folder)
        patch.setattr(loop, "reconcile", kept)
        for words in commands():
            with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
                assert main(words) == 0, words
            told.printed.append(out.getvalue())
        yield told


@pytest.mark.slow
def test_the_commands_say_what_the_page_prints(told: Told) -> None:
    assert [verdict.kind for verdict in told.verdicts] == ["explained", "adequate", "unknown"]
    for printed, step in zip(cells("text"), (1, 2, 5), strict=True):
        assert_same(without_time(printed), without_time(told.printed[step]))


@pytest.mark.slow
def test_what_is_found_is_what_was_hidden(told: Told) -> None:
    """Every size and place within its interval, and the wings as soft as they are."""
    document = json.loads((told.folder / RECONCILED).with_name("verdict.json").read_text(encoding="utf-8"))
    (found,) = document["effects"]
    assert found["parameters"].keys() == HIDDEN.keys() and not found["equivalent"]
    assert all(p["low"] <= HIDDEN[name] <= p["high"] for name, p in found["parameters"].items())
    wings = load_scenario(told.folder / RECONCILED).airframe.beam
    stiffness = np.concatenate([beam.stations.bending_stiffness_n_m2 for beam in wings])
    assert np.mean(stiffness) == pytest.approx(BENDING_STIFFNESS_N_M2, rel=5e-3)


@pytest.mark.slow
def test_the_page_states_the_modes_of_the_model(told: Told) -> None:
    from vgvt.files.truth import read_truth

    truth = read_truth(told.folder / "runs" / "quick" / "sealed" / "truth.nc").as_tested[0]
    first, second, third = (f"{hz:.3f}" for hz in truth.natural_frequency_hz if 3.0 < hz < 35.0)
    assert f"The model has three, at {first}, {second} and {third} Hz" in PAGE


@pytest.mark.slow
def test_what_no_catalogue_holds_is_pointed_at(told: Told) -> None:
    (place,) = re.findall(r"here `([^`]+)`, a grid point beside it", PAGE)
    assert f"points at force at {place}" in " ".join(told.printed[-1].split())


@pytest.mark.slow
def test_the_how_to_shows_that_verdict_at_a_prompt(told: Told) -> None:
    (shown,) = re.findall(r"^```text\n(<Verdict: .*?)^```", HOW_TO, flags=re.MULTILINE | re.DOTALL)
    assert_same(shown, repr(told.verdicts[0]))
