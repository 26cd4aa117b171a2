"""What it takes to be an identifier: protocol, registry, conformance checks."""

from vgvt.identification.citations import bibliography, bibtex_entries
from vgvt.identification.protocol import Identifier, Needs
from vgvt.identification.registry import (
    PluginWarning,
    Setting,
    absent_identifiers,
    available_identifiers,
    make_identifier,
    settings_of,
)
from vgvt.identification.requirement import Requirement
from vgvt.identification.run import ContractError, run_identifier, settings_text
from vgvt.identification.state_space import to_state_space

__all__ = [
    "ContractError",
    "Identifier",
    "Needs",
    "PluginWarning",
    "Requirement",
    "Setting",
    "absent_identifiers",
    "available_identifiers",
    "bibliography",
    "bibtex_entries",
    "make_identifier",
    "run_identifier",
    "settings_of",
    "settings_text",
    "to_state_space",
]
