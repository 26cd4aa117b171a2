"""The estimator that suits records of one force, by whether they start and end at rest."""

from __future__ import annotations

from vgvt.data import Campaign
from vgvt.signals.rest import end_at_rest, pass_once, start_at_rest
from vgvt.signals.usable import UsableRun


def estimator_of_one(campaign: Campaign, runs: tuple[UsableRun, ...]) -> tuple[str, tuple[str, ...]]:
    """The estimator for runs with one force each, and a remark where their records leak.

    Whole spectra divide where records start and end at rest. A sweep cut off at its end is divided too: what rings
    then lies beside most of its lines, and at the ends of a record, where its spectrum is smooth, local fits cannot
    tell it from leakage. All else takes local fits.
    """
    if not start_at_rest(campaign, runs):
        return "local_rational", ("records begin while it rings: spectra of whole records would leak",)
    if end_at_rest(runs):
        return "ratio", ()
    if pass_once(runs, campaign.band_hz):
        return "ratio", (
            "records end while it rings: responses are wrong by what leaks, most near the last frequencies",
        )
    return "local_rational", ("records end while it rings: spectra of whole records would leak",)
