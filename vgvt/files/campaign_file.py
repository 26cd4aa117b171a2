"""The campaign file: netCDF-4, one group a run, with a hash over its content."""

from __future__ import annotations

import hashlib
import json
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt._version import __version__
from vgvt.data import Campaign, Channel, ChannelRole, Dof, Geometry, InputError, Quantity, Record
from vgvt.files.netcdf import check_content, check_format, field, read_group, write_groups
from vgvt.files.storable import check_labels, check_nodes, check_samples

if TYPE_CHECKING:
    import xarray

FORMAT = "vgvt campaign"
FORMAT_VERSION = 1
_LARGEST = 2**63 - 1
ADDED_FACTS = ("format", "format_version", "vgvt_version", "created", "name", "content_sha256")
"""What writing adds to a manifest."""
_CHANNEL_COLUMNS = ("name", "quantity", "role", "dof", "unit", "sensitivity_v_per_unit", "range_v")


def write_campaign(
    path: str | Path, campaign: Campaign, manifest: dict[str, Any] | None = None, packed: bool = True
) -> None:
    """Write a campaign, samples as they are (32 or 64 bit), whole or not at all.

    ``manifest`` holds facts about its making (scenario, seed, ...), anything
    JSON; format, version, time of writing and the hash are added. Not ``packed``, samples are
    stored without compression. InputError
    when the place cannot be written, or the file cannot hold a name, a node's number or samples without loss;
    TypeError for a manifest that is not JSON.
    """
    import xarray

    check_labels(campaign, Path(path))
    check_samples(campaign, Path(path))
    check_nodes(campaign.geometry, Path(path), _LARGEST, "a campaign.nc")
    runs = tuple(campaign.runs)
    root = xarray.Dataset(
        {
            "node": ("node", np.array(campaign.geometry.nodes, dtype=np.int64)),
            "position_m": (("node", "axis"), campaign.geometry.positions_m.astype(float)),
        },
        attrs={
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "vgvt_version": __version__,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "name": campaign.name,
            "band_hz": np.array(campaign.band_hz, dtype=float),
            "runs": np.array([r.run for r in runs], dtype=np.int64),
            "notes": json.dumps(campaign.notes),
            "lines": json.dumps(_plain_lines(campaign.geometry)),
            "outline_m": json.dumps([np.asarray(o, float).tolist() for o in campaign.geometry.outline_m]),
            "manifest": json.dumps(manifest or {}),
            "content_sha256": content_hash(campaign),
        },
    )
    write_groups(path, {"/": root} | {_group(r.run): _run_dataset(r) for r in runs}, packed)


def read_campaign(path: str | Path) -> Campaign:
    """Read a campaign file; InputError when it is missing, damaged, of another kind or not what was written."""
    path = Path(path)
    root = read_group(path)
    check_format(path, root, FORMAT, FORMAT_VERSION)
    try:
        campaign = _campaign(path, root)
        found = content_hash(campaign)
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError) as error:
        raise InputError(str(path), f"damaged: {error}", "copy or make the file again") from error
    check_content(path, root, found)
    return campaign


def read_manifest(path: str | Path) -> dict[str, Any]:
    """The facts about the making of a campaign file: the manifest given, and what writing added."""
    path = Path(path)
    root = read_group(path)
    check_format(path, root, FORMAT, FORMAT_VERSION)
    manifest: dict[str, Any] = json.loads(field(path, root, "manifest"))
    return manifest | {k: v.item() if isinstance(v := field(path, root, k), np.generic) else v for k in ADDED_FACTS}


