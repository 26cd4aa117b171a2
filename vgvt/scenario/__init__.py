"""The scenario: schema, TOML loading, bundled library, named random streams."""
