"""``vgvt doctor`` where something around it is missing: a home folder, the current folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.cli.doctor import Finding, examine


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Without the processes that try MuJoCo, which take a second each."""
    monkeypatch.setattr("vgvt.cli.doctor._in_process", lambda *_: "")
    return monkeypatch


def found(check: str) -> list[Finding]:
    """What the examination says of one check, while none of them breaks."""
    findings = examine()
    assert "fail" not in {finding.status for finding in findings}, findings
    return [finding for finding in findings if finding.check == check]


@pytest.mark.parametrize("data", ["", "~nobody-of-this-name/x"])
def test_no_home_folder_is_a_warning(quick: pytest.MonkeyPatch, data: str) -> None:
    def nowhere() -> Path:
        raise RuntimeError("Could not determine home directory.")

    quick.setattr(Path, "home", nowhere)
    quick.delenv("XDG_DATA_HOME", raising=False)
    quick.setenv("VGVT_DATA", data)
    first = found("data")[0]
    assert first.status == "warn" and "home folder" in first.detail
    assert ("path in full" if data else "set HOME, XDG_DATA_HOME or VGVT_DATA") in first.advice


def test_a_current_folder_that_was_removed_is_named(quick: pytest.MonkeyPatch, tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    quick.chdir(gone)
    quick.setenv("PWD", str(gone))
    gone.rmdir()
    (finding,) = found("writing")
    assert finding.status == "warn" and f"{gone} cannot be used" in finding.detail
    assert "cd FOLDER" in finding.advice
