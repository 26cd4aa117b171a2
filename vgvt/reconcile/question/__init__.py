"""What is asked: the records with their noise, what the scenario leaves open, and what could be missing from it."""
