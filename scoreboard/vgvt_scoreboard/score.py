"""The score: a claimed modal model against the truth, one row per mode."""

from __future__ import annotations

from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, InputError, ModalModel, ModeScore, ModeStatus, Scorecard, TrueModes, Truth
from vgvt_scoreboard.judged_by import JudgedBy, judged_by
from vgvt_scoreboard.pairing import Pairing, PairingRule, pair_modes
from vgvt_scoreboard.scaling import scaling_error_percent


class _ClaimSide(TypedDict, total=False):
    claimed_hz: float
    claimed_damping_ratio: float | None
    claimed_std_hz: float | None
    claimed_damping_ratio_std: float | None
    claimed_index: int


def score(
    truth: Truth,
    claim: ModalModel,
    band_hz: tuple[float, float],
    scenario: str = "",
    identifier: str = "",
    rule: PairingRule | None = None,
) -> Scorecard:
    """Score a claim against the average truth, within a band: as tested, or with the shaker for one without the force.

    Frequencies in Hz. Shapes are compared at the claim's DOFs. True modes in the band are found,
    missed or unreached; a claim that fits a true mode just outside the band is found too but never
    required, and claims outside the band that fit nothing in it are left out. InputError when claim
    and truth share no DOF or the band is upside down. See scoreboard/README.md for a worked example.
    """
    scenario, identifier = scenario or truth.scenario, identifier or claim.method
    if not 0 <= band_hz[0] < band_hz[1]:
        raise InputError(f"score of {identifier}", f"band {band_hz} Hz is no band", "give 0 <= low < high")
    judge = judged_by(truth, claim)
    dofs = _common_dofs(judge.merged.model, claim, f"score of {identifier or 'the claim'} on {scenario}")
    true_model = judge.merged.model.at(dofs)
    claimed = claim.at(dofs) if len(claim) else ModalModel.empty(claim.outcome, claim.advice, claim.method, dofs)
    shapeless = judge.merged.joined_mac < (rule or PairingRule()).min_mac
    pairing = pair_modes(true_model, claimed, rule, shapeless)
    rows = _rows(judge, true_model, claimed, pairing, band_hz, shapeless)
    rows.sort(key=lambda row: row.true_hz if row.true_hz is not None else row.claimed_hz or 0.0)
    return Scorecard(
        identifier=identifier,
        scenario=scenario,
        band_hz=band_hz,
        modes=tuple(r for r in rows if r.status is not ModeStatus.UNREACHED),
        unreached=tuple(r for r in rows if r.status is ModeStatus.UNREACHED),
        outcome=claim.outcome,
        advice=claim.advice,
        true_modes=judge.which,
        remarks=judge.remarks(band_hz, dofs),
    )


def _common_dofs(true_model: ModalModel, claim: ModalModel, where: str) -> tuple[Dof, ...]:
    """The claim's DOFs that the truth knows; without any claim, all but the references."""
    known = {d.unsigned for d in true_model.dofs}
    common = tuple(d for d in claim.dofs if d.unsigned in known)
    if common:
        return common
    if len(claim):
        theirs = ", ".join(str(d) for d in claim.dofs[:6]) or "none"
        ours = ", ".join(str(d) for d in true_model.dofs[:6])
        raise InputError(
            where,
            f"claim and truth share no degree of freedom (claim: {theirs}; truth: {ours})",
            "score a claim only against the truth of the campaign it was made from",
        )
    references = {d.unsigned for d in true_model.references}
    return tuple(d for d in true_model.dofs if d.unsigned not in references) or true_model.dofs


