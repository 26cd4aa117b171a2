"""The bundled identification methods, one file each, registered as `vgvt.identifiers` plugins."""
