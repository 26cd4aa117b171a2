"""Scores fitted to data, with or without hypotheses, from wherever a start lies to where no step gains."""
