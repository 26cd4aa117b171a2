"""What it takes to be an identifier: protocol, registry, conformance checks."""
