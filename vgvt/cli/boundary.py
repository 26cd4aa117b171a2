"""Where a command meets the shell: exit statuses, error messages and the error object of --json."""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

import typer

from vgvt.cli import interruption
from vgvt.cli.console import log
from vgvt.cli.document import write_document
from vgvt.cli.letters import PLAIN

_FULL_DISK_ADVICE = "make room, or write to another disk"
_LARGE_FILE_ADVICE = "raise the limit ('ulimit -f' shows it), or write to a file system that holds larger ones"

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class CommandError(Exception):
    """A command that could not do its work although its input was good; exit status 1."""

    def __init__(self, problem: str, advice: str = "") -> None:
        self.problem = problem
        self.advice = advice
        super().__init__(problem + (f"\n  {advice}" if advice else ""))


def run_command(arguments: Sequence[str]) -> int:
    """Run one command line; returns the exit status and never raises for an expected failure.

    With ``--json`` among the arguments an error becomes the one object on
    stdout, {"error": {"kind", "message", ...}}; the message goes to stderr as well.
    VGVT_TRACEBACK=1 lets an unexpected exception through.
    """
    arguments = [_at_home(word) for word in arguments]
    as_json = "--json" in arguments
    _somewhere_to_write()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=PLAIN)
    try:
        with warnings.catch_warnings(), _signals():
            warnings.showwarning = _log_warning
            status = _dispatch(arguments)
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except Exception as error:  # noqa: BLE001  the last line of defence: a message instead of a traceback
        if _is_usage_error(error):
            return _report(BAD_INPUT, "usage", _usage_message(error, arguments), as_json)
        return _explain(error, as_json)
    if status == INTERRUPTED:
        return _report(INTERRUPTED, "interrupted", "interrupted", as_json)
    return status


def _at_home(word: str) -> str:
    """A word with the home folder in place of ``~``: no shell does it behind ``--out=``, and the netCDF library would.

    So would people who write ``--out "~/runs"``; a folder of that name is ``./~``.
    """
    option, sign, path = word.partition("=")
    if option.startswith("--") and sign:
        return f"{option}={_at_home(path)}" if path.startswith("~") else word
    if not word.startswith("~"):
        return word
    try:
        return str(Path(word).expanduser())
    except RuntimeError:  # nobody of that name, or without a home
        return word


def _somewhere_to_write() -> None:
    """A closed stream, which a daemon may leave, takes what nobody reads."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115  as long as the process lives


@contextmanager
def _signals() -> Iterator[None]:
    """Ctrl-C also where a script's background job would ignore it; a polite kill cleans up like Ctrl-C."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _: FrameType | None) -> NoReturn:
        raise SystemExit(128 + number)

    interruption.forget()
    before = {
        signal.SIGINT: signal.signal(signal.SIGINT, interruption.on_signal),
        signal.SIGTERM: signal.signal(signal.SIGTERM, leave),
    }
    # A terminal that is closed; who asked for nohup goes on.
    hung_up = getattr(signal, "SIGHUP", None)
    if hung_up is not None and signal.getsignal(hung_up) == signal.SIG_DFL:
        before[hung_up] = signal.signal(hung_up, leave)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _dispatch(arguments: Sequence[str]) -> int:
    from vgvt.cli.app import app

    command = typer.main.get_command(app)
    status: Any = command.main(args=list(arguments), prog_name="vgvt", standalone_mode=False)
    return status if isinstance(status, int) else DONE


def _explain(error: Exception, as_json: bool) -> int:
    from vgvt.data import InputError, PluginError  # here, because it brings numpy and --help is to be quick

    if isinstance(error, InputError):
        details = {"where": error.where, "problem": error.problem, "advice": error.advice}
        return _report(BAD_INPUT, "input", str(error), as_json, details)
    if isinstance(error, CommandError):
        details = {"problem": error.problem, "advice": error.advice}
        return _report(FAILED, "failure", str(error), as_json, details)
    if isinstance(error, OSError) and error.errno == errno.EPIPE:
        # The interpreter flushes stdout once more on exit; give it somewhere to go.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
        # Of stdout, which may be a file on a full disk as well, no name is known.
        advice = _FULL_DISK_ADVICE + (" with --out" if error.filename else "")
        return _explain(CommandError(f"the disk is full: {error.strerror}", advice), as_json)
    if isinstance(error, OSError) and error.errno == errno.EFBIG:
        return _explain(CommandError(f"a file would be too large: {error.strerror}", _LARGE_FILE_ADVICE), as_json)
    if os.environ.get("VGVT_TRACEBACK"):
        raise error
    first_line = (str(error).strip().splitlines() or [""])[0]
    what = first_line if isinstance(error, PluginError) else f"failed: {type(error).__name__}: {first_line}"
    return _report(FAILED, "failure", f"{what} (run with VGVT_TRACEBACK=1 to see where)", as_json)


def _report(status: int, kind: str, message: str, as_json: bool, details: dict[str, str] | None = None) -> int:
    log(f"vgvt: {message}")
    if as_json:
        # Where the message is that stdout takes nothing, there is nowhere to say so.
        with suppress(OSError):
            write_document({"error": {"kind": kind, "exit_status": status, "message": message, **(details or {})}})
    return status


def _is_usage_error(error: Exception) -> bool:
    # Typer carries its own copy of click or uses the installed one, by version: known by what it can do.
    return hasattr(error, "format_message") and hasattr(error, "exit_code")


def _usage_message(error: Any, arguments: Sequence[str]) -> str:
    context = getattr(error, "ctx", None)
    # The parser knows of no command where it misses the values of an option.
    path = context.command_path if context is not None else _command_path(arguments)
    return f"{error.format_message()}\n  '{path} --help' shows what can be written"


def _command_path(arguments: Sequence[str]) -> str:
    """``vgvt data get``: the words of a command line that name a command."""
    from vgvt.cli.app import app

    command: Any = typer.main.get_command(app)
    path = "vgvt"
    for word in arguments:
        inner = getattr(command, "commands", {})
        if word in inner:
            command, path = inner[word], f"{path} {word}"
        elif not word.startswith("-"):
            break
    return path


def _log_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    log(f"vgvt: warning: {message}")
