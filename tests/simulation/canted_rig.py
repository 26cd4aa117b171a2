"""An aircraft with dihedral, sweep and a fin, whose sensors look along x, y and z."""

from __future__ import annotations

from pathlib import Path

CANTED = """\
extends = "teaching-beam"
name = "canted"
summary = "wings with dihedral and sweep, a fin, and sensors along all three axes"

[airframe.body]
mass_kg = 0.8
centre_of_gravity_m = [0.05, 0.0, 0.02]
inertia_kg_m2 = [0.01, 0.02, 0.02]
outline_m = [[-0.1, -0.05], [0.9, -0.05], [0.9, 0.05], [-0.1, 0.05]]

[[airframe.beam]]
name = "beam"
mirror = true
cells = 6
[airframe.beam.stations]
position_m = [[0.0, 0.0, 0.0], [0.25, 0.9, 0.12]]
bending_stiffness_n_m2 = [40.0, 25.0]
in_plane_stiffness_n_m2 = [150.0, 100.0]
torsional_stiffness_n_m2 = [20.0, 12.0]
mass_kg_per_m = [1.0, 0.6]
pitch_inertia_kg_m = [0.01, 0.006]
forward_edge_m = [0.15, 0.15]
aft_edge_m = [0.15, 0.15]

[[airframe.beam]]
name = "fin"
normal = [0.0, 1.0, 0.0]
cells = 4
root_bending_stiffness_n_m_per_rad = 60.0
[airframe.beam.stations]
position_m = [[0.8, 0.0, 0.0], [0.9, 0.0, 0.4]]
bending_stiffness_n_m2 = [4.0, 4.0]
torsional_stiffness_n_m2 = [5.0, 5.0]
mass_kg_per_m = [0.5, 0.5]
pitch_inertia_kg_m = [0.003, 0.003]

[suspension]
stiffness_n_per_m = 120.0
damping_n_s_per_m = 0.4
hook_m = [0.19, 0.02, 0.25]
free_length_m = 0.5

[accelerometers.grid]
node = [1, 2, 3, 4, 5, 6, 7, 8, 9]
x_m = [0.15, 0.15, 0.2, 0.1, 0.25, 0.85, 0.9, 0.88, 0.05]
y_m = [0.8, -0.8, 0.6, -0.5, 0.9, 0.0, 0.0, 0.0, 0.0]
z_m = [0.1, 0.1, 0.08, 0.06, 0.12, 0.2, 0.4, 0.3, 0.05]
direction = ["+Z", "-Z", "+X", "-Y", "+Y", "+Y", "-Y", "+X", "+Y"]
attached_to = ["beam", "beam", "beam", "beam", "beam", "fin", "fin", "fin", "body"]

[shaker]
position_m = [0.08, 0.5, 0.06]

[acquisition]
runs = [[3, 4, 5, 6, 7, 8, 9]]

[excitation]
start_hz = 4.0
stop_hz = 40.0
"""


def canted_file(folder: Path) -> str:
    """Write the scenario into a folder; its path as text."""
    path = folder / "canted.toml"
    path.write_text(CANTED, encoding="utf-8")
    return str(path)
