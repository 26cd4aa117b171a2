"""Figures, the one-file report, terminal tables and pictures."""

from vgvt.view.figures import frf_figure, mac_figure, sigma_figure
from vgvt.view.report import render_report, write_report
from vgvt.view.stabilisation import mode_table_figure, stabilisation_figure
from vgvt.view.table import candidates_table, modal_table, scorecard_table

__all__ = [
    "candidates_table",
    "frf_figure",
    "mac_figure",
    "modal_table",
    "mode_table_figure",
    "render_report",
    "scorecard_table",
    "sigma_figure",
    "stabilisation_figure",
    "write_report",
]
