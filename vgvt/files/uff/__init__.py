"""Universal Files (UFF): what the datasets of a file state, and how they fit a sidecar."""
