"""``vgvt doctor``: is this machine fit for a virtual test?"""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from vgvt.cli.console import show
from vgvt.cli.cores import available_cores
from vgvt.cli.document import write_document
from vgvt.cli.options import JsonOption
from vgvt.cli.rendering import NONE, VARIABLE, advice, asked_for, back_end

if TYPE_CHECKING:
    from rich.text import Text

# In a process of its own: a machine without drivers can take the whole process down. No assert: python -O has none.
_RENDER = """
import mujoco
model = mujoco.MjModel.from_xml_string(
    '<mujoco><worldbody><light pos="0 0 2"/><geom type="sphere" size=".3"/></worldbody></mujoco>')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 48, 64)
renderer.update_scene(data)
if not renderer.render().std() > 0:
    raise SystemExit("the picture is blank")
"""
_STEP = """
import mujoco
model = mujoco.MjModel.from_xml_string(
    '<mujoco><worldbody><body><freejoint/><geom size=".1" mass="1"/></body></worldbody></mujoco>')
data = mujoco.MjData(model)
for _ in range(10):
    mujoco.mj_step(model, data)
if not data.qpos[2] < 0:
    raise SystemExit("a body does not fall")
"""


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the examination."""

    check: str
    status: Literal["ok", "warn", "fail"]
    detail: str
    advice: str = ""


def doctor(as_json: JsonOption = False) -> int:
    """Check versions, threads, physics, rendering, data, plugins and write permission.

    Exit status 1 when a check fails; a warning limits something but not the test.
    """
    findings = examine()
    if as_json:
        write_document(
            {
                "status": _worst(findings),
                "checks": [
                    {"check": f.check, "status": f.status, "detail": f.detail, "advice": f.advice} for f in findings
                ],
            }
        )
    else:
        for finding in findings:
            show(_line(finding))
    return 1 if _worst(findings) == "fail" else 0


def examine() -> list[Finding]:
    """Every check; one that breaks becomes a failed finding."""
    checks: tuple[Callable[[], list[Finding]], ...] = (
        _python,
        _packages,
        _threads,
        _physics,
        _rendering,
        _scenarios,
        _plugins,
        _measured_data,
        _write_permission,
    )
    findings: list[Finding] = []
    for check in checks:
        try:
            findings += check()
        except Exception as error:  # noqa: BLE001  a broken check is itself a finding
            name = check.__name__.strip("_").replace("_", " ")
            findings.append(Finding(name, "fail", f"{type(error).__name__}: {error}"))
    return findings


def _line(finding: Finding) -> Text:
    from rich.text import Text

    colour = {"ok": "green", "warn": "yellow", "fail": "red"}[finding.status]
    advice = f"\n     {finding.advice}" if finding.advice else ""
    return Text.assemble((f"{finding.status:<4}", colour), f" {finding.check}: {finding.detail}{advice}")


def _worst(findings: list[Finding]) -> Literal["ok", "warn", "fail"]:
    statuses = {finding.status for finding in findings}
    return "fail" if "fail" in statuses else "warn" if "warn" in statuses else "ok"


def _python() -> list[Finding]:
    return [Finding("python", "ok", f"{platform.python_version()} on {platform.platform()}")]


def _packages() -> list[Finding]:
    from importlib.metadata import PackageNotFoundError, requires, version

    from vgvt import __version__

    wanted = [text for text in requires("vgvt") or [] if "extra ==" not in text]
    names = [re.split(r"[^A-Za-z0-9._-]", text, maxsplit=1)[0] for text in wanted]
    found, missing = [], []
    for name in names:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            missing.append(name)
    if missing:
        return [Finding("packages", "fail", f"missing {', '.join(missing)}", "install vgvt again with pip")]
    return [Finding("packages", "ok", f"vgvt {__version__}, {', '.join(found)}")]


def _threads() -> list[Finding]:
    cores = available_cores()
    pins = {name: os.environ.get(name, "unset") for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    detail = f"{cores} cores; " + ", ".join(f"{name}={value}" for name, value in pins.items())
    if any(value != "1" for value in pins.values()):
        return [
            Finding(
                "threads", "warn", detail, "small linear algebra is fastest with one thread: export OMP_NUM_THREADS=1"
            )
        ]
    return [Finding("threads", "ok", detail)]


def _physics() -> list[Finding]:
    problem = _in_process(_STEP, {VARIABLE: NONE})
    if problem:
        return [Finding("physics", "fail", f"MuJoCo does not run: {problem}", "install mujoco again with pip")]
    return [Finding("physics", "ok", "MuJoCo steps a model")]


def _rendering() -> list[Finding]:
    chosen = back_end()
    name = f"{VARIABLE}={chosen}" if asked_for() else chosen or "OpenGL"
    problem = _in_process(_RENDER, {VARIABLE: chosen})
    if problem:
        only = "only pictures need it, and scripts that import mujoco"
        return [Finding("rendering", "warn", f"{name} does not render: {problem}", f"{only}; {advice()}")]
    return [Finding("rendering", "ok", f"{name} renders" + (" without a display" if "egl" in chosen else ""))]


def _in_process(code: str, environment: dict[str, str]) -> str:
    """The last line of what goes wrong when the code runs in a fresh interpreter; empty when all is well."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            timeout=60,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "no answer within 60 s"
    if done.returncode == 0:
        return ""
    return (done.stderr.strip().splitlines() or [f"ended with status {done.returncode}"])[-1]


