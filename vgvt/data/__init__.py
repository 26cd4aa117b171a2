"""The nouns: frozen arrays with labels, numpy only.

A campaign is what an engineer brings home from the lab; a modal model is what
an identifier claims and what the truth is, the same type for both.
"""

from vgvt.data.assurance import auto_mac, modal_assurance, modal_phase_collinearity
from vgvt.data.campaign import Campaign
from vgvt.data.candidates import CandidateGroup, PoleCandidate, grouped_candidates
from vgvt.data.channel import Channel, ChannelRole, Quantity
from vgvt.data.dof import Direction, Dof
from vgvt.data.errors import InputError
from vgvt.data.frf import FrequencyResponseSet
from vgvt.data.frf_fit import FrfFit
from vgvt.data.geometry import Geometry
from vgvt.data.modal import ModalModel, Outcome
from vgvt.data.plugin import PluginError
from vgvt.data.record import Record
from vgvt.data.scorecard import ModeScore, ModeStatus, Scorecard
from vgvt.data.synthesis import modal_contributions, synthesise
from vgvt.data.truth import RigidBodyProperties, TrueModes, Truth

__all__ = [
    "Campaign",
    "CandidateGroup",
    "Channel",
    "ChannelRole",
    "Direction",
    "Dof",
    "FrequencyResponseSet",
    "FrfFit",
    "Geometry",
    "InputError",
    "ModalModel",
    "ModeScore",
    "ModeStatus",
    "Outcome",
    "PluginError",
    "PoleCandidate",
    "Quantity",
    "Record",
    "RigidBodyProperties",
    "Scorecard",
    "TrueModes",
    "Truth",
    "auto_mac",
    "grouped_candidates",
    "modal_assurance",
    "modal_contributions",
    "modal_phase_collinearity",
    "synthesise",
]
