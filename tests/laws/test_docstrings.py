"""Everything public is documented, and public verbs on arrays say shapes or units."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = (ROOT / "vgvt", ROOT / "identifiers" / "vgvt_identifiers", ROOT / "scoreboard" / "vgvt_scoreboard")
SOURCES = sorted(path for package in PACKAGES for path in package.rglob("*.py"))
SHAPE = re.compile(
    r"\([A-Za-z0-9_' ×+*|-]+(?:,[A-Za-z0-9_' .×+*|-]*)*\)|\bshapes?\b|\bscalar\b|same shape|one (?:per|a) "
)
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def relative(path: Path) -> str:
    """Path as a person reads it."""
    return str(path.relative_to(ROOT))


@cache
def tree_of(path: Path) -> ast.Module:
    """Syntax tree of a source file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def public_definitions(tree: ast.Module) -> Iterator[tuple[str, Definition, bool]]:
    """Qualified name, node and whether it belongs to a class, of every public class, function and method."""
    for node in tree.body:
        if isinstance(node, Definition) and not node.name.startswith("_"):
            yield node.name, node, False
            if isinstance(node, ast.ClassDef):
                for inner in node.body:
                    if isinstance(inner, Definition) and not inner.name.startswith("_"):
                        yield f"{node.name}.{inner.name}", inner, True


def is_overload(node: Definition) -> bool:
    """True for the typing stubs in front of a function."""
    return any(ast.unparse(decorator).endswith("overload") for decorator in node.decorator_list)


def takes_arrays(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """True where an argument is annotated as an array."""
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    return any(a.annotation is not None and "NDArray" in ast.unparse(a.annotation) for a in arguments)


def test_everything_public_has_a_docstring() -> None:
    silent = [relative(path) for path in SOURCES if not ast.get_docstring(tree_of(path))]
    assert not silent, "the module says in one sentence what it is: " + "; ".join(silent)
    bare = [
        f"{relative(path)}: {name}"
        for path in SOURCES
        for name, node, _ in public_definitions(tree_of(path))
        if not is_overload(node) and not ast.get_docstring(node)
    ]
    assert not bare, "without docstring: " + "; ".join(bare)


def test_docstrings_are_sentences() -> None:
    open_ended = []
    for path in SOURCES:
        for name, node, _ in public_definitions(tree_of(path)):
            text = ast.get_docstring(node)
            first = text.split("\n\n")[0].strip() if text else "."
            if not first.endswith((".", "?", "!", ":", "``", ")")):
                open_ended.append(f"{relative(path)}: {name}")
    assert not open_ended, "first paragraph does not end: " + "; ".join(open_ended)


def test_public_verbs_on_arrays_state_shapes() -> None:
    silent = [
        f"{relative(path)}: {name}"
        for path in SOURCES
        for name, node, in_class in public_definitions(tree_of(path))
        if isinstance(node, ast.FunctionDef) and not in_class and takes_arrays(node) and not is_overload(node)
        if not SHAPE.search(ast.get_docstring(node) or "")
    ]
    assert not silent, "no shape in the docstring of: " + "; ".join(silent)
