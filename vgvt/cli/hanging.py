"""How an aircraft hangs, in words that need no sign convention where it is askew."""

from __future__ import annotations

_ASKEW_DEG = 3.0
"""Roll or pitch at rest that a reader is told of in words."""
_SEEN_DEG = 0.05

Attitudes = tuple[tuple[float, float], ...]
"""Roll (left wing down is positive) and pitch (nose up is positive), degrees, of every run."""


def hanging(hangs_deg: Attitudes) -> str:
    """How the aircraft hangs, and a word where it is askew in some run."""
    askew = hanging_askew(hangs_deg)
    if askew is not None:
        return f"{askew}; a lab would level it first"
    roll, pitch = hangs_deg[_worst(hangs_deg)]
    level = f"{without_sign(roll, 1):+.1f}° of roll (left wing down) and {without_sign(pitch, 1):+.1f}° of pitch"
    return f"hangs at {level} (nose up)"


def hanging_askew(hangs_deg: Attitudes) -> str | None:
    """What is askew in the run that is it most, None where no run is."""
    worst = _worst(hangs_deg)
    roll, pitch = hangs_deg[worst]
    if max(abs(roll), abs(pitch)) < _ASKEW_DEG:
        return None
    wing, nose = "left" if roll > 0 else "right", "up" if pitch > 0 else "down"
    how = [f"{wing} wing {abs(roll):.1f}° low"] * (abs(roll) >= _SEEN_DEG)
    how += [f"nose {abs(pitch):.1f}° {nose}"] * (abs(pitch) >= _SEEN_DEG)
    return f"hangs askew in run {worst + 1}: {', '.join(how)}"


def without_sign(value: float, digits: int) -> float:
    """The value rounded, and a zero without its sign."""
    return round(value, digits) + 0.0


def _worst(hangs_deg: Attitudes) -> int:
    return max(range(len(hangs_deg)), key=lambda k: max(abs(angle) for angle in hangs_deg[k]))
