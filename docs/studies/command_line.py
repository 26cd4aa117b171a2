"""The command line of a script under docs/: what it refuses before any work, and how it ends when it is stopped.

Exit status as that of ``vgvt``: 0 done, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import NoReturn

from vgvt.cli import interruption
from vgvt.cli.boundary import BAD_INPUT, DONE, INTERRUPTED
from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.identification import make_identifier
from vgvt.scenario import Scenario, load_scenario

raise_if_asked = interruption.raise_if_asked
BEGIN_AGAIN = "pages and figures are written at the end: each is as it was or new, and whole; begin again"
"""What is said of a study that keeps nothing on its way."""


def parser_of(doc: str | None) -> argparse.ArgumentParser:
    """A parser whose ``--help`` is the script's docstring and its arguments."""
    return argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)


def parser_of_seeds(doc: str | None, number: Callable[[str], int], default: int, of: str) -> argparse.ArgumentParser:
    """The parser of a study that says how many SEEDS it asks of each ``of`` (a sweep, a mount), and nothing else."""
    parser, said = parser_of(doc), f"campaigns {of} ({default} if nothing is said)"
    parser.add_argument("seeds", nargs="?", type=number, default=default, metavar="SEEDS", help=said)
    return parser


def parser_of_cases(doc: str | None) -> argparse.ArgumentParser:
    """The parser of a study that keeps its cases in a FOLDER, and fills its page from them with ``--report``."""
    parser = parser_of(doc)
    parser.add_argument("folder", type=folder, metavar="FOLDER", help="where the cases are kept")
    parser.add_argument("--report", action="store_true", help="fill the page from what is done")
    return parser


def add_how_long(parser: argparse.ArgumentParser) -> None:
    """How many processes work on cases, and for how long."""
    parser.add_argument("--workers", type=whole_number(1), default=2, help="processes, each with a case (2)")
    parser.add_argument("--minutes", type=minutes, default=float("inf"), help="begin nothing after that")


def cases_stay(where: Path) -> str:
    """What is said of an interrupted study that keeps its cases."""
    return f"every case that is done is kept in {where}; the same command goes on from there"


def made(where: Path) -> None:
    """Make a folder that is not there yet; InputError where that cannot be."""
    try:
        where.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(where), f"cannot be made: {error.strerror or error}", "choose another folder") from error


def cases_asked_for(parser: argparse.ArgumentParser, words: Sequence[str] | None) -> argparse.Namespace:
    """The arguments; a report needs a folder that is there: another is a slip of the pen."""
    given = parser.parse_args(words)
    if given.report and not given.folder.is_dir():
        parser.error(f"there is no folder {given.folder}: --report wants the one that the study kept its cases in")
    return given


def folder(text: str) -> Path:
    """The type of an argument that names a folder, which need not be there yet."""
    path = Path(text)
    for place in (path, *path.parents):
        if place.exists() and not place.is_dir():
            raise argparse.ArgumentTypeError(f"{place} is a file: name a folder, a new one or one that a run has left")
    return path


def file(text: str) -> Path:
    """The type of an argument that names a file to write."""
    path = Path(text)
    if path.is_dir():
        raise argparse.ArgumentTypeError(f"{text} is a folder: name a file")
    folder(str(path.parent))
    return path


def whole_number(least: int, most: float = float("inf")) -> Callable[[str], int]:
    """The type of an argument that is a whole number from ``least`` to ``most``."""
    wanted = f"{least} or more" if most == float("inf") else f"one from {least} to {most:g}"

    def number(text: str) -> int:
        with suppress(ValueError):
            if least <= int(text) <= most:
                return int(text)
        raise argparse.ArgumentTypeError(f"{text!r} does not do: write a whole number, {wanted}")

    return number


def minutes(text: str) -> float:
    """The type of an argument that says how long: a number above 0."""
    with suppress(ValueError):
        if float(text) > 0:
            return float(text)
    raise argparse.ArgumentTypeError(f"{text!r} does not do: write a number of minutes above 0, like 30")


def one_of(known: Iterable[str]) -> Callable[[str], str]:
    """The type of an argument that is one of some names."""
    names = tuple(known)

    def name(text: str) -> str:
        if text not in names:
            raise argparse.ArgumentTypeError(f"there is no {text!r}: {choose_one_of(text, names)}")
        return text

    return name


def identifier_named(text: str) -> str:
    """The type of an argument that names an identifier, one that can be used."""
    try:
        make_identifier(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return text


def scenario_named(text: str) -> Scenario:
    """The type of an argument that names a bundled scenario or its file."""
    try:
        return load_scenario(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def worked_off(work: Callable[[], None], kept: str) -> int:
    """Do the work; returns the exit status. Where it is interrupted ``kept`` says what there is and how to go on.

    Bad input that only the work can find is a message, too; VGVT_TRACEBACK=1 shows where it came up.
    """
    interruption.forget()
    before = {
        # Ctrl-C also in a script's job in the background, and a polite kill takes away half written files like it.
        signal.SIGINT: signal.signal(signal.SIGINT, interruption.on_signal),
        signal.SIGTERM: signal.signal(signal.SIGTERM, _leave),
    }
    try:
        work()
    except InputError as error:
        if os.environ.get("VGVT_TRACEBACK"):
            raise
        return _said(BAD_INPUT, str(error))
    except KeyboardInterrupt:
        _call_off_workers()
        return _said(INTERRUPTED, f"interrupted\n  {kept}" if kept else "")
    except SystemExit:
        _call_off_workers()
        raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return DONE


def _leave(number: int, _: FrameType | None) -> NoReturn:
    raise SystemExit(128 + number)


def _call_off_workers() -> None:
    """Who interrupts this process alone, and not the terminal's whole group, need not wait for a case to end."""
    for child in multiprocessing.active_children():
        with suppress(OSError, TypeError):  # it has ended meanwhile
            os.kill(child.pid, signal.SIGINT)  # type: ignore[arg-type]


def _said(status: int, message: str) -> int:
    if message:
        sys.stderr.write(f"{Path(sys.argv[0]).name}: {message}\n")
        sys.stderr.flush()
    return status