def _rows(
    judge: JudgedBy,
    true_model: ModalModel,
    claimed: ModalModel,
    pairing: Pairing,
    band_hz: tuple[float, float],
    shapeless: NDArray[np.bool_],
) -> list[ModeScore]:
    partner = dict(pairing.pairs)
    inside = _inside(true_model.natural_frequency_hz, band_hz)
    seen = judge.reached(true_model.dofs) & ~shapeless
    rows = []
    for i in range(len(true_model)):
        j = partner.get(i)
        # Out-of-band truth excuses an in-band claim that belongs to it; it asks for nothing.
        if inside[i] or (j is not None and _inside(claimed.natural_frequency_hz, band_hz)[j]):
            rows.append(_true_row(judge, true_model, claimed, pairing, i, j, bool(seen[i]), bool(inside[i])))
    taken = set(partner.values())
    in_band = _inside(claimed.natural_frequency_hz, band_hz)
    rows += [_false_row(true_model, claimed, pairing, j) for j in range(len(claimed)) if j not in taken and in_band[j]]
    return rows


def _true_row(
    judge: JudgedBy,
    true_model: ModalModel,
    claimed: ModalModel,
    pairing: Pairing,
    i: int,
    j: int | None,
    seen: bool,
    inside: bool,
) -> ModeScore:
    status = ModeStatus.FOUND if j is not None else ModeStatus.MISSED if seen else ModeStatus.UNREACHED
    remark = "" if seen else _why_unseen(judge, i)
    coupled = judge.which is TrueModes.COUPLED
    if coupled and judge.counterpart[i] < 0:
        remark = "; ".join(filter(None, ("shaker and aircraft together: like no mode as tested", remark)))
    as_tested_hz, as_tested_damping_ratio = judge.as_tested_at(i)
    return ModeScore(
        status=status,
        true_hz=float(true_model.natural_frequency_hz[i]),
        true_damping_ratio=float(true_model.damping_ratio[i]),
        true_spread_hz=float(judge.merged.frequency_spread_hz[i]),
        frequency_bound_hz=_stated(true_model.natural_frequency_std_hz, i),
        # Residues with the shaker are for a volt of command, which no claim knows.
        scaling_error_percent=None if j is None or coupled else scaling_error_percent(true_model, i, claimed, j),
        mac=None if j is None else float(pairing.mac[i, j]),
        label=true_model.labels[i] if true_model.labels else "",
        reachable=seen,
        in_band=inside,
        true_index=int(judge.merged.index[i]),
        as_tested_hz=as_tested_hz,
        as_tested_damping_ratio=as_tested_damping_ratio,
        remark=remark if inside else "outside the band asked for",
        **_claim_side(claimed, j),
    )


def _why_unseen(judge: JudgedBy, i: int) -> str:
    if judge.reached(judge.merged.model.dofs)[i]:
        return "the runs drive this mode so differently that no method can join its shape; the pole alone counts"
    return "force, noise and sensors leave too little of this mode in the records"


def _false_row(true_model: ModalModel, claimed: ModalModel, pairing: Pairing, j: int) -> ModeScore:
    """A claim without a partner; it says so when it doubles a mode that another claim has taken."""
    rivals = np.flatnonzero(pairing.admissible[:, j])
    remark = ""
    if rivals.size:
        nearest = rivals[np.argmin(pairing.pole_distance[rivals, j])]
        remark = f"split: the mode at {true_model.natural_frequency_hz[nearest]:.2f} Hz is claimed twice"
    label = claimed.labels[j] if claimed.labels else ""
    return ModeScore(status=ModeStatus.FALSE, label=label, remark=remark, **_claim_side(claimed, j))


def _claim_side(claimed: ModalModel, j: int | None) -> _ClaimSide:
    if j is None:
        return {}
    return {
        "claimed_hz": float(claimed.natural_frequency_hz[j]),
        "claimed_damping_ratio": _stated(claimed.damping_ratio, j),
        "claimed_std_hz": _stated(claimed.natural_frequency_std_hz, j),
        "claimed_damping_ratio_std": _stated(claimed.damping_ratio_std, j),
        "claimed_index": j,
    }


def _stated(values: NDArray[np.float64] | None, j: int) -> float | None:
    return None if values is None or not np.isfinite(values[j]) else float(values[j])


def _inside(frequency_hz: NDArray[np.float64], band_hz: tuple[float, float]) -> NDArray[np.bool_]:
    return np.asarray((frequency_hz >= band_hz[0]) & (frequency_hz <= band_hz[1]))
