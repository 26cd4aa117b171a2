"""Virtual ground vibration test: from the shaker's coil to the scored mode shape.

What there is to begin with, each in its package:

- ``vgvt.scenario``: ``load_scenario``, a bundled name or a file
- ``vgvt.simulation``: ``simulate``, a campaign and its truth
- ``vgvt.files``: ``open_campaign``, simulated or measured records
- ``vgvt.identification``: ``make_identifier`` and ``run_identifier``, a modal model of a campaign
- ``vgvt.effects``: ``available_effects`` and ``make_effect``, what a test can lack
- ``vgvt.reconcile``: ``reconcile``, what a scenario lacks of a campaign, and its nine steps
- ``vgvt_scoreboard``: ``score``, a modal model against the truth
"""

from vgvt._version import __version__

__all__ = ["__version__"]
