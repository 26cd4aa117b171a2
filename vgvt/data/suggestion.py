"""Did-you-mean: the known word nearest to a mistyped one."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches

# More names than this are a wall of text where one of them is meant.
_MANY = 20


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word that a person most likely meant, or None where nothing is close."""
    by_folded = {k.casefold(): k for k in known}
    typed = word.casefold()
    match = get_close_matches(typed, list(by_folded), n=1, cutoff=0.6)
    # A shortened name is too far from the whole one for a measure of likeness.
    longer = sorted(k for k in by_folded if len(typed) > 2 and k.startswith(typed))
    # So is one of its words; where several names have it, none of them is nearer.
    holding = [k for k in by_folded if typed in _words(k)]
    turned = [k for k in by_folded if _words(k) == _words(typed)]
    found = turned or match or longer or (holding if len(holding) == 1 else [])
    return by_folded[found[0]] if found else None


def _words(name: str) -> list[str]:
    """The words of a name, in alphabetical order: which comes first is easily mistaken."""
    return sorted(re.split(r"[-_. ]", name))


def choose_one_of(word: str, known: Iterable[str]) -> str:
    """Advice for a person: ``did you mean 'x'?`` where one is close, then the whole list, unless it is long."""
    names = sorted(known)
    guess = nearest(word, names)
    if guess and len(names) > _MANY:
        return f"did you mean {guess!r}?"
    question = f"did you mean {guess!r}? " if guess else ""
    return f"{question}choose one of: {', '.join(names)}"
