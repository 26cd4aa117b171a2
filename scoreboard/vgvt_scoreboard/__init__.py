"""Scores: a claimed modal model against the truth, one row per mode."""
