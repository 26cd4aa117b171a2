"""The stiffness of a rigid root that several hypotheses give laws: the first one's, whatever the others' own are.

A fit has one parameter too many there, and a scenario must not state it: it refuses two stiffnesses of one root.
"""

from __future__ import annotations

from collections.abc import Mapping

from vgvt.effects.acting import acted
from vgvt.effects.elements import JointLaw
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.prediction.grouping import effects_at
from vgvt.reconcile.question.uncertain import edited

GIVEN = "root_stiffness_n_m_per_rad"
"""The parameter of effects that says how stiff a root is which they do not find jointed."""


def idle_parameters(fit: Fit, index: int) -> frozenset[str]:
    """The parameters of a hypothesis that do nothing in a fit: the stiffness of roots which it found jointed."""
    laws = _laws(fit)[index - len(fit.hypotheses)] if _gives(fit, index) else ()
    return frozenset({GIVEN} if laws and not any(law.root and law.root.was_rigid for law in laws) else ())


def agreed(fit: Fit, index: int, values: Mapping[str, object]) -> tuple[dict[str, object], ...]:
    """Settings and ``values`` of a hypothesis as a scenario can state them beside the others: once, or once a side.

    Roots that another effect has made have the stiffness which that gave them.
    """
    stated = {**fit.hypotheses[index].settings, **values}
    if not _gives(fit, index):
        return (stated,)
    laws = _laws(fit)
    made = {(law.beam, law.kind) for several in laws for law in several if law.root and law.root.was_rigid}
    mine = laws[index - len(fit.hypotheses)]
    wanted = {law.beam: law.stiffness_n_m_per_rad for law in mine if (law.beam, law.kind) in made}
    if not wanted:
        return (stated,)
    if len(set(wanted.values())) == 1:
        return ({**stated, GIVEN: next(iter(wanted.values()))},)
    return tuple({**stated, "side": beam.rpartition("-")[2], GIVEN: k} for beam, k in wanted.items())


def _gives(fit: Fit, index: int) -> bool:
    return any(p.name == GIVEN for p in fit.hypotheses[index].parameters)


def _laws(fit: Fit) -> list[tuple[JointLaw, ...]]:
    """What the scenario's own effects, then the hypotheses', say of roots: the same in every run."""
    problem = fit.problem
    effects = effects_at(problem, fit.hypotheses, fit.e)
    if effects is None:
        return [()] * len(fit.hypotheses)
    _, actions = acted(effects, edited(problem.scenario, problem.unknowns, fit.u[: len(problem.unknowns)]), 0)
    return [tuple(e for e in action.elements if isinstance(e, JointLaw) and e.root is not None) for action in actions]
