"""A claim's file holds the poles that were weighed when that is asked for, and only then."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import Dof, InputError, ModalModel, PoleCandidate
from vgvt.files.claim import Claim, claim_document, read_claim

CANDIDATES = (PoleCandidate(8.0, 0.01, 2, True, "steady"), PoleCandidate(9.5, -0.2, 3, False, "unstable"))


def claim() -> Claim:
    dofs = (Dof.from_label("1+Z"),)
    model = ModalModel(np.array([8.0]), np.array([0.01]), np.ones((1, 1), complex), dofs, candidates=CANDIDATES)
    return Claim("plscf", (3.0, 35.0), model)


def test_candidates_come_back_when_they_were_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "claim.json"
    for wanted, back in ((True, CANDIDATES), (False, ())):
        document = claim_document(claim(), candidates=wanted)
        assert ("candidates" in document) is wanted
        path.write_text(json.dumps(document, default=float).replace("NaN", "null"))
        assert read_claim(path).model.candidates == back


def test_a_bad_candidate_is_named(tmp_path: Path) -> None:
    document = claim_document(claim(), candidates=True)
    document["candidates"][1]["order"] = "many"
    path = tmp_path / "claim.json"
    path.write_text(json.dumps(document, default=float).replace("NaN", "null"))
    with pytest.raises(InputError, match=r"candidates\[1\].order"):
        read_claim(path)
