"""Close the loop with measured data."""