def content_hash(campaign: Campaign) -> str:
    """SHA-256 over labels and samples, the same for the same campaign however it is stored."""
    digest = hashlib.sha256()
    geometry = campaign.geometry
    facts: list[Any] = [campaign.name, [float(f) for f in campaign.band_hz], sorted(campaign.notes.items())]
    facts += [[int(n) for n in geometry.nodes], geometry.positions_m.astype(float).tolist(), _plain_lines(geometry)]
    facts += [[np.asarray(o, float).tolist() for o in geometry.outline_m]]
    digest.update(json.dumps(facts).encode())
    for record in campaign.runs:
        channels = [[str(v) for v in _channel_row(c)] for c in record.channels]
        header = [int(record.run), float(record.sample_rate_hz), channels, record.overloaded, record.notes]
        digest.update(json.dumps(header).encode())
        samples = _storable(record.samples)
        digest.update(str(samples.dtype).encode())
        for channel in samples:
            digest.update(np.ascontiguousarray(channel).data)
    return digest.hexdigest()


def _plain_lines(geometry: Geometry) -> list[list[int]]:
    return [[int(node) for node in line] for line in geometry.lines]


def _group(run: int) -> str:
    return f"run_{run}"


def _channel_row(channel: Channel) -> tuple[str, int, str, str, str, float, float]:
    return (
        channel.name,
        int(channel.quantity),
        channel.role.value,
        "" if channel.dof is None else channel.dof.label,
        channel.unit,
        float(channel.sensitivity_v_per_unit),
        float(channel.range_v),
    )


def _storable(samples: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Little-endian 32 or 64 bit floats, without loss of what has been checked; no copy where they are that already."""
    return samples.astype("<f4" if np.can_cast(samples.dtype, np.float32) else "<f8", copy=False)


def _run_dataset(record: Record) -> xarray.Dataset:
    import xarray

    columns = zip(*(_channel_row(c) for c in record.channels), strict=True)
    variables: dict[str, Any] = {
        name: ("channel", np.array(column, dtype=object if isinstance(column[0], str) else None))
        for name, column in zip(_CHANNEL_COLUMNS, columns, strict=True)
    }
    return xarray.Dataset(
        variables | {"samples": (("channel", "time"), _storable(record.samples))},
        attrs={
            "run": int(record.run),
            "sample_rate_hz": float(record.sample_rate_hz),
            "overloaded": json.dumps(record.overloaded),
            "notes": json.dumps(record.notes),
        },
    )


def _campaign(path: Path, root: xarray.Dataset) -> Campaign:
    geometry = Geometry(
        nodes=tuple(int(n) for n in field(path, root, "node")),
        positions_m=np.asarray(field(path, root, "position_m"), dtype=float),
        lines=tuple(tuple(line) for line in json.loads(field(path, root, "lines"))),
        outline_m=tuple(np.array(o, dtype=float) for o in json.loads(field(path, root, "outline_m"))),
    )
    low, high = (float(f) for f in field(path, root, "band_hz"))
    return Campaign(
        name=str(field(path, root, "name")),
        geometry=geometry,
        runs=tuple(_record(path, _group(int(run))) for run in np.atleast_1d(field(path, root, "runs"))),
        band_hz=(low, high),
        notes=json.loads(field(path, root, "notes")),
    )


def _record(path: Path, group: str) -> Record:
    dataset = read_group(path, group)
    columns = [field(path, dataset, name, group) for name in _CHANNEL_COLUMNS]
    channels = tuple(
        Channel(
            name=str(name),
            quantity=Quantity(int(quantity)),
            role=ChannelRole(str(role)),
            dof=Dof.from_label(str(dof)) if dof else None,
            unit=str(unit),
            sensitivity_v_per_unit=float(sensitivity),
            range_v=float(range_v),
        )
        for name, quantity, role, dof, unit, sensitivity, range_v in zip(*columns, strict=True)
    )
    return Record(
        run=int(field(path, dataset, "run", group)),
        sample_rate_hz=float(field(path, dataset, "sample_rate_hz", group)),
        channels=channels,
        samples=field(path, dataset, "samples", group),
        overloaded=tuple(json.loads(field(path, dataset, "overloaded", group))),
        notes=tuple(json.loads(field(path, dataset, "notes", group))),
    )
