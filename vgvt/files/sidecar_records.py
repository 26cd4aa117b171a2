"""The tables of a sidecar that say where its record files are, and what they have in common."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from vgvt.files.delimited_text import check_delimiter
from vgvt.files.strict import Positive, Table


class Source(Table):
    """A public repository that the record files can be fetched from."""

    repository: str = Field(pattern=r"^[\w.-]+/[\w.-]+$")
    """Owner and name, like 'PAAW/mAEWing1'."""
    commit: str
    path: str
    """The folder of the record files inside the repository."""
    base_url: str = Field(default="https://raw.githubusercontent.com", pattern="^https?://")
    licence: str = ""
    licence_text: str = ""
    """Written beside the records when they are fetched, as most licences ask."""

    def url(self, file: str) -> str:
        """Address of one record file."""
        return "/".join((self.base_url.rstrip("/"), self.repository, self.commit, self.path.strip("/"), file))


class Records(Table):
    """What all record files have in common."""

    format: Literal["mat", "npz", "csv", "uff", "tdms"]
    sample_rate_hz: Positive
    dataset: str = ""
    """Name of a data set that is looked up in VGVT_DATA; left out, files lie relative to the sidecar."""
    folder: str = ""
    """Folder of the files, in the data set or relative to the sidecar."""
    samples: str = ""
    """The variable (MAT) or array (npz) that holds the channels; a channel may name another. In TDMS their group."""
    channels_are: Literal["columns", "rows"] = "columns"
    columns: int | None = Field(default=None, ge=1)
    """How many channels a run must have in its file; left out, any number that covers the channel table."""
    time_s: str = ""
    """A variable or channel that holds the time axis, compared with sample_rate_hz and the number of samples."""
    delimiter: str = ","
    skip_rows: int = Field(default=0, ge=0)
    overrides: tuple[Literal["sample_rate_hz"], ...] = ()
    """What the sidecar states against a Universal File or TDMS file that is wrong about it."""

    @field_validator("delimiter")
    @classmethod
    def _one_character(cls, value: str) -> str:
        check_delimiter(value)
        return value

    @model_validator(mode="after")
    def _only_what_the_format_has(self) -> Self:
        if self.format == "csv" and (self.samples or self.time_s):
            raise ValueError("text files have no named variables; leave out samples and time_s")
        if self.format == "uff" and (self.samples or self.time_s or self.channels_are == "rows"):
            raise ValueError(
                "Universal Files hold one time history a channel, with its time axis; "
                "leave out samples, time_s and channels_are"
            )
        if self.format == "tdms" and self.channels_are == "rows":
            raise ValueError("a TDMS file holds its channels one by one; leave out channels_are")
        if self.format not in ("uff", "tdms") and self.overrides:
            raise ValueError("only Universal Files and TDMS state what could be overridden; leave out overrides")
        return self
