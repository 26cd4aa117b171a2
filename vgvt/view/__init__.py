"""Figures, the one-file report, terminal tables and pictures."""

from vgvt.view.figures import frf_figure, mac_figure, sigma_figure
from vgvt.view.report import render_report, write_report
from vgvt.view.table import modal_table, scorecard_table

__all__ = [
    "frf_figure",
    "mac_figure",
    "modal_table",
    "render_report",
    "scorecard_table",
    "sigma_figure",
    "write_report",
]
