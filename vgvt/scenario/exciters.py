"""Do the exciters fit the rest of a scenario: hammer and runs, several shakers and their commands."""

from __future__ import annotations

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import MisfitError
from vgvt.scenario.hammer import Hammer
from vgvt.scenario.instruments import Acquisition
from vgvt.scenario.rig import RANDOM_KINDS, Excitation, Shaker

# Fewer samples than this in a hit, and what aliases is no longer small.
_FEWEST_SAMPLES = 6


def check_hammer(
    hammer: Hammer | None, excitation: Excitation, acquisition: Acquisition, nodes: tuple[int, ...]
) -> None:
    """MisfitError unless a hammer is there for impacts, its hits are sampled well, and it knows what to hit."""
    if excitation.kind != "impact":
        return
    if hammer is None:
        raise MisfitError(("hammer",), "is missing, and excitation.kind 'impact' needs it", "Add a [hammer] table.")
    if hammer.contact_s * acquisition.sample_rate_hz < _FEWEST_SAMPLES:
        raise MisfitError(
            ("hammer", "tip_stiffness_n_per_m"),
            f"lets a hit last {hammer.contact_s * 1e3:.2g} ms, fewer than {_FEWEST_SAMPLES} samples",
            f"Sample faster than {_FEWEST_SAMPLES / hammer.contact_s:.4g} Hz, or take a softer tip.",
        )
    block_s = excitation.duration_s / (excitation.blocks or 1)
    needed_s = hammer.first_hit_s + 2 * hammer.timing_scatter_s + 2 * hammer.contact_s + hammer.double_hit_interval_s
    if block_s < 2 * needed_s:
        raise MisfitError(
            ("excitation", "blocks"),
            f"leaves {block_s:.3g} s for each hit",
            f"Leave {2 * needed_s:.3g} s at least, and better until the response has died out.",
        )
    unknown = [node for node in hammer.nodes if node not in nodes]
    if unknown:
        raise MisfitError(
            ("hammer", "nodes"),
            f"names node {unknown[0]}, which is not in accelerometers.grid.node",
            "Hit points of the grid.",
        )
    if hammer.nodes and len(hammer.nodes) != len(acquisition.runs):
        raise MisfitError(
            ("hammer", "nodes"),
            f"has {len(hammer.nodes)} entries but acquisition.runs has {len(acquisition.runs)}",
            "Give the node that is hit in each run.",
        )


def check_shakers(
    airframe: Airframe,
    shakers: tuple[Shaker, ...],
    excitation: Excitation,
    acquisition: Acquisition,
    nodes: tuple[int, ...],
) -> None:
    """MisfitError unless every shaker has a place and a number, and their commands can be told apart."""
    for i, shaker in enumerate(shakers[1:]):
        airframe.require_part(("further_shaker", i, "attached_to"), shaker.attached_to)
        if shaker.node in (*nodes, *(s.node for s in shakers[: i + 1])):
            raise MisfitError(
                ("further_shaker", i, "node"), f"is {shaker.node}, which is taken", "Give it a number of its own."
            )
    count, repeats = len(shakers), acquisition.repeats
    key = ("excitation", "shakers")
    if count == 1:
        if excitation.shakers is not None:
            raise MisfitError(key, "is for several shakers, and there is one", "Leave it out, or add a [[shaker]].")
        return
    if excitation.kind == "impact":
        raise MisfitError(("excitation", "kind"), "is 'impact', with two shakers", "A hammer comes without them.")
    if excitation.shaker_signals == "uncorrelated" and excitation.kind not in RANDOM_KINDS:
        raise MisfitError(
            key,
            f"would send copies of one {excitation.kind} to all shakers, which no one can tell apart",
            "Write 'orthogonal' or 'sequential', or a random kind of excitation.",
        )
    if excitation.shaker_signals == "orthogonal" and count & (count - 1):
        raise MisfitError(key, f"is 'orthogonal' for {count} shakers", "That takes two, four or eight.")
    if excitation.shaker_signals != "uncorrelated" and repeats % count:
        raise MisfitError(
            ("acquisition", "repeats"),
            f"is {repeats}, not a multiple of the {count} shakers",
            f"{excitation.shaker_signals} signals need every run {count} times, or a multiple of it.",
        )
