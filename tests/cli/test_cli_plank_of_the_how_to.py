"""The frequencies that the how-to states of its plank are those that its commands print."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs/how-to/write-your-own-scenario.md"


def test_the_page_states_the_bare_and_the_tested_frequencies_as_they_come_out(vgvt, tmp_path: Path) -> None:
    text = PAGE.read_text(encoding="utf-8")
    (scenario,) = (block for block in re.findall(r"```toml\n(.*?)```", text, re.S) if 'name = "plank"' in block)
    plank = tmp_path / "plank.toml"
    plank.write_text(scenario, encoding="utf-8")
    document = vgvt("show", str(plank), "--no-picture", "--json").document
    told = text[text.index("The first two bending frequencies") :]
    tested, bare = re.findall(r"(\d+\.\d\d)(?: Hz)? and (\d+\.\d\d) Hz", told)[:2]
    for said, modes in ((tested, document["as_tested"]), (bare, document["modes"])):
        bending = [mode["frequency_hz"] for mode in modes if "bending" in mode["label"]][:2]
        assert said == tuple(f"{hertz:.2f}" for hertz in bending)
