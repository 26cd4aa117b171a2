"""Write the effect catalogue from the registry: ``python docs/make_effects_page.py``."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.command_line import BEGIN_AGAIN, parser_of, worked_off

from vgvt.effects import Family, available_effects, parameters_of
from vgvt.files.atomically import replacing

PAGE = Path(__file__).parent / "reference" / "effects.md"

_HEAD = """# The effects

Written by `python docs/make_effects_page.py` from the installed effects; edit the effect's file, not this page.

An effect is a departure from the ideal test. A scenario switches one on with an `[[effect]]` table that gives its name
and the parameters that differ from their defaults:

```toml
[[effect]]
name = "local-absorber"
mass_kg = 0.08
frequency_hz = 14.0
```

All effects are at work together: an aircraft does not know in which order its tables stand. What gives between a
shaker and the aircraft is in series; what is said of one root joint adds (cubic stiffness, friction, gaps), and effects
that would give a rigid root different stiffness are refused. Only what changes one channel's samples in time follows
the order of the tables (interference and hum among themselves, and lost samples, which come after), and so do exchanges
of sensors that share a node. At its neutral value a parameter switches the effect off. The plausible
range is for an aircraft of some kilograms and three metres of span, with the
source of the numbers, or *guess*. `vgvt list effects` prints the same catalogue, with `--json` for programs, and
installed plugins beside it. Each effect has a small scenario that shows it, `spoiled-NAME`: see [the
scenarios](../../scenarios/README.md).

To [add an effect](../how-to/add-an-effect.md), write one file like those in `vgvt/effects/`, give it an entry point
in the group `vgvt.effects`, and let it pass the conformance suite:

```text
import pytest
from my_effect import MyEffect
from vgvt.simulation.effect_conformance import checks

@pytest.mark.parametrize("check", checks(), ids=str)
def test_conformance(check):
    check(MyEffect)
```
"""

_ELSEWHERE = (
    (
        "armature mass, flexure, back-EMF, current or voltage drive: the force drops out at resonance",
        "`[shaker]`",
        "every shaker has them; `drive` says what the amplifier holds",
    ),
    (
        "axial stiffness and mass of the stinger",
        "`[stinger]`",
        "every stinger has them; `stinger-compliance` makes one softer than stated",
    ),
    (
        "noise of sensors and converter",
        "`[transducer.noise]`, `[accelerometers.noise]`, `acquisition.noise_v_per_rthz`",
        "measured spectra, in every campaign",
    ),
    (
        "sweep direction",
        "`excitation.start_hz` above `stop_hz`",
        "the operator's choice; what disagrees between up and down is `warm-up` or a nonlinear joint",
    ),
    ("sweep too fast", "`excitation.duration_s`", "the operator's choice; the ringing follows from the physics"),
    (
        "leakage: records that do not start or end at rest",
        "`excitation.lead_in_s`, `unrecorded_s`, `ring_down_s`, `taper_s`",
        "the operator's choice",
    ),
    (
        "aliasing",
        "`acquisition.sample_rate_hz`",
        "the converter reads its instants without a filter, so that what lies above half the rate folds; "
        "`anti-alias-delay` is the phase of a filter",
    ),
    ("static sag, stiffening by gravity", "the model itself", "in every scenario, as said below"),
)

_TAIL = """
The structure is a chain of rigid links with large rotations, hung in gravity, and the truth as tested is linear about
the shape in which it hangs. Gravity's follower forces and the droop are therefore in every scenario. Hati's wing droops
by 0.9 % of its semi-span, which alone moves none of its modes below 50 Hz by more than 0.04 %; with an eighth of its
stiffness it would droop by 7 % and lose 1.3 % of its first bending frequency. What the model leaves out is the stretch
of the axis: its beams do not get longer, and a beam held at both ends would not stiffen as it bends.
"""


def own_effects() -> dict[str, Any]:
    """The effects that come with vgvt, by name; plugins of others have pages of their own."""
    return {name: cls for name, cls in available_effects().items() if cls.__module__.startswith("vgvt.effects.")}


def effects_page() -> str:
    """The whole page as Markdown: a table of all effects, then one section an effect, family by family."""
    effects = own_effects()
    families = {family: [n for n, cls in effects.items() if cls.family is family] for family in Family}
    lines = [_HEAD, "| effect | family | linear | in one sentence |", "|---|---|---|---|"]
    for family, names in families.items():
        lines += [
            f"| [{name}](#{name}) | {family} | {'yes' if effects[name].linear else 'no'} | {effects[name].summary} |"
            for name in names
        ]
    for family, names in families.items():
        if names:
            lines += ["", f"## {family.capitalize()}"]
        for name in names:
            lines += ["", *_section(effects[name])]
    lines += [
        "",
        "## What is no effect, and where it is instead",
        "",
        "Some departures from the ideal are properties of every rig, or choices, and are keys of the scenario.",
        "",
        "| departure | where | why it is no effect |",
        "|---|---|---|",
        *(f"| {' | '.join(row)} |" for row in _ELSEWHERE),
        *_TAIL.rstrip("\n").splitlines(),
    ]
    return "\n".join(lines) + "\n"


def _section(effect: Any) -> list[str]:
    parameters = {p.name: p for p in parameters_of(effect)}
    alike = ", ".join(f"`{name}`" for name in effect.confused_with) or "nothing in this catalogue"
    doc = " ".join((effect.__doc__ or "").split())
    lines = [
        f"### {effect.name}",
        "",
        f"{effect.summary}. {doc}",
        "",
        f"- Signature: {effect.signature}.",
        f"- Confused with: {alike}.",
        f"- The test that tells: {effect.separating_test}.",
        f"- Source: {effect.reference}.",
        "",
        "| parameter | unit | default | neutral | plausible | meaning | source of the range |",
        "|---|---|---|---|---|---|---|",
    ]
    for f in dataclasses.fields(effect):
        p = parameters.get(f.name)
        if p is None:
            lines.append(f"| `{f.name}` |  | {_text(f.default)} |  |  | {_cell(f.metadata.get('doc', ''))} |  |")
            continue
        neutral = "" if p.neutral is None else f"{p.neutral:g}"
        lines.append(
            f"| `{p.name}` | {p.unit or '1'} | {f.default:g} | {neutral} | {p.low:g} to {p.high:g} | {_cell(p.doc)} | "
            f"{_cell(p.source)} |"
        )
    return lines


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _text(value: object) -> str:
    return f"`{value!r}`" if isinstance(value, str) else f"{value}"


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, on which there is nothing to choose."""
    return parser_of(__doc__).parse_args(words)


def fill() -> None:
    """Write the page."""
    with replacing(PAGE) as part:
        part.write_text(effects_page(), encoding="utf-8")


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    arguments(words)
    return worked_off(fill, BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
