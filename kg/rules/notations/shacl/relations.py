"""Constraints on all values of a path together: pairs of properties, closed shapes (SHACL, sections 4.4, 4.5, 4.8)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.notations.shacl.logic import check, every, exists, for_all, none, some
from kg.rules.notations.shacl.values import constant
from kg.rules.notations.shacl.vocabulary import sh

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph
    from kg.rules.notations.shacl.logic import Cases
    from kg.rules.notations.shacl.paths import Branch, Names


def _among(values: list[Branch], term: str, *, wanted: bool) -> Cases:
    """Return that a term is one of the values, or that it is none."""
    parts = []
    for branch in values:
        given = branch.giving(term)
        if given is None:
            parts.append(check(f"sameTerm({branch.term}, {term})", wanted=wanted, safe=True))
        else:
            parts.append([[f"FILTER {'' if wanted else 'NOT '}EXISTS {{ {given.pattern} }}"]])
    return some(parts) if wanted else every(parts)


def has_value(graph: ShapesGraph, shape: Term, value: Term, values: list[Branch], *, wanted: bool) -> Cases:
    """Return that a constant is one of the values (sh:hasValue)."""
    return _among(values, constant(graph, value, shape, "hasValue"), wanted=wanted)


@dataclass(frozen=True, slots=True)
class Comparison:
    """The values of a path of `term` against those of a property, whose name is an IRI in brackets."""

    term: str
    values: list[Branch]
    name: str
    other: str
    """A variable for a value of the property."""

    @property
    def reached(self) -> str:
        """The pattern of the values of the property."""
        return f"{self.term} {self.name} {self.other} ."

    def has(self, one: str, wanted: bool) -> Cases:  # noqa: FBT001 - a fact
        """Return that a value of the path is one of the property, or that it is none."""
        return [[f"FILTER {'' if wanted else 'NOT '}EXISTS {{ {self.term} {self.name} {one} . }}"]]


def property_name(graph: ShapesGraph, shape: Term, value: Term) -> str:
    """Return the property that a constraint compares with; KG201 when it is none."""
    if not isinstance(value, NamedNode):
        raise graph.error(
            f"{graph.called(shape)} is compared with {value}, but a property is needed",
            shape,
            hint="Give it the IRI of a property.",
        )
    return str(value)


def _equals(pair: Comparison, *, wanted: bool) -> Cases:
    own = for_all(pair.values, pair.has, wanted=wanted)
    theirs = (none if wanted else exists)(pair.reached, _among(pair.values, pair.other, wanted=False))
    return every([own, theirs]) if wanted else some([own, theirs])


def _disjoint(pair: Comparison, *, wanted: bool) -> Cases:
    return for_all(pair.values, lambda one, passes: pair.has(one, not passes), wanted=wanted)


def _less(operator: str) -> Callable[..., Cases]:
    def read(pair: Comparison, *, wanted: bool) -> Cases:
        def each(one: str, passes: bool) -> Cases:  # noqa: FBT001 - a fact
            other = check(f"{one} {operator} {pair.other}", wanted=False)
            return (none if passes else exists)(pair.reached, other)

        return for_all(pair.values, each, wanted=wanted)

    return read


def unique_languages(pair: tuple[list[Branch], list[Branch]], *, wanted: bool) -> Cases:
    """Return that no two values have the same language (sh:uniqueLang)."""
    parts = []
    for one, two in product(*pair):
        if not one.pattern and not two.pattern:
            continue
        same = f'LANG({one.term}) != "" && LCASE(LANG({one.term})) = LCASE(LANG({two.term}))'
        pattern = f"{one.pattern} {two.pattern}".strip()
        parts.append((none if wanted else exists)(pattern, [[f"FILTER(!sameTerm({one.term}, {two.term}) && {same})"]]))
    return every(parts) if wanted else some(parts)


def closed(graph: ShapesGraph, shape: Term, term: str, names: Names, *, wanted: bool) -> Cases:
    """Return that a term has values of no other properties than those of the shape (sh:closed)."""
    if not graph.flag(shape, "closed"):
        return every([]) if wanted else some([])
    ignored = [name for listed in graph.values(shape, sh("ignoredProperties")) for name in graph.members(listed, shape)]
    paths = [path for inner in graph.values(shape, sh("property")) for path in graph.values(inner, sh("path"))]
    allowed = [str(name) for name in dict.fromkeys([*paths, *ignored]) if isinstance(name, NamedNode)]
    predicate = names.fresh()
    others = [[f"FILTER({predicate} NOT IN ({', '.join(allowed)}))"]] if allowed else [[]]
    return (none if wanted else exists)(f"{term} {predicate} {names.fresh()} .", others)


RELATIONS: Final[Mapping[NamedNode, Callable[..., Cases]]] = {
    sh("equals"): _equals,
    sh("disjoint"): _disjoint,
    sh("lessThan"): _less("<"),
    sh("lessThanOrEquals"): _less("<="),
}
"""Constraint to the cases in which a comparison holds, or does not."""
