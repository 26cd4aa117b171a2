"""Everything that touches disk.

The truth of a synthetic campaign has a module of its own, ``vgvt.files.truth``,
that is not exported here: identifiers are kept away from it.
"""

from vgvt.files.campaign_file import read_campaign, read_manifest, write_campaign
from vgvt.files.manifest import check_manifest, versions, write_manifest
from vgvt.files.open import measured_names, open_campaign

__all__ = [
    "check_manifest",
    "measured_names",
    "open_campaign",
    "read_campaign",
    "read_manifest",
    "versions",
    "write_campaign",
    "write_manifest",
]
