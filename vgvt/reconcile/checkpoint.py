"""What a reconciliation has found so far, on disk: a run that was broken off goes on after its last whole round."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import vgvt
from vgvt.data import Campaign
from vgvt.effects.registry import available_effects
from vgvt.files.atomically import replacing
from vgvt.files.campaign_file import content_hash
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.prediction.local_slopes import Origin
from vgvt.reconcile.question.effect_code import code_of
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.scenario.model import Scenario
from vgvt.scenario.write import to_toml

# What is kept under another one has not all that is asked for.
_FORMAT = 7


class Begun(NamedTuple):
    """The null model, the rounds that were whole, and what was refused in them."""

    start: Fit
    rounds: tuple[Addition, ...]
    vetoed: tuple[Rival, ...]


def provenance_of(
    campaign: Campaign,
    scenario: Scenario,
    effects: Mapping[str, type] | Iterable[str],
    thresholds: Thresholds,
    lines: int,
) -> dict[str, str]:
    """What a verdict rests on, by name: hashes of samples, scenario and effects, the version, and the limits.

    ``effects`` are those that are tried, classes by name; a name alone stands for the installed one.
    """
    tried = effects if isinstance(effects, Mapping) else _installed(effects)
    return {
        "campaign": f"{campaign.name} ({content_hash(campaign)[:16]}, band {campaign.band_hz[0]:g} to "
        f"{campaign.band_hz[1]:g} Hz)",
        "scenario": f"{scenario.name} ({hashlib.sha256(to_toml(scenario).encode()).hexdigest()[:16]})",
        "version": vgvt.__version__,
        "hypotheses": f"{' '.join(sorted(tried))} ({code_of(tried, scenario)[:16]})",
        "lines": str(lines),
        "thresholds": f"{thresholds.evidence_nats:g} nats, {thresholds.chi2_per_dof:g} per degree of freedom "
        f"({_hashed(thresholds)}); {thresholds.provenance}",
    }


def _installed(names: Iterable[str]) -> dict[str, type]:
    known = available_effects()
    return {name: known.get(name, object) for name in names}


def _hashed(thresholds: Thresholds) -> str:
    """A hash of every limit: what is decided by one of them must not be taken for what another one would say."""
    return hashlib.sha256(json.dumps(asdict(thresholds), sort_keys=True).encode()).hexdigest()[:16]


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """Rounds kept in a file under a key; what was kept under another key is not used."""

    file: Path
    key: str

    @classmethod
    def of(cls, file: Path, provenance: Mapping[str, str], *settings: object) -> Checkpoint:
        """The checkpoint of a question: everything in its provenance, and any further settings."""
        text = json.dumps([_FORMAT, sorted(provenance.items()), [str(s) for s in settings]])
        return cls(file, hashlib.sha256(text.encode()).hexdigest())

    def keep(self, start: Fit, rounds: Sequence[Addition], vetoed: Sequence[Rival] = ()) -> None:
        """Write the rounds so far, and which of their rivals were refused."""
        document = {
            "key": self.key, "start": _ended(start),
            "rounds": [_round(a) for a in rounds],
            "vetoed": [(k, i) for k, a in enumerate(rounds) for i, r in enumerate(a.rivals) if r in vetoed],
        }  # fmt: skip
        with replacing(self.file) as part:
            part.write_text(json.dumps(document), encoding="utf-8")

    def begun(self, problem: Problem, hypotheses: Sequence[Hypothesis]) -> Begun | None:
        """The null model and the rounds that were kept, or None where there are none of this question."""
        try:
            document = json.loads(self.file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        if not isinstance(document, dict) or document.get("key") != self.key:
            return None
        known = {h.name: h.cls for h in hypotheses}
        start = _as_ended(problem, (), document["start"])
        rounds = tuple(_addition(problem, known, row) for row in document["rounds"])
        vetoed = tuple(rounds[k].rivals[i] for k, i in document["vetoed"])
        return Begun(start, rounds, vetoed)


def _round(addition: Addition) -> dict[str, Any]:
    return {
        "rivals": [_rival(r) for r in addition.rivals],
        "winner": addition.rivals.index(addition.winner),
        "equivalent": [addition.rivals.index(r) for r in addition.equivalent],
        "held_out_before": addition.held_out_before,
        "exchanged": addition.exchanged,
        "in_its_place": [_rival(r) for r in addition.in_its_place],
    }


def _rival(r: Rival) -> dict[str, Any]:
    return {
        "effects": [
            {"name": h.name, "settings": dict(h.settings), "share": h.share, "spans": dict(h.spans), "places": h.places}
            for h in r.fit.hypotheses
        ],
        "fit": _ended(r.fit),
        "gain_nats": r.gain_nats, "raw_nats": r.raw_nats, "lasting_nats": r.lasting_nats, "held_out": r.held_out,
    }  # fmt: skip


def _addition(problem: Problem, known: Mapping[str, type], row: Mapping[str, Any]) -> Addition:
    rivals, in_its_place = (
        tuple(_as_rival(problem, known, r) for r in row[kept]) for kept in ("rivals", "in_its_place")
    )
    equivalent = tuple(rivals[k] for k in row["equivalent"])
    winner = rivals[row["winner"]]
    return Addition(winner, equivalent, rivals, row["held_out_before"], in_its_place, row["exchanged"])


def _as_rival(problem: Problem, known: Mapping[str, type], row: Mapping[str, Any]) -> Rival:
    hypotheses = tuple(
        Hypothesis(
            known[h["name"]],
            h["settings"],
            h["share"],
            {k: (v[0], v[1]) for k, v in h.get("spans", {}).items()},
            h.get("places", 1),
            problem.measured.run_numbers,
        )
        for h in row["effects"]
    )
    found = _as_ended(problem, hypotheses, row["fit"])
    return Rival(found, row["gain_nats"], row["raw_nats"], row["lasting_nats"], row["held_out"])


def _ended(found: Fit) -> dict[str, Any]:
    """Where a fit ended and what it reached there, where its slopes were taken, and whether they hold what follows."""
    origin = None if found.origin is None else [found.origin.u.tolist(), found.origin.e.tolist()]
    scores = {"u": found.u.tolist(), "e": found.e.tolist(), "origin": origin}
    reached = {"evidence_nats": found.evidence_nats, "chi2": found.chi2, "converged": found.converged}
    return {**scores, **reached, "followed": found.followed}


def _as_ended(problem: Problem, hypotheses: tuple[Hypothesis, ...], row: Mapping[str, Any]) -> Fit:
    """The same fit, no step further: evidence hangs on its slopes, too.

    What it reached is kept: structures assembled anew are the same to round-off of differences, 1e-5 of a nat.
    """
    taken = None if row["origin"] is None else [np.array(scores) for scores in row["origin"]]
    origin = None if taken is None else Origin(taken[0], taken[1])
    u, e = np.array(row["u"]), np.array(row["e"])
    found = fit(problem, hypotheses, u, e, (), origin=origin, follow=row["followed"])
    return replace(found, **{name: row[name] for name in ("evidence_nats", "chi2", "converged")})
