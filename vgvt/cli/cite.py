"""``vgvt cite``: BibTeX for what a run used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vgvt.cli.document import write_document
from vgvt.cli.options import JsonOption

if TYPE_CHECKING:
    from vgvt.identification import Identifier

_SOFTWARE = """\
@software{vgvt,
  title = {vgvt: a virtual ground vibration test},
  author = {{The vgvt developers}},
  version = {%s},
}

@inproceedings{todorov2012mujoco,
  title = {{MuJoCo}: a physics engine for model-based control},
  author = {Todorov, Emanuel and Erez, Tom and Tassa, Yuval},
  booktitle = {IEEE/RSJ International Conference on Intelligent Robots and Systems},
  pages = {5026--5033},
  year = {2012},
  doi = {10.1109/IROS.2012.6386109},
}
"""


def cite(
    used: Annotated[
        list[str] | None,
        typer.Argument(metavar="[IDENTIFIER | RUN_FOLDER]...", help="What was used; all identifiers when left out."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Print BibTeX for vgvt, its physics engine and the identification methods used."""
    from vgvt import __version__
    from vgvt.identification import available_identifiers, bibliography, bibtex_entries

    names = [name for text in used or [] for name in _identifiers_of(text)]
    chosen = [_identifier(name) for name in dict.fromkeys(names)] if used else list(available_identifiers().values())
    text = _SOFTWARE % __version__ + "\n" + bibliography(chosen)
    if as_json:
        write_document({"entries": [{"key": key, "bibtex": entry} for key, entry in bibtex_entries(text).items()]})
        return 0
    typer.echo(text.rstrip())
    return 0


def _identifiers_of(text: str) -> list[str]:
    from vgvt.data import InputError

    if not Path(text).is_dir():
        return [text]
    names = sorted(path.stem for path in (Path(text) / "claims").glob("*.json"))
    if not names:
        raise InputError(text, "this folder holds no claims", "name identifiers or the folder of a vgvt run")
    return names


def _identifier(name: str) -> type[Identifier]:
    from vgvt.identification import make_identifier

    return type(make_identifier(name))
