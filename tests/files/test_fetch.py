"""Fetching records from a web server: checked, taken up again, and clear when it fails."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.files import open_campaign
from vgvt.files.fetch import DownloadError, fetch_described, fetch_measured
from vgvt.files.manifest import file_sha256

PREFIX = "/someone/records/abc123/Data/"


class Server(HTTPServer):
    """Serves files from memory; faults make an answer fail a number of times."""

    content: dict[str, bytes]
    faults: dict[str, list[str]]
    asked: list[str]


class Handler(BaseHTTPRequestHandler):
    """Answers GET with what the server holds, or with the next fault listed for the file."""

    server: Server

    def do_GET(self) -> None:
        name = self.path.removeprefix(PREFIX)
        self.server.asked.append(name)
        fault = self.server.faults[name].pop(0) if self.server.faults.get(name) else ""
        body = self.server.content.get(name)
        if body is None or fault in ("404", "503"):
            self.send_error(int(fault or 404))
            return
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if fault == "cut":
            body = body[: len(body) // 2]
        if fault == "corrupt":
            body = bytes([body[0] ^ 1]) + body[1:]
        self.wfile.write(body)

    def log_message(self, *args: object) -> None:
        """Stay silent."""


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    """A web server on this machine, asked without a proxy."""
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    server = Server(("127.0.0.1", 0), Handler)
    server.content, server.faults, server.asked = {}, {}, []
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def described(bench: Path, server: Server) -> Path:
    """The bench's sidecar with its record files moved to the server."""
    text = bench.read_text(encoding="utf-8")
    for k in (1, 2):
        path = bench.parent / f"raw/run{k}.mat"
        text = text.replace(f'file = "run{k}.mat"', f'file = "run{k}.mat"\nsha256 = "{file_sha256(path)}"')
        server.content[path.name] = path.read_bytes()
        path.unlink()
    source = f"""
[source]
base_url = "http://127.0.0.1:{server.server_port}"
repository = "someone/records"
commit = "abc123"
path = "Data"
licence_text = "Do what you like."
"""
    bench.write_text(text + source, encoding="utf-8")
    return bench


def test_fetched_records_open(described: Path, server: Server, tmp_path: Path) -> None:
    told: list[tuple[float, str]] = []
    folder = fetch_described(described, tmp_path / "target", lambda fraction, words: told.append((fraction, words)))
    assert folder == tmp_path / "target" / "bench-beam"
    assert {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()} == {
        "LICENSE",
        "raw/run1.mat",
        "raw/run2.mat",
    }
    assert [f for f, _ in told] == [0.0, 0.5, 1.0]
    (folder / "bench.toml").write_text(described.read_text(encoding="utf-8"), encoding="utf-8")
    assert len(open_campaign(folder / "bench.toml").runs) == 2


def test_only_what_is_missing_or_damaged_is_fetched_again(described: Path, server: Server, tmp_path: Path) -> None:
    folder = fetch_described(described, tmp_path / "t")
    (folder / "raw/run2.mat").write_bytes(b"damaged")
    server.asked.clear()
    fetch_described(described, tmp_path / "t")
    assert server.asked == ["run2.mat"]
    assert (folder / "raw/run2.mat").read_bytes() == server.content["run2.mat"]


@pytest.mark.parametrize("fault", ["cut", "corrupt", "503"])
def test_a_transfer_that_fails_once_is_tried_again(described: Path, server: Server, tmp_path: Path, fault: str) -> None:
    server.faults["run1.mat"] = [fault]
    folder = fetch_described(described, tmp_path / "t")
    assert (folder / "raw/run1.mat").read_bytes() == server.content["run1.mat"]
    assert server.asked == ["run1.mat", "run1.mat", "run2.mat"]


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("cut", r"cut after \d+ of \d+ bytes|IncompleteRead"),
        ("corrupt", "does not have the SHA-256"),
        ("503", "answered 503"),
        ("404", "answered 404"),
    ],
)
def test_a_transfer_that_keeps_failing_leaves_nothing_half_done(
    described: Path, server: Server, tmp_path: Path, fault: str, message: str
) -> None:
    server.faults["run2.mat"] = [fault] * 5
    with pytest.raises(DownloadError, match=message) as caught:
        fetch_described(described, tmp_path / "t")
    assert "run2.mat" in str(caught.value)
    left = [p.name for p in (tmp_path / "t").rglob("*") if p.is_file()]
    assert left == ["run1.mat"], "the sound file stays, no partial one takes a name"
    server.faults.clear()
    server.asked.clear()
    fetch_described(described, tmp_path / "t")
    assert server.asked == ["run2.mat"]


def test_no_network_is_told(described: Path, server: Server, tmp_path: Path) -> None:
    text = described.read_text(encoding="utf-8")
    # Port 9 (discard) is not served.
    described.write_text(text.replace(f":{server.server_port}", ":9"), encoding="utf-8")
    with pytest.raises(DownloadError, match="connection failed"):
        fetch_described(described, tmp_path / "t")


def test_a_sidecar_without_source_or_hash_cannot_be_fetched(bench: Path, described: Path, tmp_path: Path) -> None:
    text = described.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("sha256")]
    described.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match="gives no SHA-256"):
        fetch_described(described, tmp_path / "t")
    described.write_text(text.split("[source]")[0], encoding="utf-8")
    with pytest.raises(InputError, match="has no public source"):
        fetch_described(described, tmp_path / "t")


def test_names_are_checked_before_anything_is_fetched(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'hati-2015-09-24"):
        fetch_measured("hati", tmp_path)
    with pytest.raises(InputError, match="a copy made from other records"):
        fetch_measured("hati-2015-09-24-200hz", tmp_path)


def test_the_public_address_of_a_record() -> None:
    from vgvt.files.open import shipped_sidecar
    from vgvt.files.sidecar import Sidecar
    from vgvt.files.strict import load_table

    source = load_table(shipped_sidecar("hati-2015-09-24"), Sidecar).source
    assert source is not None
    assert source.url("run_Run1.mat") == (
        "https://raw.githubusercontent.com/PAAW/mAEWing1/c513924951af1ba1202023ed5157b789593ffce4/"
        "Test-and-Analysis/GVT/Sept_24_Hati_WS3_Unsymmetric/Data/run_Run1.mat"
    )
