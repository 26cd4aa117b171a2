"""``vgvt identify``: a campaign becomes a claim, without the truth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, show, waiting
from vgvt.cli.document import write_document
from vgvt.cli.options import BandOption, CampaignArgument, JsonOption, LeaveOutFaultyOption

if TYPE_CHECKING:
    from vgvt.data import Campaign
    from vgvt.files.claim import Claim
    from vgvt.identification import Identifier


def identify(
    campaign: CampaignArgument,
    identifier: Annotated[str, typer.Option(metavar="NAME", help="See: vgvt list identifiers.")] = "auto",
    band: BandOption = None,
    setting: Annotated[
        list[str] | None, typer.Option(metavar="KEY=VALUE", help="A setting of the identifier; may be given again.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the claim to a file too.")] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="FILE", help="Write the one-file page of the campaign too.")
    ] = None,
    leave_out_faulty: LeaveOutFaultyOption = False,
    explain: Annotated[
        bool, typer.Option("--explain", help="Say of every pole considered why it was kept or dropped.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Identify frequencies, damping ratios and shapes from a campaign.

    Exit status 0 also when there is nothing to find; 1 when the identifier
    declined or did not converge.
    """
    from vgvt.cli.options import parsed_settings
    from vgvt.cli.soundness import sound_campaign
    from vgvt.cli.written_file import checked_file, is_claim, is_page
    from vgvt.data import InputError, Outcome
    from vgvt.data.shown import counted
    from vgvt.files.claim import claim_document
    from vgvt.files.open import files_of

    method = made_identifier(identifier, parsed_settings(setting or []))
    if out is not None:
        checked_file(out, "claim", is_claim, files_of(campaign))
    if report is not None:
        if out is not None and report.resolve() == out.resolve():
            raise InputError("--report", f"{report} is where --out writes", "give the page another name")
        checked_file(report, "page of vgvt", is_page, files_of(campaign))
    with waiting("identify") as say:
        say(f"read {campaign}")
        opened = sound_campaign(campaign, leave_out_faulty)
        say(f"{method.name} is at work on {counted(len(opened.runs), 'run')}")
        claim = claimed(method, opened, band)
    document = claim_document(claim, candidates=explain)
    if out is not None:
        write_claim(out, document)
    if report is not None:
        _write_report(report, opened, claim)
    if as_json:
        write_document(document)
    else:
        from vgvt.view import modal_table

        show(modal_table(claim.model, f"{claim.identifier}, {claim.band_hz[0]:g} to {claim.band_hz[1]:g} Hz"))
        if explain:
            _explain(claim)
        for line in claim.model.advice:
            log(line)
    return 0 if claim.model.outcome in (Outcome.FOUND, Outcome.NOTHING_FOUND) else 1


def _explain(claim: Claim) -> None:
    from vgvt.view import candidates_table

    if claim.model.candidates:
        show(candidates_table(claim.model, f"poles that {claim.identifier} considered"))
    else:
        log(f"{claim.identifier} weighs no poles of several model orders, so there is nothing to explain")


def _write_report(path: Path, campaign: Campaign, claim: Claim) -> None:
    from vgvt import __version__
    from vgvt.signals import estimate_frf
    from vgvt.view import write_report

    write_report(
        path,
        title=f"{campaign.name}: modes by {claim.identifier}",
        campaign=campaign,
        frf=estimate_frf(campaign, "auto") if campaign.reference_dofs else None,
        claims={claim.identifier: claim.model},
        facts={"made by": f"vgvt {__version__}"},
    )
    log(f"open {path} in a browser")


def made_identifier(name: str, settings: dict[str, Any]) -> Identifier:
    """The identifier with its settings; InputError for a name or a setting that it does not have."""
    from vgvt.identification import make_identifier

    return make_identifier(name, **settings)


def claimed(method: Identifier, campaign: Campaign, band: tuple[float, float] | None) -> Claim:
    """What the method says about the campaign."""
    from vgvt.files.claim import Claim
    from vgvt.identification import run_identifier

    band_hz = campaign.band_hz if band is None else band
    model = run_identifier(method, campaign, band_hz)
    return Claim(identifier=method.name, band_hz=band_hz, model=model, campaign=campaign.name)


def write_claim(path: Path, document: dict[str, Any]) -> None:
    """Write a claim's document, whole or not at all."""
    from vgvt.cli.document import document_text
    from vgvt.files.atomically import replacing

    with replacing(path) as temporary:
        temporary.write_text(document_text(document), encoding="utf-8")
