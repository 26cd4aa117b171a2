"""Test planning: which test would identify the modes best, before the lab is booked."""
