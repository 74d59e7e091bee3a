"""The naive evaluation that the engine is compared with: sets of tuples and nested loops over the internal form.

It knows no indexes, no deltas and no reordering: elements are taken from left to right, rules of a stratum are applied
until nothing is new. Expressions and aggregates are asked of pyoxigraph one solution, one group at a time.
"""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING, TypeAlias

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Store, Triple

from kg.rules.form import (
    AUXILIARY,
    Aggregate,
    Assignment,
    Atom,
    EngineBlock,
    Exists,
    Filter,
    TripleTerm,
    Values,
    Variable,
)
from kg.rules.scope import bound_in
from kg.rules.stratify import stratify
from kg.store.terms import spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.form import Column, Element, Expression, Pattern, Rule, Term

Fact: TypeAlias = "tuple[Term, Term, Term]"
Solution: TypeAlias = "dict[str, Term]"

__all__ = ["Fact", "infer"]

_ENGINE = Store()


def infer(rules: Iterable[Rule], asserted: set[Fact]) -> set[Fact]:
    """Return the triples that the rules infer and that are not asserted."""
    known = set(asserted)
    for stratum in stratify(rules, bounded=True):
        size = -1
        while size != len(known):
            size = len(known)
            for rule in stratum.rules:
                known |= set(_derived(rule, known, asserted))
    return known - asserted


def _derived(rule: Rule, known: set[Fact], asserted: set[Fact]) -> Iterator[Fact]:
    for solution in list(_solutions(rule.body, {}, known, asserted)):
        for atom in rule.head:
            terms = [_instance(position, solution, rule) for position in atom.positions]
            if _is_triple(terms):
                subject, predicate, value = terms
                assert subject is not None and predicate is not None and value is not None  # noqa: PT018 - for types
                yield subject, predicate, value


def _is_triple(terms: list[Term | None]) -> bool:
    return isinstance(terms[0], NamedNode | BlankNode) and isinstance(terms[1], NamedNode) and terms[2] is not None


def _instance(pattern: Pattern, solution: Solution, rule: Rule) -> Term | None:
    if isinstance(pattern, Variable):
        return solution.get(pattern.name)
    if isinstance(pattern, BlankNode):
        return _blank(pattern, solution, rule)
    if isinstance(pattern, TripleTerm):
        parts = [_instance(part, solution, rule) for part in (pattern.subject, pattern.predicate, pattern.object)]
        return Triple(*parts) if _is_triple(parts) else None  # type: ignore[arg-type]  # checked before
    return pattern


def _blank(node: BlankNode, solution: Solution, rule: Rule) -> BlankNode:
    text = f"{rule.name}\n{rule.part}\n{node.value}\n".encode()
    # What stays unbound, such as an aggregate in error, is a variable of the solution too.
    names = {variable.name for variable in bound_in(rule.body)} | solution.keys()
    spelt = {name: spell(solution[name]) if name in solution else b"" for name in names}
    text += b"\n".join(b"%s=%s" % (name.encode(), spelt[name]) for name in sorted(names))
    digest = blake2b(text, digest_size=16).digest()
    return BlankNode(bytes([digest[0] | 0xE0, *digest[1:]]).hex())


def _solutions(body: tuple[Element, ...], start: Solution, known: set[Fact], asserted: set[Fact]) -> list[Solution]:
    solutions = [start]
    for element in body:
        solutions = [after for before in solutions for after in _after(element, before, known, asserted)]
    return solutions


def _after(element: Element, solution: Solution, known: set[Fact], asserted: set[Fact]) -> Iterable[Solution]:
    if isinstance(element, Atom):
        return _matches(element, solution, asserted if element.asserted else known)
    if isinstance(element, Filter):
        value = _value(f"IF({element.expression.text}, true, false)", element.expression, solution)
        return [solution] if value == Literal(True) else []
    if isinstance(element, Assignment):
        value = _value(element.expression.text, element.expression, solution)
        return [] if value is None else [{**solution, element.variable.name: value}]
    if isinstance(element, Exists):
        found = bool(_solutions(element.body, solution, known, asserted))
        return [solution] if found != element.negated else []
    if isinstance(element, Values):
        rows = ({v.name: t for v, t in zip(element.variables, row, strict=True)} for row in element.rows)
        return [joined for row in rows if (joined := _joined(solution, row)) is not None]
    if isinstance(element, Aggregate):
        groups = _groups(element, known, asserted)
        return [joined for row in groups if (joined := _joined(solution, row)) is not None]
    return [joined for row in _block(element, known) if (joined := _joined(solution, row)) is not None]


