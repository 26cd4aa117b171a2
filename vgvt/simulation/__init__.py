"""The rig in MuJoCo: scenario in, campaign and sealed truth out. The only package that imports mujoco."""

from vgvt.simulation.campaign import SimulationResult, simulate, simulated_campaign
from vgvt.simulation.truth import truth_of

__all__ = ["SimulationResult", "simulate", "simulated_campaign", "truth_of"]
