"""The atoms that a rule reads and writes, and whether one rule's head can match what another's body reads.

A body atom depends on a head atom if the two unify: constants distinguish them, so `?x a :A` does not depend on a head
`?x a :B`. A blank node of a head is a term that nothing else has: it unifies with variables only.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final, TypeAlias

from pyoxigraph import BlankNode, NamedNode, Triple

from kg.rules import form


@dataclass(frozen=True, slots=True)
class Read:
    """An atom that a body reads; with `negated` more matches may take solutions away (NOT, aggregates).

    A filter next to the atom keeps its predicate, a variable, from being one of `excluded`.
    """

    atom: form.Atom
    negated: bool
    excluded: frozenset[NamedNode] = frozenset()


@dataclass(frozen=True, slots=True)
class _Fresh:
    """A blank node in a head."""

    label: str


_NAME: Final = re.compile(r"<([^<>]*)>")
_NOT_IN: Final = re.compile(r"\(*\?([\w·]+) NOT IN ?\(((?:<[^<>]*>|[, ])*)\)+")
_Node: TypeAlias = "form.Pattern | _Fresh | tuple[_Node, ...]"
_Bindings: TypeAlias = "dict[form.Variable, _Node]"


def reads(rule: form.Rule) -> Iterator[Read]:
    """Yield what a body reads and rules may derive; atoms on asserted data only are left out.

    A block of SPARQL reads one atom for each of its predicates, or all triples.
    """
    yield from _reads(rule.body, negated=False)


def _reads(body: tuple[form.Element, ...], *, negated: bool) -> Iterator[Read]:
    for element in body:
        if isinstance(element, form.Atom):
            if not element.asserted:
                yield Read(element, negated, _excluded(element, body))
        elif isinstance(element, form.Exists):
            yield from _reads(element.body, negated=negated or element.negated)
        elif isinstance(element, form.Aggregate):
            yield from _reads(element.body, negated=True)
        elif isinstance(element, form.EngineBlock):
            yield from (Read(atom, negated or not element.monotone) for atom in _atoms_of_block(element))


def _excluded(atom: form.Atom, body: tuple[form.Element, ...]) -> frozenset[NamedNode]:
    """Return the predicates that `FILTER(?predicate NOT IN (...))` in the same body rules out for an atom."""
    if not isinstance(atom.predicate, form.Variable):
        return frozenset()
    excluded: set[NamedNode] = set()
    for element in body:
        text = element.expression.text if isinstance(element, form.Filter) else ""
        match = _NOT_IN.fullmatch(text)
        if match and match[1] == atom.predicate.name:
            excluded.update(NamedNode(name) for name in _NAME.findall(match[2]))
    return frozenset(excluded)


def _atoms_of_block(block: form.EngineBlock) -> Iterator[form.Atom]:
    """Yield atoms that match whatever a block of SPARQL may read."""
    subject, anything, value = form.Variable(".s"), form.Variable(".p"), form.Variable(".o")
    if block.reads is None:
        yield form.Atom(subject, anything, value, place=block.place)
        return
    for predicate in sorted(block.reads, key=str):
        yield form.Atom(subject, predicate, value, place=block.place)


def patterns(rules: Iterable[form.Rule], data: Iterable[Triple] = ()) -> frozenset[str]:
    """Return the patterns of all triples that rules read or derive, and of what their files state, as texts."""
    found = {one for rule in rules for body in (rule.body, rule.head) for one in _patterns(body)}
    return frozenset(found | {pattern(triple.predicate, None) for triple in data})


def _patterns(elements: Iterable[form.Element]) -> Iterator[str]:
    for element in elements:
        if isinstance(element, form.Atom):
            yield pattern(element.predicate, element.object)
        elif isinstance(element, form.EngineBlock):
            yield from (pattern(predicate, None) for predicate in element.reads or (None,))
        elif isinstance(element, form.Exists | form.Aggregate):
            yield from _patterns(element.body)


def pattern(predicate: object, value: object) -> str:
    """Return the pattern of triples with a predicate and an object; only IRIs restrict it, anything else matches all.

    The store may spell literals differently than a rule does, so they do not distinguish triples.
    """
    if not isinstance(predicate, NamedNode):
        return ""
    return f"{predicate} {value}" if isinstance(value, NamedNode) else str(predicate)


def depends(reader: form.Atom, head: form.Atom) -> bool:
    """Return whether a triple derived by `head` can match `reader`: whether they unify, variables renamed apart.

    A predicate that decomposition introduced is not a triple of the data: a variable predicate does not match it.
    """
    if isinstance(reader.predicate, form.Variable) and form.is_auxiliary(head.predicate):
        return False
    pairs = list(zip(reader.positions, head.positions, strict=True))
    # A name distinguishes most, which needs no renaming.
    if any(isinstance(one, NamedNode) and isinstance(other, NamedNode) and one != other for one, other in pairs):
        return False
    if _plain(reader) and _plain(head):
        return True
    # The variables of the body are renamed away from those of the head.
    names = {
        one: form.Variable(f"{one.name} body") for position in reader.positions for one in form.variables_of(position)
    }
    bindings: _Bindings = {}
    return all(_unifies(form.replaced(read, names), _derived(written), bindings) for read, written in pairs)


def _plain(atom: form.Atom) -> bool:
    """Return whether an atom has only names and different variables: any atom with these names unifies with it."""
    variables = [one.name for one in atom.positions if isinstance(one, form.Variable)]
    named = sum(isinstance(one, NamedNode) for one in atom.positions)
    return len(set(variables)) + named == len(atom.positions)


def _derived(pattern: form.Pattern) -> _Node:
    """Return a pattern of a head with its blank nodes as fresh terms, and triple terms as their parts."""
    if isinstance(pattern, BlankNode):
        return _Fresh(pattern.value)
    return tuple(map(_derived, pattern)) if isinstance(pattern, form.TripleTerm | Triple) else pattern


def _unifies(left: _Node, right: _Node, bindings: _Bindings) -> bool:
    """Unify two patterns, extending `bindings`. Triple terms nest only as written, so no check for cycles."""
    left, right = _value(left, bindings), _value(right, bindings)
    if isinstance(left, form.Variable):
        if left != right:
            bindings[left] = right
        return True
    if isinstance(right, form.Variable):
        bindings[right] = left
        return True
    if isinstance(left, tuple | form.TripleTerm | Triple) and isinstance(right, tuple | form.TripleTerm | Triple):
        return all(_unifies(one, other, bindings) for one, other in zip(left, right, strict=True))
    return left == right


def _value(node: _Node, bindings: _Bindings) -> _Node:
    while isinstance(node, form.Variable) and node in bindings:
        node = bindings[node]
    return node


def mints(rule: form.Rule) -> bool:
    """Return whether a rule can derive new terms: feeding itself, it may then never end.

    Blank nodes and triple terms with variables in the head do, and assigned values that are computed.
    """
    computed = any(isinstance(element, form.Assignment) and element.expression.mints for element in rule.body)
    return computed or any(_makes(pattern) for atom in rule.head for pattern in atom.positions)


def _makes(pattern: form.Pattern) -> bool:
    if isinstance(pattern, form.TripleTerm):
        return any(True for _ in form.variables_of(pattern)) or any(map(_makes, pattern))
    return isinstance(pattern, BlankNode)