def _joined(left: Solution, right: Solution) -> Solution | None:
    if any(name in left and left[name] != term for name, term in right.items()):
        return None
    return {**left, **right}


def _matches(atom: Atom, solution: Solution, facts: set[Fact]) -> Iterator[Solution]:
    for fact in facts:
        if isinstance(atom.predicate, Variable) and str(fact[1]).startswith("<" + AUXILIARY):
            continue
        bound: Solution | None = solution
        for pattern, term in zip(atom.positions, fact, strict=True):
            bound = _bound(pattern, term, bound)
        if bound is not None:
            yield bound


def _bound(pattern: Pattern, term: Term, solution: Solution | None) -> Solution | None:
    if solution is None:
        return None
    if isinstance(pattern, Variable):
        return _joined(solution, {pattern.name: term})
    if isinstance(pattern, TripleTerm):
        if not isinstance(term, Triple):
            return None
        inner = _bound(pattern.subject, term.subject, solution)
        inner = _bound(pattern.predicate, term.predicate, inner)
        return _bound(pattern.object, term.object, inner)
    return solution if pattern == term else None


def _value(text: str, expression: Expression, solution: Solution) -> Term | None:
    """Evaluate an expression; its arguments stand in a store, where blank nodes may stand too."""
    store = Store()
    row = NamedNode("urn:row")
    store.add(Quad(row, NamedNode("urn:is"), row))
    pattern = "<urn:row> <urn:is> <urn:row>"
    for index, name in enumerate(expression.variables):
        if name in solution:
            store.add(Quad(row, NamedNode(f"urn:argument:{index}"), solution[name]))
            pattern += f" . <urn:row> <urn:argument:{index}> ?{name}"
    (found,) = list(store.query(f"SELECT ?kg_value {{ {pattern} BIND({text} AS ?kg_value) }}"))  # type: ignore[arg-type]  # a SELECT gives solutions
    value: Term | None = found["kg_value"]
    return value


def _groups(aggregate: Aggregate, known: set[Fact], asserted: set[Fact]) -> Iterator[Solution]:
    members: dict[tuple[Term, ...], list[Solution]] = {} if aggregate.keys else {(): []}
    for solution in _solutions(aggregate.body, {}, known, asserted):
        members.setdefault(tuple(solution[key.name] for key in aggregate.keys), []).append(solution)
    for key, solutions in members.items():
        row = {variable.name: term for variable, term in zip(aggregate.keys, key, strict=True)}
        for column in aggregate.columns:
            value = _aggregated(column, solutions)
            if value is not None:
                row[column.variable.name] = value
        yield row


def _aggregated(column: Column, solutions: list[Solution]) -> Term | None:
    if column.expression is None:
        different = {frozenset(solution.items()) for solution in solutions}
        return Literal(len(different) if column.distinct else len(solutions))
    values = [_value(column.expression.text, column.expression, solution) for solution in solutions]
    if column.distinct:
        values = list(dict.fromkeys(values))
    if column.function == "COUNT":
        return Literal(sum(value is not None for value in values))
    values.sort(key=lambda value: b"" if value is None else spell(value))
    if column.function == "SAMPLE":
        return next((value for value in values if value is not None), None)
    terms = " ".join("UNDEF" if value is None else spell(value).decode() for value in values)
    call = f"{column.function}(?x)"
    if column.function == "GROUP_CONCAT":
        call = f'GROUP_CONCAT(STR(?x); SEPARATOR="{column.separator}")'
    (found,) = list(_ENGINE.query(f"SELECT ({call} AS ?v) {{ VALUES ?x {{ {terms} }} }}"))  # type: ignore[arg-type]  # a SELECT gives solutions
    aggregated: Term | None = found["v"]
    return aggregated


def _block(block: EngineBlock, known: set[Fact]) -> Iterator[Solution]:
    store = Store()
    store.extend(Quad(*fact) for fact in known if block.reads is None or fact[1] in block.reads)  # type: ignore[arg-type]  # facts are triples
    shown = " ".join(str(variable) for variable in block.variables) or "*"
    for found in store.query(f"SELECT {shown} {{ {block.text} }}"):  # type: ignore[union-attr]  # a SELECT gives solutions
        terms = {variable.name: found[index] for index, variable in enumerate(block.variables)}
        yield {name: term for name, term in terms.items() if term is not None}
