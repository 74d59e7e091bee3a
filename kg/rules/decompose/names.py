"""Names that no variable of a rule has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules.form import Variable

if TYPE_CHECKING:
    from collections.abc import Iterable


class Names:
    """Gives new variables; `taken` are the names that the rule has, blank nodes' with their `.`."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)

    def hidden(self) -> Variable:
        """Return a variable that no expression and no text will mention: its name begins with `.`."""
        return self._first(".{}")

    def like(self, variable: Variable) -> Variable:
        """Return a variable that SPARQL can write, named after another."""
        return self._first(variable.name.lstrip(".").partition("·")[0] + "·{}")

    def _first(self, form: str) -> Variable:
        number = 1
        while (name := form.format(number)) in self._taken:
            number += 1
        self._taken.add(name)
        return Variable(name)