def _scenarios() -> list[Finding]:
    from vgvt.scenario import bundled_scenarios, load_scenario

    names = bundled_scenarios()
    for name in names:
        load_scenario(name)
    if not names:
        return [Finding("scenarios", "fail", "none found", "install vgvt again with pip")]
    return [Finding("scenarios", "ok", ", ".join(names))]


def _plugins() -> list[Finding]:
    from vgvt.effects import available_effects
    from vgvt.identification import available_identifiers

    return [*_installed("identifiers", available_identifiers), *_installed("effects", available_effects)]


def _installed(kind: str, available: Callable[[], dict[str, type]]) -> list[Finding]:
    """What there is of a kind of plugin, those of other packages named after the bundled ones; whatever is left out."""
    import warnings

    from vgvt.data.plugin import is_bundled

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        names = [n for n, _ in sorted(available().items(), key=lambda item: not is_bundled(item[1].__module__))]
    findings = [Finding(kind, "warn", str(w.message), "update or remove that plugin") for w in caught]
    if not names:
        return [*findings, Finding(kind, "fail", "none installed", "install vgvt again with pip")]
    return [Finding(kind, "ok", ", ".join(names)), *findings]


def _measured_data() -> list[Finding]:
    from vgvt.cli.data import data_sets
    from vgvt.data import InputError
    from vgvt.files.locate import default_data_folder

    findings = []
    try:
        default_data_folder()
    except InputError as error:
        findings.append(Finding("data", "warn", f"{error.where}: {error.problem}", error.advice))
    for item in data_sets():
        if item["found"]:
            findings.append(Finding("data", "ok", f"{item['name']} in {item['folder']}"))
        elif item["can_be_fetched"]:
            advice = f"only real records need it: vgvt data get {item['name']}"
            findings.append(Finding("data", "warn", f"{item['name']} is not on this machine", advice))
    return findings


def _write_permission() -> list[Finding]:
    try:
        here = Path.cwd()
    except OSError as error:
        gone = f"the current folder {os.environ.get('PWD', '')}".rstrip() + f" cannot be used: {error.strerror}"
        return [Finding("writing", "warn", gone, "change to a folder that exists: cd FOLDER")]
    probe = here / f".vgvt-doctor-{os.getpid()}"
    try:
        probe.touch(exist_ok=False)
        probe.unlink()
    except OSError as error:
        return [Finding("writing", "warn", f"cannot write in {here}: {error.strerror}", "use --out FOLDER elsewhere")]
    return [Finding("writing", "ok", f"{here}")]
