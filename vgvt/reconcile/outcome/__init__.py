"""What is written back: the scenario with its effects, and the arrays and labels of the page."""
