"""How long work is done: shared with helpers, on one thread each, and with its progress told."""
