"""The exception for bad input: it says where, what is wrong and what to write instead."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input from a person: a file, a table in it, an argument. Commands turn it into exit status 2.

    ``where`` names the file (and line, key path, run or channel) and ``advice``
    says what to write or do instead; both go into the message.
    """

    def __init__(self, where: str, problem: str, advice: str = "") -> None:
        self.where = where
        self.problem = problem
        self.advice = advice
        super().__init__(f"{where}: {problem}" + (f"\n  {advice}" if advice else ""))
