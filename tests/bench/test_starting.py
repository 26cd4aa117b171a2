"""Starting contestants: a gate that forks them, an interpreter each where that cannot be; the same comes of both."""

from __future__ import annotations

import json
import os
import signal
import time
from pathlib import Path

import pytest

import vgvt.bench.starting as starting
from vgvt.bench.entry import Entry
from vgvt.bench.starting import Gate, GateLostError, OutOfTimeError, run_contestant
from vgvt.bench.umpire import anonymous, attempt
from vgvt.files.campaign_file import write_campaign
from vgvt.identification.contestant import CAMPAIGN, OUTCOME, REQUEST
from vgvt.identification.example import Example

pytestmark = pytest.mark.skipif(not starting.FORKS, reason="no process is forked here")


@pytest.fixture
def task(tmp_path):
    """Makes the folder of a contestant; the method, if given, is written beside it and found by its path."""

    def make(name: str = "quadrature", body: str | None = None) -> Path:
        folder = tmp_path / f"task-{len(list(tmp_path.iterdir()))}"
        folder.mkdir()
        write_campaign(folder / CAMPAIGN, anonymous(Example(noise_m_s2=0.02).campaign()))
        request = {"identifier": name, "settings": {}, "band_hz": None, "memory_mib": None, "time_s": 60.0}
        (folder / REQUEST).write_text(json.dumps(request))
        if body is not None:
            info = folder / f"{name}-1.dist-info"
            info.mkdir()
            (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
            (info / "entry_points.txt").write_text(f"[vgvt.identifiers]\n{name} = {name}_code:None\n")
            (folder / f"{name}_code.py").write_text(body)
        return folder

    return make


@pytest.fixture
def gate():
    return starting._gate()


def reason(folder: Path) -> str:
    return str(json.loads((folder / OUTCOME).read_text())["reason"])


def test_nothing_passes_from_one_contestant_to_the_next(gate, task, monkeypatch) -> None:
    spoiler = task("spoiler", "import numpy\nnumpy.fft.rfft = None\nopen('was-here', 'w').close()")
    monkeypatch.syspath_prepend(str(spoiler))
    assert gate.run(spoiler, 60) == 0
    assert (spoiler / "was-here").exists()
    monkeypatch.undo()
    honest = task()
    assert gate.run(honest, 60) == 0
    assert reason(honest) == ""


@pytest.mark.parametrize("how", ["gate", "interpreter"])
def test_a_contestant_has_one_blas_thread_where_nobody_said_so(task, monkeypatch, how: str) -> None:
    """Where the environment says nothing it would take all cores, of which another one measures its time."""
    body = (
        "import json, os, numpy, threadpoolctl\n"
        "threads = [library['num_threads'] for library in threadpoolctl.threadpool_info()]\n"
        "pins = {name: os.getenv(name) for name in os.environ if name.endswith('_THREADS')}\n"
        "with open('threads.json', 'w') as file: json.dump([threads, pins], file)"
    )
    folder = task("counter", body)
    monkeypatch.syspath_prepend(str(folder))
    pins = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
    for name in pins:
        monkeypatch.delenv(name, raising=False)
    if how == "gate":
        fresh = Gate()
        assert fresh.run(folder, 60) == 0
        fresh.close()
    else:
        assert starting._interpreter(folder, 60) == 0
    threads, found = json.loads((folder / "threads.json").read_text())
    assert threads and set(threads) == {1}
    assert {name: found.get(name) for name in pins} == dict.fromkeys(pins, "1")


@pytest.mark.slow
def test_a_contestant_that_does_not_end_is_killed_with_what_it_started(gate, task, monkeypatch) -> None:
    body = (
        "import os, signal, time\nsignal.setitimer(signal.ITIMER_REAL, 0)\n"
        "child = os.fork()\n"
        "open(f'process-{os.getpid()}', 'w').close()\n"
        "while True: time.sleep(1)"
    )
    folder = task("sleeper", body)
    monkeypatch.syspath_prepend(str(folder))
    first = task()
    assert gate.run(first, 60) == 0  # the gate has loaded its libraries: from here on the time is the contestant's
    with pytest.raises(OutOfTimeError):
        gate.run(folder, 8.0)
    started = [int(path.name.partition("-")[2]) for path in folder.glob("process-*")]
    assert len(started) == 2
    time.sleep(0.5)
    assert not [number for number in started if _runs(number)]


def _runs(process: int) -> bool:
    """Whether a process is there and not only waiting to be buried."""
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False


def test_a_lost_gate_costs_nothing_but_time(task, monkeypatch) -> None:
    lost = Gate()
    os.kill(lost._process.pid, signal.SIGKILL)
    monkeypatch.setattr(starting, "_gate", lambda: lost)
    folder = task()
    with pytest.raises(GateLostError):
        lost.run(folder, 60)
    assert run_contestant(folder, 60) == 0
    assert reason(folder) == ""


def test_a_gate_is_used_again_until_it_is_closed() -> None:
    first = starting._gate()
    assert starting._gate() is first
    first.close()
    assert starting._gate() is not first


def test_an_interpreter_of_its_own_comes_to_the_same_claim(monkeypatch) -> None:
    campaign = Example(noise_m_s2=0.02).campaign()
    forked = attempt(Entry("quadrature"), campaign)
    monkeypatch.setattr(starting, "FORKS", False)
    apart = attempt(Entry("quadrature"), campaign)
    assert forked.claim is not None and apart.claim is not None
    assert forked.claim.natural_frequency_hz.tobytes() == apart.claim.natural_frequency_hz.tobytes()
    assert forked.claim.shapes.tobytes() == apart.claim.shapes.tobytes()
