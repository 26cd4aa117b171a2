"""Validation of a claim against the records themselves, as Moreno et al. (American Control Conference, 2014) did it.

NRMSE of every frequency response and ν-gap of all of them: both ask whether the
model says what was measured, not whether it is true, so they need no truth.
"""

from __future__ import annotations

import numpy as np

from vgvt.data import FrequencyResponseSet, FrfFit, InputError, ModalModel, Quantity, synthesise
from vgvt.data.residual_terms import residual_terms as fitted_residual_terms
from vgvt_scoreboard.nrmse import fit_percent
from vgvt_scoreboard.nu_gap import nu_gap_of_accelerances


def validate(
    measured: FrequencyResponseSet, claim: ModalModel, band_hz: tuple[float, float], residual_terms: bool = True
) -> FrfFit:
    """NRMSE (responses, references) and ν-gap over the lines of ``band_hz`` of a claim against measured accelerances.

    A claim holds the modes inside its band only. With ``residual_terms`` each
    response gets two real terms more, fitted to the measured one: a mass line for the modes below
    and one that grows with s² for those above (Ewins, Modal Testing, 2nd ed., 2000,
    section 4.4). For the ν-gap accelerances are in g/N, as in the paper; it is 1 where the band breaks
    the winding condition. Responses measured through an exponential window are compared with the claim's as that
    window shows them. A response or reference along the opposite direction is taken with
    the sign changed. InputError when the
    claim has no residues, or shares no response or reference with what was measured.
    """
    if claim.residues is None or not len(claim):
        raise InputError("validation", "the claim states no modes with residues", "identify by a method that does")
    if measured.quantity is not Quantity.ACCELERATION:
        raise InputError("validation", f"FRFs of {measured.quantity.name.lower()}", "give accelerances")
    known = {d.unsigned for d in claim.dofs}
    driven = {d.unsigned: (i, d.direction.sign) for i, d in enumerate(claim.references)}
    rows = [i for i, d in enumerate(measured.responses) if d.unsigned in known]
    columns = [j for j, d in enumerate(measured.references) if d.unsigned in driven]
    if not rows or not columns:
        raise InputError("validation", "claim and FRFs share no response or no reference", "compare one campaign's")
    frf = measured.band(*band_hz)
    responses = tuple(frf.responses[i] for i in rows)
    references = tuple(frf.references[j] for j in columns)
    y = frf.values[np.ix_(rows, columns)]
    alive = np.isfinite(y).all(axis=(0, 1))
    if int(alive.sum()) < 2:
        raise InputError("validation", "fewer than two finite lines in the band", "widen the band")
    y, frequency = y[:, :, alive], frf.frequency_hz[alive]
    seen = synthesise(claim.at(responses), frequency, added_decay_rad_per_s=frf.added_decay_rad_per_s)
    turned = np.array([driven[r.unsigned][1] * r.direction.sign for r in references], dtype=float)
    model = seen.values[:, [driven[r.unsigned][0] for r in references]] * turned[:, None]
    if residual_terms:
        model = model + fitted_residual_terms(y - model, frequency)
    return FrfFit(responses, references, fit_percent(y, model), frequency, nu_gap_of_accelerances(y, model))
