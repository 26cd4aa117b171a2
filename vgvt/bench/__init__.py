"""The bench: scenarios × seeds × identifiers, judged blind."""
