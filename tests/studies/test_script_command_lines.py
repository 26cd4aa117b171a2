"""Every script under docs/ answers --help, and refuses what is wrong before any work: no test here starts a study."""

from __future__ import annotations

import ast
import importlib
import os
import signal
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import command_line
import pytest

from vgvt.data import InputError

DOCS = Path(__file__).resolve().parents[2] / "docs"
SCRIPTS = sorted(p for p in (*DOCS.glob("*.py"), *DOCS.glob("studies/*.py")) if "__main__" in p.read_text("utf-8"))
WITH_SEEDS = ("clay_or_glue", "sweep_width", "torsion_drive_point", "cramer_rao")
_PATIENCE_S = 300.0  # of a machine that is busy with others; a study would take longer
WITH_CASES = ("closing_the_loop", "next_test", "one_level_or_two")


def module_of(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(DOCS)
    return importlib.import_module(name)


def refusal(name: str, words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    """What a script says of a wrong command line, with exit status 2."""
    script = module_of(name, monkeypatch)
    with pytest.raises(SystemExit) as left:
        script.arguments(words)
    said = capsys.readouterr()
    assert left.value.code == 2 and not said.out and said.err.startswith("usage: ")
    return said.err


def test_there_are_scripts_to_judge() -> None:
    assert {p.stem for p in SCRIPTS} >= {*WITH_SEEDS, *WITH_CASES, "hati_reconciled", "make_pictures"}


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda p: p.stem)
def test_a_script_reads_its_command_line_before_anything_else(path: Path) -> None:
    """``sys.exit(main())``, and main begins with ``arguments(words)``: what the tests below ask a shell gets, too."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.unparse(tree.body[-1]) == "if __name__ == '__main__':\n    sys.exit(main())"
    (main,) = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "main")
    assert ast.unparse(main.body[1]).removeprefix("given = ") == "arguments(words)"
    assert ast.unparse(main.body[-1]).startswith("return worked_off(")
    assert not [n for n in ast.walk(tree) if isinstance(n, ast.Attribute) and ast.unparse(n) == "sys.argv"]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda p: p.stem)
def test_help_is_the_docstring_and_the_arguments(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = module_of(path.stem, monkeypatch)
    with pytest.raises(SystemExit) as left:
        script.arguments(["--help"])
    said = capsys.readouterr().out
    assert left.value.code == 0
    assert said.startswith("usage: ") and str(script.__doc__).splitlines()[0] in said


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda p: p.stem)
@pytest.mark.parametrize("words", [["--no-such-thing"], ["no-such-thing", "--no-such-thing"]], ids=len)
def test_what_no_script_knows_is_refused(
    path: Path, words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "no-such-thing" in refusal(path.stem, words, monkeypatch, capsys) or len(words) == 1


@pytest.mark.parametrize("name", WITH_SEEDS)
@pytest.mark.parametrize("count", ["abc", "0", "-3", "2.5", "nan"])
def test_a_count_is_a_whole_number_above_none(
    name: str, count: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refusal(name, [count], monkeypatch, capsys)
    assert f"argument SEEDS: {count!r} does not do: write a whole number, " in said


@pytest.mark.parametrize(
    ("name", "words", "said"),
    [
        ("hati_reconciled", ["mian"], "there is no 'mian': did you mean 'main'? choose one of: fine-floor, first, "),
        ("hati_reconciled", ["null", "splits"], "stage splits needs what the whole catalogue names"),
        ("hati_reconciled", ["main", "--page"], "--page writes the page of all that is kept: name no STAGE"),
        ("hati_identified", ["pemm"], "no such identifier"),
        ("hati_identified", ["auto", "--page"], "--page writes the page of all that is kept: name no METHOD"),
        ("cramer_rao", ["20", "atuo"], "did you mean 'auto'?"),
        ("clay_or_glue", ["1"], "write a whole number, 2 or more"),
        ("sweep_width", ["1001"], "write a whole number, one from 2 to 1000"),
        ("one_level_or_two", ["new", "--only", "run-drfit"], "did you mean 'run-drift'?"),
        (
            "closing_the_loop",
            ["new", "--only", "placebos"],
            "one of: beside, effect, family, never, pair, placebo, removed",
        ),
        ("closing_the_loop", ["new", "--draws", "0"], "argument --draws: '0' does not do"),
        ("closing_the_loop", ["new", "--placebos", "-1"], "argument --placebos: '-1' does not do"),
        ("closing_the_loop", ["new", "--workers", "0"], "argument --workers: '0' does not do"),
        ("closing_the_loop", ["new", "--minutes", "0"], "argument --minutes: '0' does not do"),
        ("closing_the_loop", ["new", "--minutes", "nan"], "argument --minutes: 'nan' does not do"),
        ("closing_the_loop", ["new", "--small", "--alone"], "not allowed with argument --small"),
        ("closing_the_loop", ["new", "--alone", "--only", "pair"], "write neither --only nor --short"),
        ("next_test", ["new", "--draws", "-1"], "argument --draws: '-1' does not do"),
        ("planned_scatter", ["qick"], "argument scenario: "),
        ("planned_scatter", ["quick", "--seeds", "5", "6"], "a scatter needs two campaigns"),
        ("planned_scatter", ["quick", "--identifier", "atuo"], "did you mean 'auto'?"),
        ("planned_scatter", ["quick", "--out", str(DOCS)], "is a folder: name a file"),
        ("make_effect_figures", ["added-mas"], "did you mean 'added-mass'?"),
        ("make_pictures", ["nowhere"], "nowhere holds no campaign.nc"),
        ("make_pictures", [], "runs/quick holds no campaign.nc"),
    ],
)
def test_a_slip_is_told_with_what_to_write(
    name: str,
    words: list[str],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    script = module_of(name, monkeypatch)
    if hasattr(script, "FOLDER"):
        monkeypatch.setattr(script, "FOLDER", tmp_path / "kept")
    assert said in " ".join(refusal(name, words, monkeypatch, capsys).split())
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", WITH_CASES)
def test_a_folder_that_is_a_file_or_that_a_report_does_not_find_is_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "notes").touch()
    for place in ("notes", "notes/cases"):
        said = refusal(name, [str(tmp_path / place)], monkeypatch, capsys)
        assert f"argument FOLDER: {tmp_path / 'notes'} is a file: name a folder" in said
    assert "there is no folder" in refusal(name, [str(tmp_path / "cass"), "--report"], monkeypatch, capsys)
    assert [p.name for p in tmp_path.iterdir()] == ["notes"]


@pytest.mark.parametrize(
    ("name", "words", "found"),
    [
        ("sweep_width", [], {"seeds": 400}),
        ("clay_or_glue", ["20"], {"seeds": 20}),
        ("torsion_drive_point", [], {"seeds": 20}),
        ("cramer_rao", [], {"seeds": 120, "methods": []}),
        ("cramer_rao", ["400", "auto"], {"seeds": 400, "methods": ["auto"]}),
        ("hati_reconciled", [], {"stages": [], "page": False}),
        ("hati_reconciled", ["null", "first", "splits"], {"stages": ["null", "first", "splits"]}),
        ("hati_identified", ["auto", "--again", "era"], {"methods": ["auto", "era"], "again": True}),
        ("closing_the_loop", ["new", "--in-turn", "--only", "removed", "--minutes", "60"], {"minutes": 60.0}),
        ("closing_the_loop", ["new"], {"workers": 2, "draws": 20, "placebos": 200, "seed": 1, "only": None}),
        ("one_level_or_two", ["new", "--only", "root-friction, second laboratory"], {"report": False}),
        ("planned_scatter", ["quick", "--seeds", "0", "52", "--identifier", "auto"], {"seeds": [0, 52]}),
        ("planned_scatter", ["quick"], {"seeds": (0, 50), "out": Path("planned-scatter.jsonl")}),
        ("make_effect_figures", ["run-drift"], {"effects": ["run-drift"]}),
    ],
)
def test_what_the_pages_say_is_understood(
    name: str, words: list[str], found: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    given = vars(module_of(name, monkeypatch).arguments(words))
    assert {key: given[key] for key in found} == found


@pytest.mark.parametrize("words", [["--help"], ["no-such-stage"]], ids=lambda w: w[0])
def test_a_shell_gets_the_same(words: list[str]) -> None:
    """The study that once began whatever was written."""
    script = [sys.executable, str(DOCS / "studies" / "hati_reconciled.py"), *words]
    done = subprocess.run(script, capture_output=True, text=True, timeout=_PATIENCE_S, check=False)
    assert done.returncode == (0 if words == ["--help"] else 2)
    assert (done.stdout or done.stderr).startswith("usage: hati_reconciled.py")
    assert "Traceback" not in done.stderr


def test_bad_input_that_the_work_finds_is_a_message(capsys: pytest.CaptureFixture[str]) -> None:
    def work() -> None:
        raise InputError("case.json", "is cut off", "remove it")

    handler = signal.getsignal(signal.SIGINT)
    assert command_line.worked_off(work, "") == 2
    assert capsys.readouterr().err.endswith("case.json: is cut off\n  remove it\n")
    assert command_line.worked_off(lambda: None, "") == 0
    assert signal.getsignal(signal.SIGINT) is handler


_WAITS = """
import multiprocessing, sys, time
from command_line import worked_off
fork = multiprocessing.get_context("fork")
begun = fork.Event()
def work():
    begun.set()
    time.sleep(600)
def wait():
    child = fork.Process(target=work)
    child.start()
    begun.wait()
    print("ready", flush=True)
    child.join()
sys.exit(worked_off(wait, "ten cases are kept"))
"""


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"])
def test_an_interrupted_script_says_what_is_kept_and_waits_for_no_worker(number: signal.Signals, status: int) -> None:
    """Also where the shell has its job in the background ignore Ctrl-C."""
    script = subprocess.Popen(
        [sys.executable, "-c", _WAITS], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(DOCS / "studies"), *sys.path])},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN) and None,
    )  # fmt: skip
    with script:
        assert script.stdout is not None and script.stdout.readline() == "ready\n"
        script.send_signal(number)
        _, said = script.communicate(timeout=_PATIENCE_S)
    assert script.returncode == status
    assert ("interrupted\n  ten cases are kept\n" in said) is (number == signal.SIGINT)
