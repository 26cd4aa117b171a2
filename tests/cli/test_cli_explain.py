"""``vgvt identify --explain``: why each pole was kept or dropped, for people and for programs."""

from __future__ import annotations

from pathlib import Path


def test_explain_says_of_every_pole_what_became_of_it(vgvt, campaign_file: Path) -> None:
    document = vgvt("identify", campaign_file, "--identifier", "plscf", "--explain", "--json").document
    candidates = document["candidates"]
    assert {"frequency_hz", "damping_ratio", "order", "kept", "reason"} == set(candidates[0])
    assert all(c["reason"] for c in candidates)
    for mode in document["modes"]:
        near = [c for c in candidates if abs(c["frequency_hz"] - mode["frequency_hz"]) < 0.1]
        assert any(c["kept"] for c in near)
    assert "candidates" not in vgvt("identify", campaign_file, "--identifier", "plscf", "--json").document


def test_explain_prints_a_table_for_people(vgvt, campaign_file: Path) -> None:
    result = vgvt("identify", campaign_file, "--identifier", "plscf", "--explain")
    assert result.status == 0
    for word in ("poles that plscf considered", "kept", "dropped", "negative damping", "stand behind the modes"):
        assert word in result.out


def test_a_method_without_orders_says_so(vgvt, campaign_file: Path) -> None:
    result = vgvt("identify", campaign_file, "--identifier", "quadrature", "--explain")
    assert result.status == 0
    assert "nothing to explain" in result.err
