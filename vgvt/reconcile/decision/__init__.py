"""Rounds of naming, the checks that a name has to pass, and the verdict that they come to."""
