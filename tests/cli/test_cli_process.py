"""The command line as a process: speed of --help, Ctrl-C, a closed pipe, threads, terminals."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vgvt.cli import interruption
from vgvt.cli.console import progress

VGVT = (sys.executable, "-m", "vgvt")


@pytest.mark.parametrize("arguments", [("--help",), ("identify", "--help"), ("list", "--help")], ids=" ".join)
def test_help_loads_nothing_heavy(arguments: tuple[str, ...]) -> None:
    """What it takes to answer at once; the time itself is a benchmark's business, tests/benchmarks."""
    code = (
        "import sys, contextlib\n"
        "from vgvt.cli import main\n"
        f"sys.argv[1:] = {list(arguments)!r}\n"
        "with contextlib.suppress(SystemExit):\n    main()\n"
        "heavy = {'mujoco', 'scipy', 'xarray', 'h5py', 'pandas', 'duckdb', 'matplotlib', 'plotly', 'control'}\n"
        "print(sorted(heavy & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60)
    assert "Usage" in done.stdout
    assert done.stderr.strip().splitlines()[-1] == "[]"


def interrupted(folder: Path, number: signal.Signals, seen: str, nohup: bool = False) -> tuple[int, str, str, float]:
    """Start a long run, signal it once ``seen`` is on stderr; exit status, streams, seconds until the end.

    ``nohup``: as that command starts it, and its terminal is closed three lines of progress before the signal.
    """
    environment = {**os.environ, "VGVT_TRACEBACK": ""}
    # A child inherits whether it is to ignore a hang-up: from nohup, which these tests may be run by, too.
    hang_up = signal.SIG_IGN if nohup else signal.SIG_DFL
    process = subprocess.Popen(
        [*VGVT, "run", "hati-unsymmetric", "--json", "--out", str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, hang_up) and None,
    )
    try:
        assert process.stderr is not None
        said = ""
        while seen not in said:
            line = process.stderr.readline()
            assert line, f"ended early: {said}"
            said += line
        if nohup:
            process.send_signal(signal.SIGHUP)
            goes_on = [process.stderr.readline() for _ in range(3)]
            assert all(seen in line for line in goes_on), goes_on
        begin = time.perf_counter()
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    return process.returncode, out, said + err, time.perf_counter() - begin


@pytest.mark.slow
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_a_signal_in_a_long_run(tmp_path: Path, number: signal.Signals, status: int) -> None:
    folder = tmp_path / "long"
    returned, out, err, seconds = interrupted(folder, number, "s left")
    assert returned == status
    assert "Traceback" not in err
    assert "nothing was kept" in err
    assert seconds < 20
    assert list(tmp_path.iterdir()) == []
    if number is signal.SIGINT:
        assert json.loads(out)["error"]["kind"] == "interrupted"


@pytest.mark.slow
def test_a_run_under_nohup_goes_on_when_its_terminal_is_closed(tmp_path: Path) -> None:
    returned, _, err, _ = interrupted(tmp_path / "long", signal.SIGTERM, "s left", nohup=True)
    assert returned == 143, err


def test_ctrl_c_right_after_the_start(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*VGVT, "run", "hati-unsymmetric", "--out", str(tmp_path / "long")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "long").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    try:
        _, err = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_that_a_library_swallows_comes_again_with_the_next_progress() -> None:
    interruption.forget()
    try:
        with progress("work") as report:
            report(0.1, "going")
            with contextlib.suppress(KeyboardInterrupt):
                interruption.on_signal(signal.SIGINT, None)
            with pytest.raises(KeyboardInterrupt):
                report(0.2, "still going")
    finally:
        interruption.forget()


def test_a_closed_pipe_is_quiet() -> None:
    process = subprocess.Popen([*VGVT, "schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(timeout=60) == 1


def test_one_thread_unless_told_otherwise() -> None:
    code = "import os; from vgvt.cli import main; main(['--version']); print(os.environ['OPENBLAS_NUM_THREADS'])"
    clean = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    for environment, threads in ((clean, "1"), ({**clean, "OPENBLAS_NUM_THREADS": "2"}, "2")):
        done = subprocess.run(
            [sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True, timeout=60
        )
        assert done.stdout.split()[-1] == threads


def test_output_survives_a_terminal_without_unicode() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "LC_ALL": "C"}
    done = subprocess.run([*VGVT, "list", "scenarios"], env=environment, capture_output=True, timeout=60, check=False)
    assert done.returncode == 0
    assert b"quick" in done.stdout


@pytest.mark.parametrize(
    ("encoding", "expected"), [("ascii", b"dzeta ? 5+-1 nu-gap"), ("cp1252", b"dzeta ? 5\xb11 nu-gap")]
)
def test_letters_that_a_terminal_lacks_have_names(encoding: str, expected: bytes) -> None:
    code = (
        "from vgvt.cli import boundary\n"
        "from vgvt.cli.console import show\n"
        "boundary._dispatch = lambda arguments: show('Δζ 飛 5±1 ν-gap')\n"
        "boundary.run_command([])\n"
    )
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, timeout=60, check=True)
    assert done.stdout.strip() == expected


def test_a_terminal_gets_a_bar_with_the_time_left() -> None:
    code = (
        "from vgvt.cli.console import progress\n"
        "with progress('simulate') as report:\n"
        "    report(0.25, 'quarter'); import time; time.sleep(0.3); report(0.5, 'half'); time.sleep(0.3)\n"
    )
    main, worker = pty.openpty()
    done = subprocess.run([sys.executable, "-c", code], stderr=worker, stdout=subprocess.PIPE, check=True, timeout=60)
    os.close(worker)
    text = b""
    try:
        while block := os.read(main, 65536):
            text += block
    except OSError:  # the kernel's way of saying that the other end is closed
        pass
    os.close(main)
    assert b"50 %" in text
    assert b"left" in text
    assert done.stdout == b""


def test_no_terminal_gets_a_line_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from vgvt.cli import console

    clock = iter([0.0, 1.0, 11.0, 12.0, 30.0])
    monkeypatch.setattr(console.time, "monotonic", lambda: next(clock))
    with console.progress("simulate") as report:
        for fraction in (0.05, 0.25, 0.3, 0.6):
            report(fraction, "stepping")
    assert capsys.readouterr().err.splitlines() == [
        "simulate: stepping 25 %, 33 s left",
        "simulate: stepping 60 %, 20 s left",
    ]
