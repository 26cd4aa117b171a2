"""Figures, the one-file report and pictures."""
