"""The rig in MuJoCo: scenario in, campaign and sealed truth out. The only package that imports mujoco."""

from vgvt.simulation.campaign import SimulationResult, simulate
from vgvt.simulation.truth import truth_of

__all__ = ["SimulationResult", "simulate", "truth_of"]
