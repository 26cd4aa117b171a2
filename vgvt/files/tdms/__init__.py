"""TDMS files (LabVIEW, DIAdem): their groups and channels, and how they fit a sidecar."""
