"""One page that a technician can follow: where things go, what to set, what to check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

from vgvt._version import __version__
from vgvt.scenario import Scenario, SensorPoint, sensor_points
from vgvt.scenario.full_scale import expected_overloads, scales_of_acceleration, scales_of_force
from vgvt.scenario.rig import RANDOM_KINDS, Excitation
from vgvt.view.html_page import escaped
from vgvt.view.plan_drawing import INCH_M, plan_drawing, run_colour

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
# What an eye along a wing does not tell from level.
_LEVEL_DEG = 0.5
_KINDS = {"linear-chirp": "linear sine sweep", "logarithmic-chirp": "logarithmic sine sweep"}


@dataclass(frozen=True, slots=True)
class ExpectedMode:
    """A mode as the card states it: name, frequency, damping in per cent, and their expected deviations."""

    label: str
    frequency_hz: float
    frequency_std_hz: float
    damping_percent: float
    relative_damping_std: float


@dataclass(frozen=True, slots=True)
class CardFacts:
    """What a card says beside the scenario: how the transducer is fixed, the minutes, what to set and to expect."""

    mount: str
    mount_minutes: float
    setup_minutes: float
    minutes: float
    modes: tuple[ExpectedMode, ...]
    peak_command_v: float
    peak_force_n: float
    peak_acceleration_m_per_s2: float
    peak_drive_mm: float
    hangs_deg: tuple[tuple[float, float], ...]
    """Roll (left wing down is positive) and pitch (nose up is positive) at rest, with what every run has attached."""


def card_page(scenario: Scenario, title: str, facts: CardFacts) -> str:
    """The test card as one HTML file, A4 when printed, everything inside."""
    style = (files("vgvt.view") / "page" / "card.css").read_text(encoding="utf-8")
    drawing = plan_drawing(scenario, f"Where to put things: {title}")
    steps = "".join(f"<li><b>{head}</b> {text}</li>" for head, text in _steps(scenario, facts))
    configuration = escaped(" ".join((scenario.airframe.name, scenario.airframe.configuration)))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{escaped(title)}</title><style>{style}</style></head>\n<body>'
        f"<header><h1>Test card: {escaped(title)}</h1><p>{configuration}. "
        f"{facts.minutes:.0f} minutes in the lab.</p></header>\n"
        f'<figure>{drawing}</figure>\n<div class="columns"><section><h2>Steps</h2><ol>{steps}</ol></section>'
        f"<section><h2>Accelerometers</h2>{_sensor_table(scenario)}"
        f"<h2>What to expect</h2>{_modes(facts)}</section></div>"
        f"<footer>Distances from the nose, aft (x) and to the right (y; left is negative). Deviations are those of "
        f"noise alone, from the model: glue, joints, temperature and the model itself add to them. "
        f"vgvt {escaped(__version__)}.</footer></body></html>\n"
    )


def _steps(scenario: Scenario, facts: CardFacts) -> list[tuple[str, str]]:
    shaker, e, acquisition = scenario.shaker, scenario.excitation, scenario.acquisition
    hook = scenario.suspension.hook_m
    runs, repeats = len(acquisition.runs), acquisition.repeats
    one = "record" if e.kind in RANDOM_KINDS else "sweep"
    sweeps = f"one {one}" if repeats == 1 else f"{repeats} {one}s, one after the other"
    silences = [f"{s:g} s of silence {w}" for s, w in ((e.lead_in_s, "before"), (e.ring_down_s, "after")) if s > 0]
    return [
        (
            "Hang",
            f"the aircraft by the hook {_place(hook)} and let it come to rest. With transducer and accelerometers "
            f"attached it must hang {_attitudes(facts.hangs_deg)}.",
        ),
        (
            "Fix the force transducer",
            f"under the part {escaped(shaker.attached_to)}, {_place(shaker.position_m)}: "
            f"{escaped(facts.mount)}. Allow {facts.mount_minutes:g} min.",
        ),
        ("Stand the shaker", "below it, stinger vertical, pushing up. Zero the force with the stinger just attached."),
        (
            "Place the accelerometers",
            f"of {'the run' if runs == 1 else 'run 1'} as in the table, {_axis_words(scenario)}. "
            f"Allow {facts.setup_minutes:g} min{' a run' if runs > 1 else ''}.",
        ),
        (
            "Set the generator",
            f"{', '.join([_command(e), *silences])}; {_level(scenario, facts)}. Record at "
            f"{acquisition.sample_rate_hz:g} samples a second, {e.record_s:g} s a record{_late(e)}.",
        ),
        ("Record silence", "for 10 s with the amplifier off: no hum, no channel dead, no channel twice as noisy."),
        (
            one.capitalize(),
            f"{sweeps}{'' if runs == 1 else f' a run; then move the accelerometers to the next run, {runs} in all'}. "
            "Do not touch aircraft or cables meanwhile.",
        ),
        (
            f"Check after the first {one}",
            f"force at most {facts.peak_force_n:.3g} N, acceleration at most "
            f"{facts.peak_acceleration_m_per_s2 / 9.80665:.2g} g, drive point moving at most "
            f"±{facts.peak_drive_mm:.2g} mm (within the shaker's stroke?). "
            f"{_ends(scenario, facts)} Peaks near the frequencies on the right.",
        ),
        (
            "At the end",
            f"repeat a minute of the first {one} if there is time: a peak that moved says that something did.",
        ),
    ]


def _attitudes(hangs_deg: Sequence[tuple[float, float]]) -> str:
    """How it hangs in the first run, and in the one that differs most from it, where an eye sees that."""
    first = hangs_deg[0]
    moved_deg = [max(abs(a - b) for a, b in zip(angles, first, strict=True)) for angles in hangs_deg]
    other = max(range(len(hangs_deg)), key=moved_deg.__getitem__)
    if moved_deg[other] < _LEVEL_DEG:
        return _attitude(*first)
    return f"{_attitude(*first)} in run 1, and {_attitude(*hangs_deg[other])} in run {other + 1}"


def _attitude(roll_deg: float, pitch_deg: float) -> str:
    """How it hangs, in words that need no sign convention."""
    said = [
        f"{way} by {abs(angle):.1f}°"
        for angle, way in (
            (roll_deg, "left wing down" if roll_deg > 0 else "right wing down"),
            (pitch_deg, "nose up" if pitch_deg > 0 else "nose down"),
        )
        if abs(angle) >= _LEVEL_DEG
    ]
    return " and ".join(said) or f"level to {_LEVEL_DEG:g}°"


def _late(e: Excitation) -> str:
    """When the record begins, where that is not before the shaker."""
    return f", begun {e.before_record_s:g} s after the shaker" if e.before_record_s else ""


def _ends(scenario: Scenario, facts: CardFacts) -> str:
    """Where force and acceleration would be cut off, and what is expected to be."""
    force, acceleration = scales_of_force(scenario), scales_of_acceleration(scenario)
    of_force, of_acceleration = (min(scales, key=lambda scale: scale.si) for scales in (force, acceleration))
    text = (
        f"No overload: the force is cut off at {of_force.si:.3g} N ({escaped(of_force.words)}), the acceleration at "
        f"{of_acceleration.si / 9.80665:.3g} g ({escaped(of_acceleration.words)})."
    )
    peaks = (facts.peak_force_n, facts.peak_acceleration_m_per_s2, facts.peak_command_v)
    beyond = expected_overloads(scenario, *peaks)
    return f"{text} <b>Turn the level down</b>: {escaped('; '.join(beyond))}." if beyond else text


def _command(e: Excitation) -> str:
    """What the generator is to send: shape, band, and what it is made of."""
    text = (
        f"{_KINDS.get(e.kind, e.kind.replace('-', ' '))} from {e.start_hz:g} to {e.stop_hz:g} Hz in {e.duration_s:g} s"
    )
    if e.taper_s > 0:
        text += f", {'each burst' if e.kind == 'burst-random' else 'all of it'} rising and falling in {e.taper_s:g} s"
    if e.points is not None:
        dwell = f"{e.points} dwells of {e.duration_s / e.points:.4g} s"
        text += f", {dwell}, of which {e.settle_s or 0:g} s to settle"
    if e.blocks is not None and e.burst_fraction is not None:
        text += f", {e.blocks} blocks of {e.duration_s / e.blocks:.4g} s, the first {e.burst_s:.4g} s of each noise"
    elif e.blocks is not None:
        text += f", {e.blocks} periods of {e.duration_s / e.blocks:.4g} s"
    if e.lines is not None:
        text += f", {'all' if e.lines == 'full' else 'odd'} lines"
    return text


def _level(scenario: Scenario, facts: CardFacts) -> str:
    """The amplitude in volts of the generator and at the coil: the peak of a sine, else root mean square and peak."""
    e, shaker = scenario.excitation, scenario.shaker
    unit = "V" if shaker.drive == "voltage" else "A"
    at_coil = f"{facts.peak_command_v * shaker.amplifier_gain:.3g} {unit}"
    if e.kind not in RANDOM_KINDS:
        return f"{e.amplitude_v:g} V peak ({at_coil} at the coil)"
    where = " inside the bursts" if e.kind == "burst-random" else ""
    return f"{e.amplitude_v:g} V rms{where} (peaks of about {facts.peak_command_v:.3g} V, {at_coil} at the coil)"


def _place(position_m: Sequence[float]) -> str:
    x, y = position_m[0], position_m[1]
    side = "on the centre line" if abs(y) < 5e-4 else f"{abs(y) / INCH_M:.1f} in {'right' if y > 0 else 'left'}"
    return f"{x / INCH_M:.1f} in aft, {side} ({x:.3f} m, {y if abs(y) >= 5e-4 else 0.0:.3f} m)"


def _axis_words(scenario: Scenario) -> str:
    labels = set(scenario.accelerometers.grid.direction or ("+Z",))
    return "axes up" if labels <= {"+Z", "Z"} else "along the axis in the table"


def _sensor_table(scenario: Scenario) -> str:
    """Every point of every run with its distances in inches and metres, in two tables side by side where they fit."""
    by_node = {p.dof.node: p for p in sensor_points(scenario)}
    runs = scenario.acquisition.runs
    several, axes = len(runs) > 1, _axis_words(scenario) != "axes up"
    rows = [_row(k, by_node[node], several, axes) for k, run in enumerate(runs) for node in run]
    half = len(rows) if several or axes or len(rows) <= 12 else -(-len(rows) // 2)
    words = [*(["run"] if several else []), "no.", "x in", "y in", "x m", "y m", *(["axis"] if axes else [])]
    head = f"<tr>{''.join(f'<th>{word}</th>' for word in words)}</tr>"
    tables = [rows[:half], rows[half:]] if half < len(rows) else [rows]
    return '<div class="tables">' + "".join(f"<table>{head}{''.join(part)}</table>" for part in tables) + "</div>"


def _row(run: int, point: SensorPoint, several: bool, axes: bool) -> str:
    x, y, _ = point.position_m
    number = f"<b>{point.dof.node}</b>"
    if several:
        number = f'<span style="color:{run_colour(run)}">{number}</span>'
    cells = [number, f"{x / INCH_M:.1f}", f"{y / INCH_M:+.1f}", f"{x:.3f}", f"{y:+.3f}"]
    cells = [*([str(run + 1)] if several else []), *cells, *([_axis(point)] if axes else [])]
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _axis(point: SensorPoint) -> str:
    """The measuring direction as people write it, like +Z."""
    return str(point.dof).removeprefix(str(point.dof.node))


def _modes(facts: CardFacts) -> str:
    rows = "".join(
        f"<tr><td class='words'>{escaped(m.label)}</td><td>{m.frequency_hz:.2f}</td><td>{m.frequency_std_hz:.1g}</td>"
        f"<td>{m.damping_percent:.2f}</td><td>{100 * m.relative_damping_std:.1g}</td></tr>"
        for m in facts.modes
    )
    head = "<tr><th class='words'>mode</th><th>Hz</th><th>± Hz</th><th>ζ %</th><th>± % of ζ</th></tr>"
    return f"<table>{head}{rows}</table>"
