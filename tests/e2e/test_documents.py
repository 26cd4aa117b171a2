"""The documents do what they say: code cells run, commands exist, links lead somewhere."""

from __future__ import annotations

import re
import shlex
import subprocess
from contextlib import redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path

import pytest
from sybil import Sybil
from sybil.parsers.markdown import PythonCodeBlockParser

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted(
    [
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / folder / "README.md" for folder in ("scenarios", "identifiers", "scoreboard")),
    ]
)


def relative(path: Path) -> str:
    """Path as a person reads it."""
    return path.relative_to(ROOT).as_posix()


def python_cells(path: Path) -> list[str]:
    """The code of every Python cell."""
    return re.findall(r"^```python\n(.*?)^```", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def shell_lines(path: Path) -> list[str]:
    """Every vgvt command line in a console or shell cell, and in inline code that is one from beginning to end."""
    text = path.read_text(encoding="utf-8")
    cells = re.findall(r"^```(?:console|sh|bash)\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    lines = [line.removeprefix("$ ") for cell in cells for line in cell.splitlines()]
    inline = re.findall(r"(?<!`)`(vgvt [^`\n]+)`(?!`)", text)
    return [line for line in (*lines, *inline) if line.startswith("vgvt ")]


WITH_CELLS = [path for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))) if python_cells(path)]


def test_there_are_documents_with_code() -> None:
    assert {"README.md", "docs/tutorials/first-flight.md"} <= {relative(path) for path in WITH_CELLS}


@pytest.mark.parametrize("path", WITH_CELLS, ids=relative)
def test_code_cells_run(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    document = Sybil(parsers=[PythonCodeBlockParser()]).parse(path)
    examples = list(document.examples())
    assert len(examples) == len(python_cells(path))
    for example in examples:
        example.evaluate()


@cache
def told_of(*command: str) -> str:
    """What a command's help says: many lines of the documents are of the same few commands."""
    from vgvt.cli import main

    said = StringIO()
    with redirect_stdout(said):
        assert main([*command, "--help"]) == 0, command
    return said.getvalue()


@pytest.mark.parametrize("path", [path for path in DOCUMENTS if path.exists()], ids=relative)
def test_commands_exist(path: Path) -> None:
    for line in shell_lines(path):
        words = [word for word in shlex.split(line) if word not in ("|", "&&")][1:]
        plain = [word for word in words if re.fullmatch(r"[a-z]+", word)]
        options = [word for word in words if word.startswith("--")]
        if not plain:  # like `vgvt COMMAND --help`
            continue
        group = plain[0] in ("list", "data") and len(plain) > 1
        said = told_of(*plain[: 2 if group else 1])
        for option in options:
            assert option.split("=")[0] in said, f"{line}: there is no {option}"


@pytest.mark.parametrize("path", [path for path in DOCUMENTS if path.exists()], ids=relative)
def test_links_lead_somewhere(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)\s]+)\)", text)
    local = [target.split("#")[0] for target in targets if not re.match(r"[a-z]+:", target)]
    missing = [target for target in local if target and not (path.parent / target).exists()]
    assert not missing


def anchors(path: Path) -> set[str]:
    """What a link may name behind #: every heading as GitHub writes it, a second one of the same words with -1."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    found: set[str] = set()
    for heading in re.findall(r"^#{1,6} +(.+?) *$", text, flags=re.MULTILINE):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        same = sum(1 for anchor in found if re.fullmatch(rf"{re.escape(name)}(-\d+)?", anchor))
        found.add(f"{name}-{same}" if same else name)
    return found


@pytest.mark.parametrize("path", [path for path in DOCUMENTS if path.exists()], ids=relative)
def test_links_into_a_page_meet_a_heading(path: Path) -> None:
    targets = re.findall(r"\]\(([^)\s:]*#[^)\s]+)\)", path.read_text(encoding="utf-8"))
    for target in targets:
        page, _, anchor = target.partition("#")
        there = (path.parent / page).resolve() if page else path
        assert there.suffix != ".md" or anchor in anchors(there), target


def readme_command(name: str) -> str:
    """The command line under a marker of the README."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (command,) = re.findall(rf"^<!-- command:{name} -->\n```sh\n([^\n]+)\n```$", text, flags=re.MULTILINE)
    return str(command)


def test_the_two_commands_are_one_line_each_and_need_only_python() -> None:
    for name in ("run", "test"):
        command = readme_command(name)
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install ")
        assert all(part.split()[0].startswith((".venv/bin/", "python3")) for part in command.split(" && "))


def test_ci_runs_the_readme_word_for_word() -> None:
    """.ci/run takes the commands out of the README; its own extraction must see what a reader sees."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    function = re.search(r"^readme_command\(\).*?^}", script, flags=re.MULTILINE | re.DOTALL)
    assert function
    for name in ("run", "test"):
        assert f"readme_command {name}" in script
        done = subprocess.run(
            ["bash", "-c", f"{function[0]}\nreadme_command {name}"],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        )
        assert done.stdout == readme_command(name) + "\n"
    for name in ("run", "test"):
        assert f'bash -c "${name}_command"' in script


def test_citation_names_the_version() -> None:
    from vgvt import __version__

    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version: {__version__}\n" in text
    assert f"## [{__version__}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
