"""Campaigns and frequency responses in the formats of other programs, with the sidecar that leads back."""
