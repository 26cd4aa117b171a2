"""The true modes that a claim is shown beside: those that it was judged by."""

from __future__ import annotations

from vgvt.data import ModalModel, Scorecard, TrueModes, Truth

TRUTH_IN_WORDS = {TrueModes.AS_TESTED: "as tested", TrueModes.COUPLED: "with the shaker attached"}


def judged_by(card: Scorecard | None) -> TrueModes:
    """What a claim was judged by; those as tested where it was not judged."""
    return TrueModes.AS_TESTED if card is None else card.true_modes


def true_model(truth: Truth | None, card: Scorecard | None) -> ModalModel | None:
    """The first run's true modes that a claim was judged by; None without truth."""
    runs = () if truth is None else truth.of_runs(judged_by(card))
    return runs[0] if runs else None
