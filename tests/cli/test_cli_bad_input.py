"""Bad input: exit status 2, and a message that names the file, the place and what to do."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

SIDECAR = """
name = "mine"
summary = "Two runs of my own"
band_hz = [1.0, 40.0]

[records]
format = "mat"
sample_rate_hz = 200.0
samples = "signal"

[nodes]
node = [1, 2, 100]
x = [0.0, 0.5, 0.6]
y = [1.0, 1.0, 0.1]

[[channel]]
name = "force"
column = 1
quantity = "force"
role = "reference"
unit = "N"
dof = "100+Z"

[[channel]]
name = "accelerometer"
column = 2
quantity = "acceleration"
role = "response"
sensitivity = "100 mV/g"
direction = "+Z"
"""


def edited(old: str, new: str) -> str:
    """The quick scenario as TOML, with one thing wrong."""
    from vgvt.scenario import load_scenario, to_toml

    text = to_toml(load_scenario("quick"))
    assert re.search(old, text, flags=re.MULTILINE), f"{old} is not in the scenario"
    return re.sub(old, new, text, count=1, flags=re.MULTILINE)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        pytest.param(r"^amplitude_v =", "amplitud_v =", ("amplitud_v", "amplitude_v", "excitation"), id="unknown key"),
        pytest.param(
            r"^stiffness_n_per_m = .*", "stiffness_n_per_m = -130.0", ("suspension.stiffness_n_per_m",), id="stiffness"
        ),
        pytest.param(
            r"(?s)(\[accelerometers\.grid\].*?^x_m = \[\s*)[-\d.]+", r"\g<1>9.5", ("grid", "x_m"), id="off the aircraft"
        ),
        pytest.param(r"^name = ", "name = = ", ("line 3",), id="not TOML"),
        pytest.param(r"^sample_rate_hz = .*", "sample_rate_hz = 50.0", ("sample_rate_hz",), id="rate too low"),
    ],
)
def test_a_wrong_scenario(vgvt, simulations, old: str, new: str, words: tuple[str, ...]) -> None:
    Path("mine.toml").write_text(edited(old, new))
    result = vgvt("run", "mine.toml", "--json")
    assert result.status == 2
    message = result.document["error"]["message"]
    assert "mine.toml" in message
    assert message in result.err
    for word in words if "line" not in words[0] else ("line",):
        assert word in message
    assert simulations == []
    assert not Path("runs").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "mine.toml"),
        ("run", "quik"),
        ("simulate", "mine.toml"),
        ("inspect", "absent.nc"),
        ("identify", "absent.nc"),
        ("identify", "hati"),
        ("score", "absent.json", "absent.nc"),
        ("score", "."),
        ("cite", "quadratur"),
        ("data", "get", "hati"),
    ],
    ids=" ".join,
)
def test_what_is_not_there(vgvt, arguments: tuple[str, ...]) -> None:
    result = vgvt(*arguments, "--json")
    assert result.status == 2
    error = result.document["error"]
    assert error["kind"] == "input"
    assert arguments[-2 if arguments[0] == "score" and len(arguments) > 2 else -1] in error["where"]
    assert error["advice"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("fly",),
        ("run",),
        ("run", "quick", "--sed", "3"),
        ("run", "quick", "--seed", "-1"),
        ("run", "quick", "--seed", "one"),
        ("run", "quick", "--band", "3"),
        ("list",),
        ("list", "aircraft"),
        ("data",),
    ],
    ids=" ".join,
)
def test_usage(vgvt, arguments: tuple[str, ...]) -> None:
    assert vgvt(*arguments).status == 2
    result = vgvt(*arguments, "--json")
    assert result.status == 2
    assert result.document["error"]["kind"] == "usage"


@pytest.mark.parametrize(
    ("arguments", "path"),
    [
        (("identify", "x.nc", "--band", "3"), "vgvt identify"),
        (("identify", "x.nc", "--bnd", "3"), "vgvt identify"),
        (("data", "describe", "x.uff", "--axes", "x"), "vgvt data describe"),
        (("fly",), "vgvt"),
    ],
    ids=lambda words: words if isinstance(words, str) else " ".join(words),
)
def test_usage_names_the_help_of_the_command(vgvt, arguments: tuple[str, ...], path: str) -> None:
    assert f"'{path} --help' shows" in vgvt(*arguments).err


def test_a_claim_that_is_not_there_is_said_before_its_truth(vgvt) -> None:
    result = vgvt("score", "nosuch.json")
    assert result.status == 2
    assert "nosuch.json: there is no such file" in result.err
    assert "truth" not in result.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--identifier", "quadratur"), "quadrature"),
        (("--setting", "order"), "key=value"),
        (("--setting", "no_such_setting=1"), "no_such_setting"),
        (("--band", "20", "10"), "20"),
        (("--band", "-5", "10"), "-5"),
        (("--band", "5", "1e9"), "half the sample rate"),
        (("--band", "nan", "10"), "nan"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_a_wrong_option(vgvt, campaign_file: Path, options: tuple[str, ...], words: str) -> None:
    result = vgvt("identify", campaign_file, *options, "--json")
    assert result.status == 2
    assert words in result.document["error"]["message"]


def test_a_wrong_engine(vgvt, simulations) -> None:
    result = vgvt("run", "quick", "--engine", "bullet", "--json")
    assert result.status == 2
    assert "mujoco" in result.document["error"]["advice"]


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip_some_bytes(path: Path) -> None:
    """A sector of a disk: one byte may lie in a gap of the file that nobody reads."""
    data = bytearray(path.read_bytes())
    middle = slice(len(data) // 2, len(data) // 2 + 512)
    data[middle] = bytes(b ^ 0xFF for b in data[middle])
    path.write_bytes(bytes(data))


def empty(path: Path) -> None:
    path.write_bytes(b"")


@pytest.mark.parametrize("damage", [truncate, flip_some_bytes, empty])
def test_a_damaged_campaign_or_truth(vgvt, simulations, damage: Callable[[Path], None]) -> None:
    vgvt("simulate", "quick", "--out", "here")
    vgvt("identify", "here", "--out", "claim.json")
    for path, arguments in (
        (Path("here/campaign.nc"), ("identify", "here/campaign.nc")),
        (Path("here/sealed/truth.nc"), ("score", "claim.json", "here/sealed/truth.nc")),
    ):
        damage(path)
        result = vgvt(*arguments, "--json")
        assert result.status == 2
        assert path.name in result.document["error"]["message"]


def write_records(run: int = 1, samples: int = 4000, seed: int = 3, **changes: float) -> None:
    """Two channels of noise as MAT records, some with a fault, and their description."""
    generator = np.random.default_rng(seed)
    lines = [SIDECAR]
    for k in (1, 2):
        signal = generator.standard_normal((samples if k == run else 4000, 2))
        if k == run and "bad" in changes:
            signal[1234, 1] = changes["bad"]
        savemat(f"run{k}.mat", {"signal": signal})
        lines.append(f'\n[[run]]\nrun = {k}\nfile = "run{k}.mat"\nnodes = {{ accelerometer = {k} }}\n')
        if k == run and "rate" in changes:
            lines.append(f"sample_rate_hz = {changes['rate']}\n")
    Path("mine.toml").write_text("".join(lines))


def test_good_records_are_read(vgvt) -> None:
    write_records()
    document = vgvt("inspect", "mine.toml", "--json").document
    assert [run["samples"] for run in document["runs"]] == [4000, 4000]


@pytest.mark.parametrize(
    ("prepare", "words"),
    [
        pytest.param(
            lambda: write_records(run=2, bad=np.nan), ("mine.toml, run 2, channel accelerometer", "6.17 s"), id="NaN"
        ),
        pytest.param(lambda: write_records(run=1, bad=np.inf), ("mine.toml, run 1, channel accelerometer",), id="inf"),
        pytest.param(lambda: write_records(run=1, samples=0), ("run1.mat",), id="no samples"),
        pytest.param(
            lambda: write_records(run=2, rate=100.0), ("mine.toml, run 2", "100 Hz", "200 Hz"), id="two rates"
        ),
        pytest.param(lambda: (write_records(), truncate(Path("run1.mat"))), ("run1.mat",), id="truncated MAT"),
        pytest.param(lambda: (write_records(), Path("run1.mat").unlink()), ("run1.mat",), id="missing MAT"),
    ],
)
def test_bad_records(vgvt, prepare: Callable[[], object], words: tuple[str, ...]) -> None:
    prepare()
    result = vgvt("identify", "mine.toml", "--json")
    assert result.status == 2
    message = result.document["error"]["message"]
    for word in words:
        assert word in message
    assert result.document["error"]["advice"]


def test_the_rest_of_bad_records_can_be_used(vgvt) -> None:
    write_records(run=2, bad=np.nan)
    assert vgvt("inspect", "mine.toml", "--json").document["runs"][1]["channels"][1]["fault"]
    result = vgvt("identify", "mine.toml", "--leave-out-faulty", "--json")
    assert result.status == 0
    assert "run 2: accelerometer left out, 1 of 4000 samples are not finite" in result.err
    assert "run 2 left out" in result.err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.pop("modes"), "modes"),
        (lambda d: d.pop("band_hz"), "band_hz"),
        (lambda d: d.update(band_hz=[9, 3]), "band_hz"),
        (lambda d: d.update(outcome="splendid"), "splendid"),
        (lambda d: d["modes"][0].pop("frequency_hz"), "modes[0].frequency_hz"),
        (lambda d: d["modes"][1].update(frequency_hz="fast"), "modes[1].frequency_hz"),
        (lambda d: d["modes"][1].update(frequency_hz=None), "modes[1].frequency_hz"),
        (lambda d: d["modes"][0]["shape"][2].update(dof="up"), "modes[0].shape[2].dof"),
        (lambda d: d["modes"][0]["shape"].pop(), "modes[1].shape"),
        (lambda d: d["modes"].reverse(), "order"),
        (lambda d: d.update(modes={}), "modes"),
    ],
)
def test_a_wrong_claim(vgvt, campaign_file: Path, change: Callable[[dict], object], words: str) -> None:
    document = vgvt("identify", campaign_file, "--out", "claim.json", "--json").document
    change(document)
    Path("claim.json").write_text(json.dumps(document))
    result = vgvt("score", "claim.json", campaign_file, "--json")
    assert result.status == 2
    assert "claim.json" in result.document["error"]["message"]
    assert words in result.document["error"]["message"]


@pytest.mark.parametrize("text", ["", "[1, 2]", "{", '"modes"', "\x00\xff"])
def test_a_claim_that_is_no_claim(vgvt, campaign_file: Path, text: str) -> None:
    Path("claim.json").write_text(text, encoding="latin-1")
    result = vgvt("score", "claim.json", campaign_file, "--json")
    assert result.status == 2
    assert "claim.json" in result.document["error"]["where"]


def test_a_campaign_is_no_truth(vgvt, campaign_file: Path) -> None:
    vgvt("identify", campaign_file, "--out", "claim.json")
    result = vgvt("score", "claim.json", campaign_file, "--json")
    assert result.status == 2
    assert "plate.nc" in result.document["error"]["message"]
