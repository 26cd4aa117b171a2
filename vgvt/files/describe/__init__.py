"""From record files to a sidecar: what they state of a test, written down to be checked by a person."""
