"""The scoreboard as one page: who finds what, how near to the theoretical limit, how honest, how fast."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.files.atomically import replacing
from vgvt.view.html_page import escaped, figure_data, figure_element, html_page
from vgvt.view.scoreboard_figures import bound_figure, calibration_figure, front_figure
from vgvt.view.scoreboard_sections import failures_section, matrix_section, scenario_section

if TYPE_CHECKING:
    import pandas

_BOUND = (
    "Root-mean-square error of every mode's frequency over the seeds, against the Cramér–Rao bound: the least that any "
    "unbiased method can have from these records. On the line a method uses all that the records hold; "
    "far above it, it is biased or blind to part of the data."
)
_CALIBRATION = (
    "Of all intervals that a method states at a level, the share that holds the truth, over modes, seeds and "
    "scenarios. Below the diagonal a method promises too much, above it too little."
)
_FRONT = "Median time of one identification against the median ratio of error to bound. Down and to the left is better."


def write_scoreboard_page(path: Path, table: pandas.DataFrame) -> Path:
    """Write the page of a bench's long table, whole or not at all; every cell of the matrix can be linked to."""
    with replacing(path) as temporary:
        temporary.write_text(render_scoreboard_page(table), encoding="utf-8", newline="\n")
    return path


def render_scoreboard_page(table: pandas.DataFrame) -> str:
    """The same page as a string."""
    figures: dict[str, Any] = {}

    def drawn(key: str, note: str, label: str, figure: Any) -> str:
        if figure is None:
            return ""
        figures[f"{key}-data"] = figure_data(figure)
        return f'<p class="note">{escaped(note)}</p>{figure_element(f"{key}-data", label)}'

    sections = {
        "matrix": ("Methods and scenarios", matrix_section(table)),
        "bound": ("Error against the bound", drawn("bound", _BOUND, "Error against bound", bound_figure(table))),
        "calibration": (
            "Are the stated intervals true?",
            drawn("calibration", _CALIBRATION, "Calibration", calibration_figure(table)),
        ),
        "front": ("Speed and accuracy", drawn("front", _FRONT, "Speed and accuracy", front_figure(table))),
        "failures": ("Without a claim", failures_section(table)),
        **{
            f"scenario-{name}": (name, scenario_section(name, part))
            for name, part in table.groupby("scenario", sort=True)
        },
    }
    return html_page("Scoreboard of identifiers", sections, figures)
