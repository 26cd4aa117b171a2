"""What a fit leaves, what it cost the tolerances, how well it knows, and what it gains over another."""
