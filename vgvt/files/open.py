"""Open a campaign, whatever form it comes in."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vgvt.data import Campaign, InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.files.campaign_file import read_campaign
from vgvt.files.export.form import UNIVERSAL_ENDINGS
from vgvt.files.locate import find_dataset

if TYPE_CHECKING:
    from vgvt.files.sidecar import Sidecar

CAMPAIGN_NAME = "campaign.nc"
_OF_SCENARIOS = frozenset({"extends", "airframe", "suspension", "shaker", "excitation", "acquisition", "effect"})
_OF_SIDECARS = frozenset({"records", "channel", "run"})
_TDMS = ".tdms"
_SHIPPED = Path(__file__).parent / "measured"


def measured_names() -> tuple[str, ...]:
    """Names of the measured campaigns that vgvt knows how to read."""
    return tuple(sorted(path.stem for path in _SHIPPED.glob("*.toml")))


def open_campaign(source: str | Path) -> Campaign:
    """The campaign of a campaign.nc, of a run folder that holds one, of a sidecar .toml, or of a measured name.

    InputError says what is wrong with the source, or how to get the data.
    """
    path = Path(source)
    if path.is_dir():
        if not (path / CAMPAIGN_NAME).is_file():
            raise InputError(str(path), f"the folder holds no {CAMPAIGN_NAME}", "give a run folder, or a file")
        return read_campaign(path / CAMPAIGN_NAME)
    if path.is_file():
        if path.suffix == ".toml":
            return _open_sidecar(path)
        if path.suffix.lower() in UNIVERSAL_ENDINGS:
            raise InputError(
                str(path),
                "a Universal File does not say all that vgvt needs, like the band and which axis points aft",
                f"write a sidecar for it, and give that: vgvt data describe {path}",
            )
        if path.suffix.lower() == _TDMS:
            raise InputError(
                str(path),
                "a TDMS file does not say all that vgvt needs, like where its sensors sat",
                f"write a sidecar for it, and give that: vgvt data describe {path}",
            )
        return read_campaign(path)
    name = str(source)
    if name in measured_names():
        return _open_sidecar(_SHIPPED / f"{name}.toml")
    if path.suffix or len(path.parts) > 1:
        raise InputError(name, "no such file or folder", f"check the path; measured campaigns: {_listed()}")
    raise InputError(
        name,
        "no such file, folder or measured campaign",
        f"give the path of a campaign.nc, run folder or sidecar, or {choose_one_of(name, measured_names())}",
    )


def files_of(source: str | Path) -> tuple[Path, ...]:
    """The files that :func:`open_campaign` reads for a source: of a sidecar itself, and every record file."""
    path = Path(source)
    if path.is_dir():
        return (path / CAMPAIGN_NAME,)
    if not path.is_file() and str(source) in measured_names():
        path = _SHIPPED / f"{source}.toml"
    if path.suffix != ".toml" or not path.is_file():
        return (path,)
    sidecar = _sidecar(path)
    folder = _records_folder(path, sidecar)
    return (path, *dict.fromkeys(folder / run.file for run in sidecar.run))


def shipped_sidecar(name: str) -> Path:
    """The sidecar of a measured campaign by name; InputError with the names there are."""
    if name not in measured_names():
        raise InputError(name, "no such measured campaign", choose_one_of(name, measured_names()))
    return _SHIPPED / f"{name}.toml"


def _open_sidecar(path: Path) -> Campaign:
    # pydantic is slow to import, and a campaign.nc does not need it.
    from vgvt.files.measured_records import read_measured

    sidecar = _sidecar(path)
    folder, dataset = _records_folder(path, sidecar), sidecar.records.dataset
    try:
        return read_measured(sidecar, folder)
    except InputError as error:
        if not dataset:
            raise
        again = f"{error.advice}; `vgvt data get {dataset}` fetches it again"
        raise InputError(error.where, error.problem, again) from error


def _sidecar(path: Path) -> Sidecar:
    """What a sidecar says; InputError also where the file is a scenario."""
    from vgvt.files.sidecar import Sidecar
    from vgvt.files.strict import load_table

    try:
        return load_table(path, Sidecar)
    except InputError as error:
        raise _not_a_scenario(path, error) from error


def _records_folder(path: Path, sidecar: Sidecar) -> Path:
    """Where the record files of a sidecar lie; InputError where a data set is not on this machine."""
    records = sidecar.records
    if not records.dataset:
        return path.parent / records.folder
    first = (Path(records.folder) / sidecar.run[0].file).as_posix()
    return find_dataset(records.dataset, first) / records.folder


def is_scenario(path: Path) -> bool:
    """Whether a TOML file describes an aircraft and its test, and no records."""
    import tomllib

    try:
        keys = set(tomllib.loads(path.read_text(encoding="utf-8-sig")))
    except (OSError, ValueError):
        return False
    return bool(keys & _OF_SCENARIOS) and not keys & _OF_SIDECARS


def _not_a_scenario(path: Path, error: InputError) -> InputError:
    """The same mistake, unless the file describes no records at all but an aircraft and its test."""
    if not is_scenario(path):
        return error
    return InputError(
        str(path),
        "this is a scenario, not measured records",
        f"simulate it: vgvt run {path}; then give the run folder, or the campaign.nc in it",
    )


def _listed() -> str:
    return ", ".join(measured_names())
