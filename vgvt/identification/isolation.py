"""Looks, in a process of its own, at which modules an identifier loads."""

from __future__ import annotations

import inspect
import json
import os
import subprocess
import sys
from pathlib import Path

FORBIDDEN = (
    "vgvt.simulation",
    "vgvt.effects",
    "vgvt.scenario",
    "vgvt.files.truth",
    "vgvt.reconcile",
    "vgvt_scoreboard",
    "mujoco",
)
"""Modules that know, make or judge the true modes."""

_PROBE = """
import importlib, importlib.util, json, operator, sys
module_name, qualified, path, forbidden = json.loads(sys.argv[1])
try:
    module = importlib.import_module(module_name)
except ImportError:
    spec = importlib.util.spec_from_file_location(module_name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[module_name] = module
    spec.loader.exec_module(module)
cls = operator.attrgetter(qualified)(module)
from vgvt.identification.example import Example
from vgvt.identification.protocol import Needs
from vgvt.identification.run import run_identifier
failure = None
try:
    identifier, example = cls(), Example(noise_m_s2=0.02)
    blind = Needs.OUTPUT_ONLY in identifier.needs
    run_identifier(identifier, example.ambient_campaign() if blind else example.campaign())
except Exception as error:
    failure = repr(error)
seen = [m for m in sys.modules if any(m == f or m.startswith(f + ".") for f in forbidden)]
print(json.dumps({"seen": seen, "failure": failure}))
"""


def forbidden_imports(cls: type, timeout_s: float = 120.0) -> tuple[str, ...]:
    """Forbidden modules that importing ``cls`` and one identification with default settings load.

    RuntimeError when the class cannot be imported in a fresh process, such as
    one that is defined inside a function, and when that identification fails, as what it would have loaded
    further on is not known then.
    """
    if "<locals>" in cls.__qualname__:
        raise RuntimeError(f"{cls.__qualname__} is defined inside a function; move it to the top of a module")
    probe = json.dumps([cls.__module__, cls.__qualname__, str(Path(inspect.getfile(cls)).resolve()), FORBIDDEN])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, "-c", _PROBE, probe],
        capture_output=True,
        text=True,
        env=environment,
        timeout=timeout_s,
        check=False,
    )
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise RuntimeError(f"{cls.__module__}.{cls.__qualname__} cannot be imported in a process of its own: {last}")
    found = json.loads(done.stdout.strip().splitlines()[-1])
    if found["failure"] and not found["seen"]:
        raise RuntimeError(f"{cls.__module__}.{cls.__qualname__} fails in a process of its own: {found['failure']}")
    return tuple(found["seen"])
