"""A modal model as JSON, and back: what identify prints is what score reads."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vgvt.data import Dof, InputError, ModalModel, Outcome, PoleCandidate
from vgvt.files.claim_residues import read_residues, residue_document
from vgvt.files.claim_values import (
    BadKeyError,
    band,
    check_once,
    damping_ratio,
    degree_of_freedom,
    number,
    number_or_nan,
    settings,
    text,
    texts,
    value_of,
    yes_or_no,
)

_ADVICE = "write it with: vgvt identify CAMPAIGN --identifier NAME --json > claim.json"


@dataclass(frozen=True, slots=True)
class Claim:
    """What an identifier said about a campaign in a band; ``campaign`` is its name, empty where a file does not say."""

    identifier: str
    band_hz: tuple[float, float]
    model: ModalModel
    campaign: str = ""


def mode_documents(model: ModalModel) -> list[dict[str, Any]]:
    """One document a mode, with the keys of the contract; what is not known is None."""
    count = len(model)
    unknown = np.full(count, np.nan)
    frequency_std = unknown if model.natural_frequency_std_hz is None else model.natural_frequency_std_hz
    damping_std = unknown if model.damping_ratio_std is None else model.damping_ratio_std
    documents = []
    for k in range(count):
        document: dict[str, Any] = {
            "frequency_hz": model.natural_frequency_hz[k],
            "frequency_std_hz": frequency_std[k],
            "damping_ratio": model.damping_ratio[k],
            "damping_ratio_std": damping_std[k],
            "shape": [
                {"dof": dof.label, "real": value.real, "imag": value.imag}
                for dof, value in zip(model.dofs, model.shapes[k], strict=True)
            ],
            "label": model.labels[k] if model.labels else "",
            "flags": list(model.flags[k]) if model.flags else [],
        }
        if model.modal_mass_kg is not None:
            document["modal_mass_kg"] = model.modal_mass_kg[k]
        peak_hz = _sigma_peak_hz(document["flags"])
        if peak_hz is not None:
            document["sigma_peak_hz"] = peak_hz
        documents.append(document)
    return documents


def _sigma_peak_hz(flags: list[str]) -> float | None:
    prefix = "sigma_peak_hz="
    return next((float(flag.removeprefix(prefix)) for flag in flags if flag.startswith(prefix)), None)


def claim_document(claim: Claim, candidates: bool = False) -> dict[str, Any]:
    """The document of ``vgvt identify`` and of a file under claims/, with the ``candidates`` when asked for."""
    document: dict[str, Any] = {
        "identifier": claim.identifier,
        "campaign": claim.campaign or None,
        "band_hz": list(claim.band_hz),
        "outcome": claim.model.outcome.value,
        "output_only": claim.model.output_only,
        "method": claim.model.method,
        "settings": dict(claim.model.settings),
        "advice": list(claim.model.advice),
        "modes": mode_documents(claim.model),
        "residues": residue_document(claim.model),
    }
    if candidates:
        document["candidates"] = [asdict(candidate) for candidate in claim.model.candidates]
    return document


def read_claim(path: Path) -> Claim:
    """Read a claim; InputError names the file and the key that is wrong."""
    try:
        document = _document(path)
        return Claim(
            identifier=text(document, "identifier", needed=True),
            band_hz=band(value_of(document, "band_hz")),
            model=_model(document),
            campaign=text(document, "campaign"),
        )
    except InputError:
        raise
    except BadKeyError as error:
        raise InputError(f"{path}: {error.key}", error.problem, _ADVICE) from None
    except RecursionError:
        raise InputError(str(path), "its lists are nested too deeply for a claim", _ADVICE) from None
    except ValueError as error:
        raise InputError(str(path), str(error), _ADVICE) from None


def _document(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(str(path), "there is no such file", _ADVICE) from None
    except IsADirectoryError:
        raise InputError(str(path), "this is a folder, not a claim", _ADVICE) from None
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check its permissions") from error
    except ValueError as error:
        # Undecodable bytes, text that is no JSON, and numbers of thousands of digits.
        raise InputError(str(path), f"not a JSON document ({error})", _ADVICE) from None
    if not isinstance(document, dict):
        raise InputError(str(path), "a claim is a JSON object", _ADVICE)
    return document


def _model(document: dict[str, Any]) -> ModalModel:
    outcome = str(document.get("outcome", Outcome.FOUND.value))
    if outcome not in {o.value for o in Outcome}:
        raise BadKeyError("outcome", f"{outcome!r} is none of {', '.join(o.value for o in Outcome)}")
    modes = value_of(document, "modes")
    if not isinstance(modes, list):
        raise BadKeyError("modes", "expected a list of modes")
    rows = [_Mode.read(mode, f"modes[{k}]") for k, mode in enumerate(modes)]
    dofs = rows[0].dofs if rows else ()
    for k, row in enumerate(rows):
        if row.dofs != dofs:
            raise BadKeyError(f"modes[{k}].shape", "its DOFs differ from those of modes[0]")
    try:
        references, residues = read_residues(document.get("residues"), len(rows), len(dofs))
    except ValueError as error:
        raise BadKeyError("residues", str(error)) from None
    return ModalModel(
        natural_frequency_hz=np.array([row.frequency_hz for row in rows]),
        damping_ratio=np.array([row.damping_ratio for row in rows]),
        shapes=np.array([row.shape for row in rows], dtype=complex).reshape(len(rows), len(dofs)),
        dofs=dofs,
        natural_frequency_std_hz=np.array([row.frequency_std_hz for row in rows]),
        damping_ratio_std=np.array([row.damping_ratio_std for row in rows]),
        references=references,
        residues=residues,
        labels=tuple(row.label for row in rows),
        flags=tuple(row.flags for row in rows),
        method=text(document, "method"),
        outcome=Outcome(outcome),
        advice=texts(document, "advice"),
        settings=settings(document),
        candidates=_candidates(document),
        output_only=yes_or_no(document, "output_only"),
    )


def _candidates(document: dict[str, Any]) -> tuple[PoleCandidate, ...]:
    rows = document.get("candidates")
    if rows is None:
        return ()
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise BadKeyError("candidates", "expected a list of poles")
    return tuple(_candidate(row, f"candidates[{k}]") for k, row in enumerate(rows))


def _candidate(row: dict[str, Any], where: str) -> PoleCandidate:
    order, kept = number(row, "order", where, 0), value_of(row, "kept", where)
    if not order.is_integer():
        raise BadKeyError(f"{where}.order", f"expected a whole number, got {order:g}")
    if not isinstance(kept, bool):
        raise BadKeyError(f"{where}.kept", "expected true or false")
    return PoleCandidate(
        frequency_hz=number(row, "frequency_hz", where),
        damping_ratio=number(row, "damping_ratio", where),
        order=int(order),
        kept=kept,
        reason=text(row, "reason", where),
    )


@dataclass(frozen=True, slots=True)
class _Mode:
    frequency_hz: float
    frequency_std_hz: float
    damping_ratio: float
    damping_ratio_std: float
    dofs: tuple[Dof, ...]
    shape: tuple[complex, ...]
    label: str
    flags: tuple[str, ...]

    @classmethod
    def read(cls, mode: Any, where: str) -> _Mode:
        if not isinstance(mode, dict):
            raise BadKeyError(where, "expected an object")
        points = value_of(mode, "shape", where)
        if not isinstance(points, list) or not all(isinstance(point, dict) for point in points):
            raise BadKeyError(f"{where}.shape", 'expected a list of {"dof", "real", "imag"}')
        dofs = tuple(degree_of_freedom(point, f"{where}.shape[{i}]") for i, point in enumerate(points))
        check_once(dofs, f"{where}.shape")
        return cls(
            frequency_hz=number(mode, "frequency_hz", where, 0),
            frequency_std_hz=number_or_nan(mode, "frequency_std_hz", where, 0),
            damping_ratio=damping_ratio(mode, where),
            damping_ratio_std=number_or_nan(mode, "damping_ratio_std", where, 0),
            dofs=dofs,
            shape=tuple(
                complex(number(point, "real", f"{where}.shape[{i}]"), number(point, "imag", f"{where}.shape[{i}]"))
                for i, point in enumerate(points)
            ),
            label=text(mode, "label", where),
            flags=texts(mode, "flags", where),
        )
