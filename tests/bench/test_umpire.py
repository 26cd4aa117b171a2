"""The umpire's blindness and limits, against identifiers that try it on."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from vgvt.bench.entry import Entry
from vgvt.bench.umpire import Limits, anonymous, attempt, handed_out
from vgvt.data import InputError
from vgvt.identification.contestant import _limit_memory
from vgvt.identification.example import Example
from vgvt.identification.watch import Watch

_STEM = """
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from vgvt.data import ModalModel, Outcome
from vgvt.identification import Needs

@dataclass(frozen=True)
class Contestant:
    name: ClassVar[str] = "{name}"
    summary: ClassVar[str] = "tries it on"
    citation: ClassVar[str] = "@misc{{none, title = {{None}}}}"
    needs: ClassVar[Needs] = Needs.FRFS

    def identify(self, campaign, band_hz):
{body}
        if {always}:
            dofs = (campaign.runs[0].channels[-1].dof,)
            return ModalModel(np.array([6.3]), np.array([0.01]), np.ones((1, 1), complex), dofs)
        return ModalModel.empty(Outcome.NOTHING_FOUND, ("nothing",))
"""


@pytest.fixture
def enter(tmp_path, monkeypatch):
    """Installs a method with a body as a distribution of its own, and lets it compete."""

    def compete(body: str, limits: Limits | None = None, name: str = "contestant", always: bool = True):
        site = tmp_path / "site"
        info = site / f"{name}-1.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
        (info / "entry_points.txt").write_text(f"[vgvt.identifiers]\n{name} = {name}_module:Contestant\n")
        source = _STEM.format(name=name, body=textwrap.indent(textwrap.dedent(body), " " * 8), always=always)
        (site / f"{name}_module.py").write_text(source)
        monkeypatch.syspath_prepend(str(site))
        return attempt(Entry(name), Example(noise_m_s2=0.02).campaign(), None, limits or Limits())

    return compete


def test_an_honest_method_comes_to_its_claim(enter) -> None:
    tried = enter("pass")
    assert tried.reason == ""
    assert tried.claim is not None
    assert tried.claim.natural_frequency_hz.tolist() == [6.3]
    assert tried.wall_s is not None and tried.wall_s > 0
    assert tried.peak_memory_mib is not None and tried.peak_memory_mib > 10


@pytest.mark.parametrize(
    ("body", "what"),
    [
        ("import vgvt.simulation", "imports vgvt.simulation"),
        pytest.param("import vgvt_scoreboard", "imports vgvt_scoreboard", marks=pytest.mark.slow),
        ("from vgvt.scenario import load_scenario; load_scenario('quick')", "imports vgvt.scenario"),
        pytest.param("try:\n    import mujoco\nexcept Exception:\n    pass", "imports mujoco", marks=pytest.mark.slow),
        pytest.param("import vgvt.files.truth", "imports vgvt.files.truth", marks=pytest.mark.slow),
        ("from vgvt.files.netcdf import read_group\nfrom pathlib import Path\nread_group(Path('{sealed}'))", "reads"),
        ("open('{sealed}', 'rb').read()", "sealed"),
        ("import h5py\nh5py.File('{sealed}')", "sealed"),
        ("open('{scenario}').read()", "reads"),
        ("import subprocess, sys\nsubprocess.run([sys.executable, '-c', 'pass'])", "starts another process"),
        (
            "import socket\ntry:\n    socket.create_connection(('127.0.0.1', 9), 0.2)\nexcept OSError:\n    pass",
            "network",
        ),
    ],
)
def test_a_cheat_is_a_reason_and_no_claim(enter, tmp_path, body: str, what: str) -> None:
    import h5py

    (tmp_path / "runs" / "sealed").mkdir(parents=True)
    with h5py.File(tmp_path / "runs" / "sealed" / "truth.nc", "w") as file:
        file["natural_frequency_hz"] = [6.3]
    (tmp_path / "mine.toml").write_text("seed = 1\n")
    tried = enter(body.format(sealed=tmp_path / "runs" / "sealed" / "truth.nc", scenario=tmp_path / "mine.toml"))
    assert tried.claim is None
    assert tried.reason.startswith("cheated: ")
    assert what in tried.reason


def test_a_cheat_that_hides_in_its_import_is_caught_too(enter) -> None:
    tried = enter("pass\nimport vgvt.effects.registry")
    assert "imports vgvt.effects" in tried.reason


def test_the_list_of_fonts_is_no_secret(enter, tmp_path: Path) -> None:
    """A library that imports matplotlib reads it from the user's cache."""
    (tmp_path / "matplotlib").mkdir()
    listed = tmp_path / "matplotlib" / "fontlist-v3.json"
    listed.write_text("{}")
    assert enter(f"open({str(listed)!r}).close()").reason == ""


