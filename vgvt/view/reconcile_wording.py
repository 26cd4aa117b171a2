"""A reconciliation in words, the same in the terminal and on its page: verdict, what to do, what would refute it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from vgvt.view.reconcile_account import Account, EffectRow, PlaceRow

# An interval whose longer side is so many times the shorter one is none that a deviation describes.
_LOPSIDED = 1.5
# Deviations that are told with decimals; beyond either, with a power of ten.
_SHARPEST, _COARSEST = 1e-4, 1e4
_HALF_A_PER_CENT = 0.005

KINDS = {
    "adequate": "No other effect is needed",
    "explained": "Explained",
    "ambiguous": "Ambiguous: this campaign cannot tell",
    "partly_explained": "Partly explained",
    "unknown": "Not explained by the catalogue",
}
_LOOK = {
    "structure": "on the aircraft that is where to knock and listen.",
    "drive": "look at the force cell, how it is mounted, its cable and its gain.",
    "airframe": "look for what changes all of it at once: temperature, moisture, age, the material it is said to be.",
    "sensor": "look at that sensor, how it is mounted, its cable and its gain.",
}
"""Where to look, by the kind of the place that explains most."""
_NEXT = {
    "adequate": (
        "Use the calibrated scenario; the table of detectability says how large each effect could be, unseen.",
    ),
    "explained": (
        "Check the named effect on the aircraft or the rig; its separating test is the quickest way.",
        "Then go on with reconciled.toml, which holds it.",
    ),
    "ambiguous": (
        "Make the first of the suggested tests, or runs at another level where the reasons ask for them.",
        "Runs of the same rig belong to the campaign: add them and reconcile again. A reading goes into the scenario, "
        "its error into the tolerances.",
        "A changed rig is another campaign with a scenario of its own: reconcile it with --only for every name.",
        "Do not go on with reconciled.toml before that: what it holds is not settled.",
    ),
    "partly_explained": (
        "Take the named effect as a suspicion, not as a finding: what is left may have bent it.",
        "Look where the residual is left, mend or describe what is there, and reconcile again.",
        "Take it out of reconciled.toml, which holds it, unless its separating test confirms it.",
    ),
    "unknown": ("An effect of your own, written for it, can be tried with the same command.",),
}
# In place of the first test, where not even that promises to tell them.
_NONE_TELLS = (
    "None of the tests that were compared is expected to tell all of them apart: look by hand, or make runs at another "
    "level where the reasons ask for them."
)
_NONE_COMPARED = "Make runs at another level where the reasons ask for them, or look by hand: no test was compared."
# A factor of all responses is the same factor of the force, turned over: a ratio is all that is looked at.
_FACTORS = frozenset(
    ("sign-flip", "channel-gain", "gain-drift", "anti-alias-delay", "channel-delay", "high-pass-mismatch")
)
_EITHER = {"response": "force", "force": "response"}
DATA_SETS = {
    "train": "fitted",
    "held_out": "held out, all",
    "held_runs": "held out, whole runs",
    "held_channels": "held out, single channels",
}


def held_once(words: Mapping[str, str], merits: Mapping[str, object]) -> dict[str, str]:
    """The sets of data to show, by key with their words: where one kind is all that is held out, it is told once."""
    kinds = [key for key in ("held_runs", "held_channels") if merits.get(key)]
    return {key: text for key, text in words.items() if len(kinds) == 2 or key not in kinds}


def verdict_sentence(account: Account) -> str:
    """The verdict as one sentence."""
    names = " and ".join(_with_rivals(e) for e in account.effects)
    error = _error_words(account)
    if account.kind == "adequate":
        return f"The calibrated scenario explains the campaign as well as its noise allows{error}."
    if account.kind == "explained":
        return f"What the scenario lacked is {names}{error}."
    if account.kind == "ambiguous":
        return f"The campaign cannot tell what the scenario lacks: it is {names}{error}."
    if account.kind == "partly_explained":
        return f"The scenario lacks {names}, and something else that no effect of the catalogue explains{error}."
    place, thing = account.pointed_at, account.nameless
    where = "" if place is None else f"; the residual points at {_pointed_at(place)}"
    if thing is not None:
        where = f"; one thing without a name, a {thing.words}, fits it best"
    leads = " and ".join(_with_rivals(e) for e in account.leads)
    nearest = f"; what comes nearest, {leads}, is a lead and no name" if leads else ""
    if _nothing_held(account):
        return f"Something is missing, and nothing could be held out that would confirm what it is{where}{nearest}."
    return f"Something is missing that no effect of the catalogue explains{where}{nearest}{error}."


def _pointed_at(place: PlaceRow) -> str:
    """A place within a sentence: of sensors there are many, of the force and the airframe one."""
    return f"{'the ' if place.kind in ('drive', 'airframe') else ''}{place.label}"


def next_steps(account: Account) -> tuple[str, ...]:
    """What to do with the verdict."""
    steps = list(_NEXT[account.kind])
    names = {name for e in account.effects for name in (e.name, *e.equivalent)}
    if len(names) == 1 and account.effects[0].elsewhere:
        only = f"--only {account.effects[0].name}, which is tried at every place"
        steps = [step.replace("--only for every name", only) for step in steps]
    for e in account.effects:
        if e.elsewhere:
            steps.insert(0, f"{e.name} may be {' or '.join(_places_of(e))}: look at each of these places first.")
    place, thing = account.pointed_at, account.nameless
    if thing is not None:
        # Fitted with all that is uncertain, and so better than where most of a residual is.
        steps.insert(0, f"The thing without a name is a {thing.words}: {_LOOK[thing.kind]}")
    elif account.kind == "unknown" and place is not None:
        steps.insert(0, f"The residual points at {_pointed_at(place)}: {_LOOK[place.kind]}")
    if account.kind == "unknown" and _nothing_held(account):
        steps.insert(0, "Add a second run, or more channels, and reconcile again: without them no name is confirmed.")
    best = account.tests[0] if account.tests else None
    tells = best is not None and best.nats >= account.limits["set_nats"]
    if account.kind == "ambiguous" and not tells:
        first = steps.index(_NEXT["ambiguous"][0])
        steps[first : first + 1] = [_NONE_TELLS if account.tests else _NONE_COMPARED, *_tests_by_hand(account.effects)]
    if best is not None and tells:
        words = (
            f"{best.test}: {best.nats:.0f} nats between {best.rivals[0]} and {best.rivals[1]} in {best.minutes:.0f} min"
        )
        steps.insert(0, f"Next test: {words}.")
    if account.leads:
        steps.insert(1, "What comes nearest is a lead: what is missing may act like it, or sit where it does.")
        # How far apart they are in another campaign says little where both miss this one by more.
        steps[2:2] = _tests_by_hand(account.leads)
    return tuple(steps)


def _tests_by_hand(effects: Sequence[EffectRow]) -> list[str]:
    """What would show each effect, and what does as well or nearly so, to be there or not: by hand, once each."""
    known: dict[str, str] = {}
    for effect in effects:
        known |= {name: test for name, test in _own_tests(effect).items() if name not in known}
    return [f"Whether it is {name}: {_sentence(test)}" for name, test in known.items() if test]


def _own_tests(effect: EffectRow) -> dict[str, str]:
    return {effect.name: effect.separating_test, **effect.tests_of_equivalent}


def disproofs(account: Account) -> tuple[str, ...]:
    """What would show the verdict to be wrong, each with its figure."""
    found = [f"{e.name}: {_sentence(e.separating_test)}" for e in account.effects if e.separating_test]
    limit = account.limits["held_out_chi2_per_dof"]
    if account.effects:
        held = _foretold_chi2(account)
        beyond = ", more than that already" if held is not None and held > limit else ""
        reached = "" if held is None else f" (here {held:.2f}{beyond})"
        found.append(
            f"New runs, predicted by reconciled.toml before they are made, that it misses by more than "
            f"{limit:.2f} per degree of freedom{reached}."
        )
        found.append("A repetition with the effect removed from the rig or the aircraft, in which the residual stays.")
    elif account.kind == "adequate":
        found.append(f"A new run that the calibrated scenario misses by more than {limit:.2f} per degree of freedom.")
        found.append("An effect smaller than what the table of detectability says is not refuted by this verdict.")
    else:
        found.append(
            "An effect added to the catalogue that gains enough evidence, also where errors of the model last, and "
            "lowers the held-out error."
        )
        found.append(
            "Noise or a model-form error larger than was assumed: the page says how sigma is made up, under the table "
            "of what the model leaves."
        )
    return tuple(found)


def _foretold_chi2(account: Account) -> float | None:
    """χ² per held-out value of reconciled.toml: what its simulation misses them by, or the fit where there is none."""
    if account.resimulated is None:
        return account.after.figures["held_out_chi2_per_dof"]
    held = account.resimulated["held_out"]
    return None if held is None else held["chi2_per_dof"]


def warnings_of(account: Account, sd: float = 3.0) -> tuple[str, ...]:
    """Calibrated quantities further than ``sd`` standard deviations from what the scenario states."""
    return tuple(
        f"{r.words} needs {r.score:+.1f} stated standard deviations ({r.change})"
        for r in account.posterior
        if r.tolerance and abs(r.score) > sd
    )


def parameter_text(effect: EffectRow) -> str:
    """``mass_kg = 0.0800 ± 0.0021 kg, …``, settings last."""
    numbers = [fitted_text(name, *told, effect.ranges.get(name)) for name, told in effect.parameters.items()]
    return ", ".join(numbers + settings_texts(effect.name, effect.settings, effect.run_numbers))


def in_the_ratio(name: str, settings: Mapping[str, object]) -> bool:
    """Whether an effect multiplies all responses, or the force: A/F does not tell which."""
    return name in _FACTORS and settings.get("channels") in _EITHER


def settings_texts(name: str, settings: Mapping[str, object], run_numbers: Mapping[str, int]) -> list[str]:
    """``channels = 12+Z`` for each setting of an effect; what A/F does not tell it from stands beside it."""
    either = in_the_ratio(name, settings)
    return [
        f"{k} = {v} (or {_EITHER[str(v)]}: A/F does not tell)"
        if either and k == "channels"
        else setting_text(k, v, run_numbers)
        for k, v in settings.items()
    ]


def setting_text(name: str, value: object, run_numbers: Mapping[str, int]) -> str:
    """``from_run = 3 (run 4 of the campaign)``: a run that is counted, with what the campaign calls it if not that."""
    number = run_numbers.get(name, value)
    return f"{name} = {value}" if number == value else f"{name} = {value} (run {number} of the campaign)"


def ratio_words(name: str) -> str:
    """Where to look for what multiplies all responses, or the force."""
    alike = (
        "all responses the wrong way round from the force the wrong way round"
        if name == "sign-flip"
        else f"{name} of all responses from the opposite of the force"
    )
    return (
        f"A/F does not tell {alike}: look at the force gauge, its plug, cable and amplifier, and at what all "
        "responses share"
    )


def fitted_text(name: str, value: float, std: float, unit: str, interval: tuple[float, float] | None = None) -> str:
    """``mass_kg = 0.0800 ± 0.0021 kg``, or with its 95 % interval where that is lopsided.

    What stands at the end of what is tried has no deviation, and is not sharp.
    """
    if std == 0:
        return f"{name} = {value:.4g} {unit}".rstrip() + " (the end of what is tried)"
    if interval is not None and max(lopsided := (value - interval[0], interval[1] - value)) > _LOPSIDED * min(lopsided):
        return f"{name} = {value:.3g} {unit}".rstrip() + f" (95 % from {interval[0]:.3g} to {interval[1]:.3g})"
    return f"{name} = {_as_sharp_as_known(value, std)} {unit}".rstrip()


def _as_sharp_as_known(value: float, std: float) -> str:
    """``12.002 ± 0.019``: to the second digit of the deviation, and no further."""
    if not _SHARPEST <= std < _COARSEST:
        return f"{value:.4g} ± {std:.2g}"
    decimals = max(0, 1 - math.floor(math.log10(std)))
    return f"{value:.{decimals}f} ± {std:.{decimals}f}"


def as_well(equivalent: Sequence[str], elsewhere: Sequence[str]) -> list[str]:
    """What explains the data as well as a name does: other names, and itself at other places, in words."""
    return [*equivalent, *(f"the same {where}" for where in elsewhere)]


def _with_rivals(effect: EffectRow) -> str:
    name, where = effect.name, " or ".join(_places_of(effect))
    if where:
        name += f" ({where})" if effect.equivalent else f" {where}"
    return " or ".join((name, *effect.equivalent))


def _places_of(effect: EffectRow) -> tuple[str, ...]:
    """All places where a name may be, its own first; none where that is settled."""
    others = effect.elsewhere
    return tuple(dict.fromkeys((*(p.not_there for p in others[:1]), *(p.where for p in others))))


def _nothing_held(account: Account) -> bool:
    """Whether no data were left to confirm a name, so that whatever explains them best has none."""
    return account.before.merits.get("held_out") is None


def _error_words(account: Account) -> str:
    before, after = account.before.merits.get("held_out"), account.after.merits.get("held_out")
    if before is None or after is None:
        return "; nothing could be held out"
    if account.kind == "adequate":
        return f"; on held-out data it fits to {before['nrmse_percent']:.1f} %"
    # Resonances rule an NRMSE: what is missing between them may be worth a third of a per cent.
    missed = f"{before['chi2_per_dof']:.2f}" + (f" → {after['chi2_per_dof']:.2f}" if account.changed else "")
    most = account.limits["held_out_chi2_per_dof"]
    return f"; held-out data: χ² per degree of freedom {missed}, at most {most:.2f} where nothing is missing"


def _sentence(text: str) -> str:
    return text if text.endswith(".") else f"{text}."


def share_words(explained: float) -> str:
    """What a place explains of the residual, beyond chance: ``12 %``; less than chance, by however much, is nothing."""
    return f"{100 * explained:.0f} %" if explained >= _HALF_A_PER_CENT else "nothing"
