"""What the first paper's two methods find on the virtual Hati, held against the truth."""

import paper_tables
import pytest


@pytest.fixture(scope="module")
def unsymmetric() -> paper_tables.Judged:
    return paper_tables.judge("hati-unsymmetric")


@pytest.fixture(scope="module")
def symmetric() -> paper_tables.Judged:
    return paper_tables.judge("hati-symmetric")


@pytest.mark.slow
@pytest.mark.parametrize("method", paper_tables.METHODS)
def test_off_the_axis_both_methods_find_every_mode(unsymmetric: paper_tables.Judged, method: str) -> None:
    card = unsymmetric.cards[method]
    assert (card.found, card.missed, card.false) == (3, 0, 0)
    for mode in card.modes:
        assert mode.true_hz is not None and mode.claimed_hz is not None and mode.mac is not None
        # Roving sensors move the modes by more than this from run to run: run_scatter_hz of the claims.
        assert mode.claimed_hz == pytest.approx(mode.true_hz, rel=1e-3)
        assert mode.claimed_damping_ratio == pytest.approx(mode.true_damping_ratio, rel=0.02)
        assert mode.mac > 0.99


@pytest.mark.slow
@pytest.mark.parametrize("method", paper_tables.METHODS)
def test_on_the_axis_both_miss_the_mode_that_makes_no_peak(symmetric: paper_tables.Judged, method: str) -> None:
    card = symmetric.cards[method]
    claimed = {m.label for m in card.modes if m.claimed_hz is not None}
    (missed,) = set(symmetric.rise_db) - claimed
    assert missed == "1st antisymmetric bending"
    assert card.false == 0
    # The least rise that the methods take for a peak is 1 dB.
    assert symmetric.rise_db[missed] < 1.0 < min(r for label, r in symmetric.rise_db.items() if label != missed)
