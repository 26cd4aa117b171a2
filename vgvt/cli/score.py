"""``vgvt score``: a claim against the truth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, show
from vgvt.cli.document import write_document
from vgvt.cli.options import BandOption, JsonOption

if TYPE_CHECKING:
    from vgvt.cli.run_folder import RunFolder
    from vgvt.data import Campaign, FrfFit, Scorecard, Truth
    from vgvt.files.claim import Claim


def score(
    claim: Annotated[Path, typer.Argument(metavar="CLAIM", help="A claim's .json, or a run folder.")],
    truth: Annotated[
        Path | None, typer.Argument(metavar="TRUTH", help="The truth.nc; left out, the one in the claim's run folder.")
    ] = None,
    band: BandOption = None,
    identifier: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which claim of a run folder; may be left out for a single one.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Score a claim against the truth: errors, MAC, missed and false modes."""
    from vgvt.files.claim import read_claim
    from vgvt.files.truth import read_truth

    claim_path, truth_path = _paths(claim, truth, identifier)
    said = read_claim(claim_path)
    true, campaign = read_truth(truth_path), _campaign_of(claim_path)
    card = scored(true, said, band)
    fit = fitted(campaign, said, band)
    strangers = _strangers(true, said, campaign)
    if as_json:
        for line in strangers:
            log(line)
        write_document(card_document(card, fit))
        return 0
    from vgvt.view import scorecard_table

    show(scorecard_table(card))
    if fit is not None:
        log(fit_in_words(fit))
    for line in (*card.remarks, *card.advice, *strangers):
        log(line)
    return 0


def scored(truth: Truth, claim: Claim, band: tuple[float, float] | None) -> Scorecard:
    """The scorecard of a claim in the band that it was made for, unless another is asked for."""
    from dataclasses import replace

    from vgvt.data import InputError
    from vgvt_scoreboard import score as score_model

    band_hz = claim.band_hz if band is None else band
    if not 0 <= band_hz[0] < band_hz[1]:
        raise InputError("--band", f"{band_hz[0]:g} {band_hz[1]:g} is not a band", "write LOW and HIGH in Hz")
    return replace(score_model(truth, claim.model, band_hz), identifier=claim.identifier)


def fitted(campaign: Campaign | None, claim: Claim, band: tuple[float, float] | None) -> FrfFit | None:
    """How the claim's frequency responses meet the measured ones; None without a campaign, a force or residues."""
    from vgvt.data import InputError
    from vgvt.signals import estimate_frf
    from vgvt_scoreboard import validate

    if campaign is None or claim.model.residues is None or not len(claim.model):
        return None
    try:
        return validate(estimate_frf(campaign, "auto"), claim.model, claim.band_hz if band is None else band)
    except InputError as error:
        log(f"no NRMSE and no ν-gap of {claim.identifier}: {error}")
        return None


def card_document(card: Scorecard, fit: FrfFit | None) -> dict[str, Any]:
    """A scorecard as the JSON contract has it, with ``fit``, null where nothing could be compared."""
    return {**card.as_dict(), "fit": None if fit is None else fit.as_dict()}


def fit_in_words(fit: FrfFit) -> str:
    """One line on NRMSE and ν-gap."""
    said = fit.as_dict()
    return (
        f"responses: NRMSE fit {said['median_fit_percent']:.1f} % (median), {said['below']} of {len(said['nrmse'])} "
        f"below {said['accepted_percent']:g} %; ν-gap at most {said['largest_nu_gap']:.3f} "
        f"(at {said['largest_nu_gap_hz']:.2f} Hz, accelerances in g/N)"
    )


def _strangers(truth: Truth, claim: Claim, campaign: Campaign | None) -> tuple[str, ...]:
    """A line where claim and truth are of different tests: by name, or by points that the truth does not have."""
    name = claim.campaign or (campaign.name if campaign is not None else "")
    if name and name != truth.scenario:
        said = f"careful: the claim is of campaign {name!r}, the truth of scenario {truth.scenario!r}"
        return (f"{said}; a score says something only against the truth of the same test",)
    known = {dof.unsigned for modes in truth.as_tested for dof in modes.dofs}
    unknown = [str(dof) for dof in claim.model.dofs if dof.unsigned not in known]
    if not unknown:
        return ()
    listed = ", ".join(unknown[:6]) + (f" and {len(unknown) - 6} more" if len(unknown) > 6 else "")
    return (f"careful: the truth knows no {listed}; shapes are compared without, is it the truth of this test?",)


def _campaign_of(claim_path: Path) -> Campaign | None:
    """The campaign of the run folder that a claim lies in, if it lies in one."""
    from vgvt.cli.run_folder import RunFolder
    from vgvt.files import read_campaign

    path = RunFolder(claim_path.parent.parent).campaign
    return read_campaign(path) if path.is_file() else None


def _paths(claim: Path, truth: Path | None, identifier: str | None) -> tuple[Path, Path]:
    from vgvt.cli.run_folder import RunFolder
    from vgvt.data import InputError

    if not claim.exists():
        raise InputError(str(claim), "there is no such file", "give a claim's .json, or a run folder")
    if truth is not None and truth.is_dir():
        inside = RunFolder(truth).truth
        advice = f"give {inside}" if inside.is_file() else "give the truth.nc of a run, under sealed/"
        raise InputError(str(truth), "this is a folder, not a truth", advice)
    if claim.is_dir():
        folder = RunFolder(claim)
        return _claim_of(folder, identifier), truth or folder.truth
    beside = RunFolder(claim.parent.parent).truth
    if truth is None and not beside.exists():
        raise InputError(
            str(claim), "no truth was named and none lies beside it", "write: vgvt score CLAIM.json TRUTH.nc"
        )
    return claim, truth or beside


def _claim_of(folder: RunFolder, identifier: str | None) -> Path:
    from vgvt.data import InputError

    names = sorted(path.stem for path in (folder.path / "claims").glob("*.json"))
    if not names:
        raise InputError(str(folder.path), "this folder holds no claims", "make one with: vgvt run SCENARIO")
    if identifier is None and len(names) > 1:
        raise InputError(str(folder.path), f"holds claims of {', '.join(names)}", "choose one with --identifier NAME")
    if identifier is not None and identifier not in names:
        raise InputError(str(folder.path), f"holds no claim of {identifier!r}", f"it holds those of {', '.join(names)}")
    return folder.claim(identifier or names[0])
