"""Accelerances of one structure, its joints that depend on level, and its record's end: what knows no campaign."""
