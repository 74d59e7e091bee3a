"""Short form of rules and triples, for tests of evaluation independent of notations."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from kg.errors import Place
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.form import Atom, Expression, Filter, Rule, Variable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.rules.form import Element, Pattern

__all__ = ["atom", "atoms", "expression", "position", "rule", "rule_set", "test", "triples"]


def position(text: str) -> Pattern:
    """Parse `?x`, `:name` (an IRI), `_:label`, `=iri` (in full), or a number."""
    if text.startswith("?"):
        return Variable(text[1:])
    if text.startswith("_:"):
        return BlankNode(text[2:])
    if text.startswith(":"):
        return NamedNode(f"urn:x:{text[1:]}")
    return NamedNode(text[1:]) if text.startswith("=") else Literal(int(text))


def atom(text: str, *, asserted: bool = False) -> Atom:
    """Parse `?x :parent ?y`."""
    subject, predicate, value = map(position, text.split())
    return Atom(subject, predicate, value, asserted)


def atoms(text: str) -> tuple[Atom, ...]:
    """Parse atoms separated by ` . `."""
    return tuple(atom(part) for part in text.split(" . "))


def expression(text: str, *, mints: bool = False) -> Expression:
    """Make an expression whose only question marks are those of its variables."""
    return Expression(text, tuple(dict.fromkeys(re.findall(r"\?(\w+)", text))), mints)


def test(text: str) -> Filter:
    """Make a filter."""
    return Filter(expression(text))


def rule(head: str, *body: str | Element, name: str = "test/rule", part: int = 1) -> Rule:
    """Make a rule; parts of the body that are text are atoms."""
    elements: list[Element] = []
    for element in body:
        elements.extend(atoms(element) if isinstance(element, str) else [element])
    return Rule(name, atoms(head), tuple(elements), Place(f"{name}.rq"), part)


def rule_set(rules: Sequence[Rule], data: Iterable[Triple] = ()) -> RuleSet:
    """Make a set of one file."""
    return RuleSet((RuleFile("test/rule", Path("test/rule.srl"), "", Documentation(), tuple(rules), tuple(data)),))


def triples(text: str) -> list[Triple]:
    """Parse triples without variables, one on each line."""
    read = (map(position, line.split()) for line in text.strip().splitlines())
    return [Triple(*parts) for parts in read]  # type: ignore[arg-type] # no variables
