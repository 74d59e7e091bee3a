"""State of the decomposition of one rule."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING

from kg.rules.decompose.uses import Uses, uses
from kg.rules.form import Atom, Element, Variable, has_blank, variables_of
from kg.syntax.lexer import normalise
from kg.syntax.position import place_at

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.errors import Place
    from kg.syntax.tree import Node, RuleText, Span, TriplePattern

AuxiliaryRules = dict[str, list[tuple["tuple[Atom]", "tuple[Element, ...]"]]]
"""The IRI of a predicate to the heads and bodies that derive it."""


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


@dataclass(slots=True)
class Work:
    """One rule: its text, the names that are taken, and the auxiliary rules that its paths need."""

    rule: RuleText
    text: str
    path: str
    auxiliary: AuxiliaryRules = field(default_factory=dict)
    written: str = field(init=False)
    names: Names = field(init=False)
    mentioned: Uses = field(init=False)
    binding: Uses = field(init=False)
    template: frozenset[str] = field(init=False)
    mints_blanks: bool = field(init=False)

    def __post_init__(self) -> None:
        """Count the occurrences of names."""
        self.written = normalise(self.text)
        self.mentioned = uses(self.rule.group.nodes)
        self.binding = uses(self.rule.group.nodes, binding=True)
        self.template = frozenset(chain.from_iterable(map(head_variables, self.rule.template)))
        self.mints_blanks = any(
            has_blank(end) for triple in self.rule.template for end in (triple.subject, triple.object)
        )
        self.names = Names({*self.mentioned, *self.template})

    def place(self, span: Span) -> Place:
        """Return where something begins."""
        return place_at(self.written, span.start, self.path)

    def used_elsewhere(self, names: frozenset[str], node: Node) -> bool:
        """Return whether the pattern mentions one of the variables outside of a node."""
        within = uses([node])
        return any(self.mentioned[name] > within[name] for name in names)

    def bound_elsewhere(self, name: str, node: Node) -> bool:
        """Return whether something outside of a node may bind a variable."""
        return self.binding[name] > uses([node], binding=True)[name]


def head_variables(triple: TriplePattern) -> frozenset[str]:
    """Return the names of the variables in a triple of a template."""
    positions = (triple.subject, triple.predicate, triple.object)
    return frozenset(variable.name for position in positions for variable in variables_of(position))  # type: ignore[arg-type]  # a template has no paths
