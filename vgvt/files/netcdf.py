"""netCDF-4 through xarray and h5netcdf: groups of labelled arrays, with errors a person can act on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.data import InputError
from vgvt.files.atomically import check_space, replacing
from vgvt.files.seal import check_seal, seal

if TYPE_CHECKING:
    import xarray

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# Of a damaged file h5py finds names that are not there and types that numpy does not know.
_DAMAGE = (OSError, KeyError, ValueError, RuntimeError, AttributeError, TypeError, IndexError, MemoryError)
_CHUNK_BYTES = 1 << 20
_OVERHEAD_BYTES = 1 << 15  # of a group: its header and attributes


def write_groups(path: str | Path, groups: Mapping[str, xarray.Dataset], packed: bool = True) -> None:
    """Write datasets as groups ('/' is the root) of one file in one stroke, numbers compressed if ``packed``.

    OSError (ENOSPC) beforehand when the disk has no room for the numbers uncompressed:
    HDF5 survives a disk that fills up in the middle badly.
    """
    check_space(Path(path).parent, sum(dataset.nbytes for dataset in groups.values()) + _OVERHEAD_BYTES * len(groups))
    with replacing(path) as temporary:
        for i, (group, dataset) in enumerate(groups.items()):
            dataset.to_netcdf(
                temporary.absolute(),  # "~" is a folder's name here, and the home folder to xarray
                mode="a" if i else "w",
                group=group,
                engine="h5netcdf",
                encoding={str(name): _encoding(variable, packed) for name, variable in dataset.variables.items()},
            )
        seal(temporary)


def read_group(path: Path, group: str = "/") -> xarray.Dataset:
    """One group of a netCDF-4 file, in memory; InputError when the file or the group cannot be read."""
    import xarray

    check_netcdf(path)
    if group == "/":  # which is read first, and once
        check_seal(path)
    try:
        with xarray.open_dataset(
            path.absolute(), group=group, engine="h5netcdf", decode_cf=False, cache=False
        ) as dataset:
            return dataset.load()
    except _DAMAGE as error:
        raise InputError(str(path), f"damaged: {_first_line(error)}", "copy or make the file again") from error


def check_netcdf(path: Path) -> None:
    """InputError unless the path holds something that starts like a netCDF-4 file."""
    if not path.is_file():
        raise InputError(str(path), "no such file", "check the path")
    try:
        with path.open("rb") as stream:
            start = stream.read(len(_HDF5_SIGNATURE))
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check its permissions") from error
    if not start:
        raise InputError(str(path), "the file is empty", "copy or make the file again")
    if start != _HDF5_SIGNATURE:
        raise InputError(
            str(path),
            "not a netCDF-4 file",
            "give a campaign.nc, or describe other records in a sidecar (see 'Describe your own records')",
        )


def field(path: Path, dataset: xarray.Dataset, name: str, group: str = "/") -> Any:
    """The values of a variable or attribute; InputError when it is missing."""
    if name in dataset.variables:
        return dataset[name].values
    if name in dataset.attrs:
        return dataset.attrs[name]
    where = str(path) if group == "/" else f"{path}, group {group}"
    known = ", ".join(map(str, [*dataset.variables, *dataset.attrs])) or "nothing"
    raise InputError(where, f"{name!r} is missing (the group holds {known})", "the file is damaged: make it again")


def check_format(path: Path, root: xarray.Dataset, format_name: str, version: int) -> None:
    """InputError unless the root says that the file has this format, in this version or an older one."""
    found = root.attrs.get("format")
    if found != format_name:
        raise InputError(str(path), f"its format is {found!r}, not {format_name!r}", "give the right kind of file")
    try:
        number = int(field(path, root, "format_version"))
    except (TypeError, ValueError) as error:
        raise InputError(str(path), "its format_version is not a number", "make the file again") from error
    if number < 1:
        raise InputError(str(path), f"its format_version is {number}, and they begin at 1", "make the file again")
    if number > version:
        raise InputError(
            str(path), f"written in version {number} of {format_name!r}, this program reads {version}", "update vgvt"
        )


def check_content(path: Path, root: xarray.Dataset, found: str) -> None:
    """InputError unless the content's hash ``found`` is the one that the root states."""
    if found != str(field(path, root, "content_sha256")):
        raise InputError(
            str(path),
            "the content does not match its SHA-256: the file was changed or damaged after it was written",
            "copy it again from where it came, or simulate again",
        )


def _encoding(variable: xarray.Variable, packed: bool) -> dict[str, Any]:
    """Lossless compression of numeric arrays, chunked along the last axis; no fill values."""
    if variable.dtype.kind not in "fciu":
        return {}
    encoding: dict[str, Any] = {"_FillValue": None} if variable.dtype.kind == "f" else {}
    if variable.ndim and variable.size and packed:
        last = min(variable.shape[-1], max(1, _CHUNK_BYTES // variable.dtype.itemsize))
        chunks = (*(1 for _ in variable.shape[:-1]), last) if variable.nbytes > _CHUNK_BYTES else variable.shape
        encoding |= {"zlib": True, "complevel": 1, "shuffle": True, "chunksizes": chunks}
    return encoding


def _first_line(error: Exception) -> str:
    text = str(error.args[0] if isinstance(error, KeyError) and error.args else error).strip()
    return text.splitlines()[0] if text else type(error).__name__
