"""Names in plain letters for what a stream cannot write: ζ is a column's head, and a question mark says nothing."""

from __future__ import annotations

import codecs

PLAIN = "vgvt.plain"
"""The error handler, for ``reconfigure(errors=…)``."""
_NAMES = {
    "²": "2", "³": "3", "°": " deg", "·": ".", "×": "x", "÷": "/", "±": "+-", "½": "1/2", "≤": "<=", "≥": ">=",
    "−": "-", "–": "-", "—": "-", "…": "...", "→": "->", "∞": "inf", "•": "*", "✓": "ok", "✕": "x", "é": "e",
    "Δ": "d", "δ": "d", "ζ": "zeta", "κ": "kappa", "λ": "lambda", "µ": "u", "μ": "u", "ν": "nu", "ρ": "rho",
    "σ": "sigma", "φ": "phi", "χ": "chi", "ψ": "psi", "ω": "omega", "Φ": "Phi", "Σ": "Sigma", "Λ": "Lambda",
    "“": '"', "”": '"', "‘": "'", "’": "'",
}  # fmt: skip


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_NAMES.get(letter, "?") for letter in error.object[error.start : error.end]), error.end


codecs.register_error(PLAIN, _plain)
