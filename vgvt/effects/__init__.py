"""The catalogue of departures from the ideal rig, a plugin family."""
