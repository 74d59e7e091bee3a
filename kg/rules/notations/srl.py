"""SPARQL 1.2 RL as the internal form: well-formedness (section 3.2 of the text), paths as triples, data as triples.

The bodies of SPARQL RL are those of the internal form, element by element, in their order.
"""

from __future__ import annotations

from hashlib import sha256
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from kg.errors import RuleError
from kg.rules.decompose.expressions import expression
from kg.rules.decompose.names import Names
from kg.rules.decompose.paths import Link, normal
from kg.rules.form import Assignment, Atom, Exists, Filter, Rule, TripleTerm, Variable
from kg.rules.notations.wellformed import check
from kg.syntax import tree
from kg.syntax.lexer import normalise
from kg.syntax.position import place_at
from kg.syntax.tree import mentioned

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.errors import Place
    from kg.rules.form import Element, Pattern, Term
    from kg.syntax.tree import Group, RuleText, RuleUnit, Span, TriplePattern

__all__ = ["data", "rules"]

_DIGITS: Final = 20


def rules(unit: RuleUnit, name: str, path: str, text: str, *, first: int = 1) -> tuple[Rule, ...]:
    """Return the rules of a rule set; `first` is the part that the first one is.

    Raises RuleError: KG203 for what is not well-formed, KG209 for a head whose subject is a literal.
    """
    found: list[Rule] = []
    written = normalise(text)
    for part, rule in enumerate(unit.rules, first):
        check(rule, path, written)
        reader = _Reader(rule, path, written)
        if rule.template:
            found.append(Rule(name, reader.head(), reader.body(), reader.place(rule.span), part))
    return tuple(found)


def data(unit: RuleUnit, path: str, text: str) -> tuple[Triple, ...]:
    """Return the triples of DATA; a blank node has a name that no other file gives one.

    Raises RuleError KG209 for a triple that a store cannot hold: RDF 1.2 has no literal as subject.
    """
    stem = sha256(text.encode()).hexdigest()[:_DIGITS]
    found: list[Triple] = []
    for pattern in unit.data:
        triple = _stored(TripleTerm(pattern.subject, _predicate(pattern), pattern.object), stem)
        if not isinstance(triple, Triple):
            raise _literal_subject(place_at(normalise(text), pattern.span.start, path))
        found.append(triple)
    return tuple(found)


def _predicate(pattern: TriplePattern) -> NamedNode | Variable:
    if not isinstance(pattern.predicate, NamedNode | Variable):
        raise TypeError(pattern.predicate)
    return pattern.predicate


def _stored(pattern: Pattern, stem: str) -> Term | None:
    """Return a term that a store can hold, its blank nodes renamed; None when it cannot."""
    if isinstance(pattern, BlankNode):
        return BlankNode(f"d{stem}-{pattern.value}")
    if not isinstance(pattern, TripleTerm):
        return None if isinstance(pattern, Variable) else pattern
    subject, obj = _stored(pattern.subject, stem), _stored(pattern.object, stem)
    if isinstance(subject, NamedNode | BlankNode) and isinstance(pattern.predicate, NamedNode) and obj is not None:
        return Triple(subject, pattern.predicate, obj)
    return None


def _literal_subject(place: Place) -> RuleError:
    hint = "RDF has IRIs and blank nodes as subjects; say it the other way round."
    return RuleError("KG209", "the subject of a triple must be an IRI or a blank node", place=place, hint=hint)


class _Reader:
    """Turns one rule into the internal form."""

    def __init__(self, rule: RuleText, path: str, text: str) -> None:
        self._rule = rule
        self._path = path
        self._text = text
        names = mentioned(rule.group.nodes) | mentioned(rule.template)
        self._names = Names(names)

    def place(self, span: Span) -> Place:
        """Return where a span begins."""
        return place_at(self._text, span.start, self._path)

    def head(self) -> tuple[Atom, ...]:
        """Return the triples that the rule derives."""
        return tuple(map(self._derived, self._rule.template))

    def body(self) -> tuple[Element, ...]:
        """Return the body of the rule."""
        return tuple(self._elements(self._rule.group, asserted=self._rule.asserted))

    def _derived(self, pattern: TriplePattern) -> Atom:
        place = self.place(pattern.span)
        terms = (pattern.subject, pattern.object)
        inner = [subject for term in terms if isinstance(term, TripleTerm) for subject in _subjects(term)]
        if any(isinstance(subject, Literal | Triple | TripleTerm) for subject in (pattern.subject, *inner)):
            raise _literal_subject(place)
        return Atom(pattern.subject, _predicate(pattern), pattern.object, place=place)

    def _elements(self, group: Group, *, asserted: bool) -> Iterator[Element]:
        for node in group.nodes:
            if isinstance(node, tree.TriplePattern):
                yield from self._atoms(node, asserted=asserted)
            elif isinstance(node, tree.Filter):
                yield Filter(expression(node.expression.text, self.place(node.expression.span)))
            elif isinstance(node, tree.Bind):
                yield Assignment(node.variable, expression(node.expression.text, self.place(node.expression.span)))
            elif isinstance(node, tree.Exists):
                inner = self._elements(node.group, asserted=asserted or node.asserted)
                yield Exists(tuple(inner), negated=node.negated)

    def _atoms(self, pattern: TriplePattern, *, asserted: bool) -> Iterator[Atom]:
        """Yield the triples that a path stands for, joined by new variables."""
        (steps,) = normal(pattern.predicate).alternatives
        links = [step for step in steps if isinstance(step, Link)]
        place = self.place(pattern.span)
        left = pattern.subject
        for number, link in enumerate(links, 1):
            right = pattern.object if number == len(links) else self._names.hidden()
            subject, obj = (right, left) if link.inverse else (left, right)
            yield Atom(subject, link.predicate, obj, asserted=asserted, place=place)
            left = right


def _subjects(term: TripleTerm) -> Iterator[Pattern]:
    yield term.subject
    if isinstance(term.object, TripleTerm):
        yield from _subjects(term.object)
