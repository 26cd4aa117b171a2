"""House rules that a program can check: file length, names, pickles, paths, seeds, docstrings."""

from __future__ import annotations

import ast
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = (ROOT / "vgvt", ROOT / "identifiers" / "vgvt_identifiers", ROOT / "scoreboard" / "vgvt_scoreboard")
SOURCES = sorted(path for package in PACKAGES for path in package.rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
LONGEST_FILE = 350
FORBIDDEN_NAMES = {"utils", "util", "helpers", "helper", "misc", "common", "tools"}
PICKLES = {"pickle", "cPickle", "cloudpickle", "dill", "joblib", "shelve", "marshal"}
SEEDED = {"default_rng", "SeedSequence", "Generator", "PCG64", "Philox", "BitGenerator", "RandomState", "get_state"}
UNSEEDED_BY_DEFAULT = {"default_rng", "SeedSequence", "PCG64", "Philox", "RandomState", "Random"}
BINARY = {".png", ".jpg", ".nc", ".npz", ".mat", ".gz", ".whl", ".pdf", ".ico", ".woff2"}

# Home folders, scratch folders and mounts of somebody's machine; addresses of package registries and their mirrors.
PRIVATE_PATH = re.compile(r"(?<![\w./:~<>$}-])(?:/(?:home|Users|root|mnt|tmp|var/folders)/[\w.-]+|[A-Z]:\\Users\\)")
THIS_CHECKOUT = re.compile("|".join(re.escape(str(place)) for place in (ROOT, ROOT.parent / "shared")))
# An index is told by the shape of its address or by the option that names it, so that no host need be named here.
REGISTRY_HOST = re.compile(
    r"https?://[^\s\"'<>)]*/simple(?:/|\b(?![\w.-]))"
    r"|https?://files\.[^\s\"'<>)]+"
    r"|(?:extra[-_])?index[-_]url\s*[= ]\s*[\"']?https?:"
    r"|https?://[^\s\"'<>)]+\.whl\b",
    re.IGNORECASE,
)


def relative(path: Path) -> str:
    """Path as a person reads it."""
    return str(path.relative_to(ROOT))


@cache
def tree_of(path: Path) -> ast.Module:
    """Syntax tree of a source file."""
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def length(path: Path) -> int:
    """Lines of a file."""
    return len(path.read_text(encoding="utf-8").splitlines())


def imported_modules(tree: ast.Module) -> set[str]:
    """Top-level names of everything a file imports, also inside functions."""
    names = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module}
    return {name.split(".")[0] for name in names}


def project_files() -> list[Path]:
    """Text files of the project as version control sees them; every file of the tree outside a checkout."""
    listing = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        capture_output=True,
        text=True,
        check=False,
    )
    names = listing.stdout.split("\0") if listing.returncode == 0 else [relative(p) for p in ROOT.rglob("*")]
    files = (ROOT / name for name in names if name and not name.startswith((".git/", ".venv", ".hypothesis/")))
    return [p for p in files if p.is_file() and p.suffix not in BINARY and "__pycache__" not in p.parts]


def dotted(function: ast.expr) -> str:
    """Plain dotted name of what is called; empty for a method of something computed."""
    names = []
    while isinstance(function, ast.Attribute):
        names.append(function.attr)
        function = function.value
    return ".".join([function.id, *reversed(names)]) if isinstance(function, ast.Name) else ""


def unseeded_calls(tree: ast.Module) -> list[str]:
    """Calls that draw randomness nobody named: no seed given, or numpy's and Python's hidden global state."""
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = dotted(node.func)
        last = name.rsplit(".", 1)[-1]
        global_state = name.startswith(("np.random.", "numpy.random.", "random.")) and last not in SEEDED | {"Random"}
        no_seed = last in UNSEEDED_BY_DEFAULT and not node.args and not node.keywords
        none_seed = last in UNSEEDED_BY_DEFAULT and any(ast.unparse(a) == "None" for a in node.args)
        if global_state or no_seed or none_seed:
            found.append(f"line {node.lineno}: {ast.unparse(node)}")
    return found


