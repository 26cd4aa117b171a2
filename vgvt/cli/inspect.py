"""``vgvt inspect``: what is in a campaign."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vgvt.cli.console import show
from vgvt.cli.document import write_document
from vgvt.cli.options import CampaignArgument, JsonOption

if TYPE_CHECKING:
    from vgvt.data import Campaign, Record


def inspect(campaign: CampaignArgument, as_json: JsonOption = False) -> int:
    """Show the runs, channels, levels and overloads of a campaign."""
    from vgvt.files import open_campaign

    document = campaign_document(open_campaign(campaign))
    if as_json:
        write_document(document)
        return 0
    from vgvt.cli.tables import items_table

    show(
        f"{document['name']}: {_runs_in_words(len(document['runs']))}, excited from {document['band_hz'][0]:g} "
        f"to {document['band_hz'][1]:g} Hz, responses {' '.join(document['responses'])}, "
        f"references {' '.join(document['references'])}"
    )
    for key, value in document["notes"].items():
        show(f"{key}: {value}")
    rows = [
        {
            "run": run["run"],
            **{key: channel[key] for key in ("name", "role", "dof", "unit")},
            "duration_s": f"{run['duration_s']:g}",
            "sample_rate_hz": f"{run['sample_rate_hz']:g}",
            "rms": f"{channel['rms']:.4g}",
            "peak": f"{channel['peak']:.4g}",
            "remarks": channel["fault"] or ("clipped" if channel["overloaded"] else ""),
        }
        for run in document["runs"]
        for channel in run["channels"]
    ]
    show(
        items_table(
            rows, ("run", "name", "role", "dof", "duration_s", "sample_rate_hz", "rms", "peak", "unit", "remarks")
        )
    )
    for run in document["runs"]:
        for note in run["notes"]:
            show(f"run {run['run']}: {note}")
    return 0


def campaign_document(campaign: Campaign) -> dict[str, Any]:
    """What is in a campaign, as the document of ``vgvt inspect``."""
    from vgvt.cli.soundness import channel_faults

    faults = channel_faults(campaign)
    return {
        "name": campaign.name,
        "band_hz": list(campaign.band_hz),
        "notes": dict(campaign.notes),
        "nodes": [
            {"node": node, "position_m": position}
            for node, position in zip(campaign.geometry.nodes, campaign.geometry.positions_m, strict=True)
        ],
        "responses": [dof.label for dof in campaign.response_dofs],
        "references": [dof.label for dof in campaign.reference_dofs],
        "runs": [_run_document(record, faults) for record in campaign.runs],
    }


def _runs_in_words(count: int) -> str:
    return f"{count} run" if count == 1 else f"{count} runs"


def _run_document(record: Record, faults: dict[tuple[int, str], str]) -> dict[str, Any]:
    import numpy as np

    samples = np.asarray(record.samples, dtype=float)
    return {
        "run": record.run,
        "sample_rate_hz": record.sample_rate_hz,
        "duration_s": record.duration_s,
        "samples": samples.shape[1],
        "notes": list(record.notes),
        "channels": [
            {
                "name": channel.name,
                "quantity": channel.quantity.name.lower(),
                "role": channel.role.value,
                "dof": "" if channel.dof is None else channel.dof.label,
                "unit": channel.unit,
                "mean": row.mean(),
                "rms": float(np.sqrt((row**2).mean())),
                "peak": np.abs(row).max(),
                "range_v": channel.range_v,
                "overloaded": channel.name in record.overloaded,
                "fault": faults.get((record.run, channel.name)),
            }
            for channel, row in zip(record.channels, samples, strict=True)
        ],
    }
