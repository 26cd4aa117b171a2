"""What a campaign would show: A/F of every run, for any scores of the unknowns and hypotheses, and its slopes."""