def test_python_may_keep_what_it_has_compiled(tmp_path: Path) -> None:
    """A method's first import writes beside it, unless the environment says that nothing is to be kept."""
    (tmp_path / "fresh_method.py").write_text("FOUND = 6.3\n")
    code = "w = Watch(()); w.start(); import fresh_method; print(w.misdeeds)"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHONDONTWRITE")}
    command = [sys.executable, "-c", f"from vgvt.identification.watch import Watch; {code}"]
    done = subprocess.run(
        command, env=environment, cwd=tmp_path, check=True, capture_output=True, text=True, timeout=60
    )
    assert done.stdout.strip() == "[]"
    assert list((tmp_path / "__pycache__").glob("fresh_method.*.pyc"))


@pytest.mark.parametrize(
    ("name", "honest"),
    [
        ("m.cpython-311.pyc.140", True),
        ("m._db-14.py311.nbi", True),
        ("m._db-14.py311.1.nbc", True),
        ("m._db-14.py311.nbi.tmp.7373a", True),
        ("m.pyc.txt", False),
        ("nbi.tmp", False),
        ("claim.csv", False),
    ],
)
def test_what_compilers_keep_is_code(tmp_path: Path, name: str, honest: bool) -> None:
    """numba keeps what it has compiled beside the method, if that asks for it."""
    watch = Watch(())
    watch._look(tmp_path / "__pycache__" / name)
    assert (watch.misdeeds == []) is honest


def test_no_limit_is_raised_that_the_shell_has_set(monkeypatch: pytest.MonkeyPatch) -> None:
    """A batch system's had kept every contestant from starting."""
    resource = pytest.importorskip("resource")
    limits, asked = [(3 << 30, resource.RLIM_INFINITY), (3 << 30, 4 << 30), (resource.RLIM_INFINITY, 3 << 30)], []
    monkeypatch.setattr(resource, "setrlimit", lambda what, pair: asked.append(pair))
    for already in limits:
        monkeypatch.setattr(resource, "getrlimit", lambda what, already=already: already)
        told_mib = _limit_memory(1 << 20)
        assert asked[-1] == (3 << 30, 3 << 30)
        assert 0 < told_mib < 3 << 10
    monkeypatch.setattr(resource, "getrlimit", lambda what: (resource.RLIM_INFINITY,) * 2)
    assert _limit_memory(64.0) == 64.0


def test_the_name_and_notes_of_a_campaign_tell_nothing(enter) -> None:
    tried = enter("if campaign.name != 'campaign' or campaign.notes:\n    raise RuntimeError(campaign.name)")
    assert tried.reason == ""
    assert anonymous(Example().campaign()).notes == {}


def test_a_crash_is_a_reason(enter) -> None:
    assert enter("raise ZeroDivisionError('oh')").reason == "crashed: ZeroDivisionError: oh"


def test_a_death_is_a_reason(enter) -> None:
    assert enter("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)").reason == "killed by SIGSEGV"


def test_a_silent_exit_is_a_reason(enter) -> None:
    assert "status 3" in enter("import os\nos._exit(3)").reason


def test_a_hang_ends_at_the_time_limit(enter) -> None:
    assert enter("import time\ntime.sleep(60)", Limits(time_s=0.5)).reason == "took more than 0.5 s"


def test_a_hang_in_a_loop_that_catches_everything_ends_too(enter) -> None:
    body = "import time\nwhile True:\n    try:\n        time.sleep(1)\n    except BaseException:\n        pass"
    assert enter(body, Limits(time_s=0.5)).reason == "took more than 0.5 s"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the system cannot limit a process's memory")
def test_too_much_memory_is_a_reason(enter) -> None:
    assert "100 MiB" in enter("np.ones(10**9)", Limits(memory_mib=100)).reason


def test_a_broken_contract_is_a_reason(enter) -> None:
    assert enter("return 7").reason.startswith("broke its contract")


def test_no_claim_with_advice_is_a_claim_of_nothing(enter) -> None:
    tried = enter("pass", always=False)
    assert tried.claim is not None
    assert len(tried.claim) == 0


def test_an_entry_is_written_as_it_is_read() -> None:
    entry = Entry.parse("era:order=12,arrangement=siso")
    assert entry == Entry("era", (("arrangement", "siso"), ("order", "12")))
    assert Entry.parse(entry.label) == entry
    with pytest.raises(InputError, match="not a setting"):
        Entry.parse("era:order")


def test_what_a_contestant_does_to_its_campaign_does_not_reach_the_next(enter) -> None:
    """Both read the same records, though the first one wrote over its copy of them."""
    campaign = Example(noise_m_s2=0.02).campaign()
    enter("from pathlib import Path; Path('campaign.nc').write_bytes(b'gone')")
    with handed_out(campaign) as file:
        before = file.read_bytes()
        vandal = attempt(Entry("contestant"), file)
        assert file.read_bytes() == before
        honest = attempt(Entry("quadrature"), file)
    assert vandal.claim is not None
    assert honest.reason == ""
    assert honest.claim is not None and len(honest.claim)
    assert not file.exists()