def test_there_are_sources_to_judge() -> None:
    assert len(SOURCES) > 20 and len(TESTS) > 20


def test_a_file_holds_one_idea() -> None:
    long = [f"{relative(path)}: {length(path)} lines" for path in SOURCES if length(path) > LONGEST_FILE]
    assert not long, "split it, one idea a file: " + "; ".join(long)
    drawers = [relative(path) for path in SOURCES if path.stem in FORBIDDEN_NAMES]
    assert not drawers, "name the idea, not the drawer: " + "; ".join(drawers)


BETWEEN_PROCESSES = {"vgvt/reconcile/work/team.py"}
"""What a process and its own fork say to each other over a pipe; none of it is ever in a file."""


def test_no_pickle() -> None:
    pickles = [
        f"{relative(path)}: {', '.join(found)}"
        for path in SOURCES
        if relative(path) not in BETWEEN_PROCESSES and (found := imported_modules(tree_of(path)) & PICKLES)
    ]
    pickles += [
        relative(path) for path in SOURCES if re.search(r"allow_pickle\s*=\s*True", path.read_text(encoding="utf-8"))
    ]
    assert not pickles, "files are data, never code: " + "; ".join(pickles)


def test_every_generator_is_seeded_by_argument() -> None:
    unseeded = [f"{relative(path)}, {call}" for path in (*SOURCES, *TESTS) for call in unseeded_calls(tree_of(path))]
    assert not unseeded, "\n".join(unseeded)


def test_tests_are_short_too() -> None:
    long = [f"{relative(path)}: {length(path)} lines" for path in TESTS if length(path) > LONGEST_FILE]
    assert not long, "split it: " + "; ".join(long)


@pytest.mark.parametrize(
    ("snippet", "found"),
    [
        ("import numpy as np\nnp.random.default_rng()", True),
        ("import numpy as np\nnp.random.default_rng(None)", True),
        ("import numpy as np\nnp.random.normal(size=3)", True),
        ("import random\nrandom.random()", True),
        ("import numpy as np\nnp.random.default_rng().normal()", True),
        ("import numpy as np\nnp.random.default_rng(3)", False),
        ("import numpy as np\nnp.random.default_rng(3).normal(size=(2, 4))", False),
        ("def draw(generator):\n    return generator.normal()", False),
        ("import numpy as np\nnp.random.Generator(np.random.PCG64(5))", False),
    ],
)
def test_the_seed_check_can_tell(snippet: str, found: bool) -> None:
    assert bool(unseeded_calls(ast.parse(snippet))) is found


def test_no_file_names_a_machine_or_a_registry() -> None:
    offences = []
    for path in project_files():
        if path == Path(__file__).resolve():  # its own samples of what is forbidden
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        for pattern in (PRIVATE_PATH, THIS_CHECKOUT, REGISTRY_HOST):
            offences += [
                f"{relative(path)}:{text.count(chr(10), 0, hit.start()) + 1}: {hit.group()}"
                for hit in pattern.finditer(text)
            ]
    assert not offences, "\n".join(offences)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("see /home/anna/gvt", True),
        ('open("/tmp/x.nc")', True),
        ("C:\\Users\\anna", True),
        ("../shared/data", False),
        ("vgvt/work/flow", False),
        ("the ratio a/home/b", False),
        ("https://example.org/home/page", False),
    ],
)
def test_the_path_check_can_tell(text: str, found: bool) -> None:
    assert bool(PRIVATE_PATH.search(text)) is found


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("https://host.example/simple/numpy/", True),
        ("http://host.example:8080/api/simple", True),
        ("--index-url https://host.example/root", True),
        ('extra-index-url = "https://host.example"', True),
        ("https://files.host.example/packages/ab/cd", True),
        ("https://host.example/numpy-2.0-py3-none-any.whl", True),
        ("https://example.org/simple-harmonic-motion", False),
        ("https://example.org/a/simpler/b", False),
        ("set an index url of your own", False),
        ("https://example.org/profiles.html", False),
    ],
)
def test_the_registry_check_can_tell(text: str, found: bool) -> None:
    assert bool(REGISTRY_HOST.search(text)) is found
