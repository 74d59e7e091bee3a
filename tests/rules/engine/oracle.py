"""The naive evaluation that the engine is compared with: sets of tuples and nested loops over the internal form.

It has no indexes, deltas, reordering or strata. Elements are taken from left to right, and all rules are applied until
nothing is new. Negation and aggregates read the result of the round before. The fixpoint of these rounds is a stable
model (Gelfond, Lifschitz 1988), of which rules that can be stratified have exactly one. After round `n` the first `n`
strata are final, so the rounds end. pyoxigraph evaluates expressions and aggregates, one solution or group at a time.

Of the engine it shares the internal form of rules and nothing else, so that an error in its order of rules, its scopes
or its spelling of terms is seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING, TypeAlias

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, RdfFormat, Store, Triple

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
    variables_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.form import Column, Element, Expression, Pattern, Rule, Term

Fact: TypeAlias = "tuple[Term, Term, Term]"
Solution: TypeAlias = "dict[str, Term]"

__all__ = ["Fact", "infer"]

_ENGINE = Store()
_ROW = NamedNode("urn:row")


@dataclass(frozen=True, slots=True)
class _Facts:
    """Input triples of bodies: those derived in this round so far, those of the previous round, and asserted ones."""

    known: set[Fact]
    before: set[Fact]
    asserted: set[Fact]

    def finished(self) -> _Facts:
        """Return the input of negation and aggregates."""
        return _Facts(self.before, self.before, self.asserted)


def infer(rules: Iterable[Rule], asserted: set[Fact]) -> set[Fact]:
    """Return the triples inferred by stratified rules, without asserted ones."""
    all_rules = list(rules)
    before, found = asserted, _least(all_rules, asserted, asserted)
    while found != before and not all(_is_monotone(rule.body) for rule in all_rules):
        before, found = found, _least(all_rules, asserted, found)
    return found - asserted


def _is_monotone(body: tuple[Element, ...]) -> bool:
    """Whether a body never reads the previous round."""
    return all(
        _is_monotone(element.body) and not element.negated
        if isinstance(element, Exists)
        else not isinstance(element, Aggregate) and (not isinstance(element, EngineBlock) or element.monotone)
        for element in body
    )


def _least(rules: list[Rule], asserted: set[Fact], before: set[Fact]) -> set[Fact]:
    """Return the least fixpoint of rules whose negation and aggregates read the previous round."""
    facts = _Facts(set(asserted), before, asserted)
    size = -1
    while size != len(facts.known):
        size = len(facts.known)
        for rule in rules:
            facts.known.update(list(_derived(rule, facts)))
    return facts.known


def _derived(rule: Rule, facts: _Facts) -> Iterator[Fact]:
    for solution in list(_solutions(rule.body, {}, facts)):
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
    # An unbound variable, such as an aggregate with an error, is part of the solution, too.
    names = _names(rule.body) | solution.keys()
    spelt = {name: _spelt(solution[name]) if name in solution else b"" for name in names}
    text += b"\n".join(b"%s=%s" % (name.encode(), spelt[name]) for name in sorted(names))
    digest = blake2b(text, digest_size=16).digest()
    return BlankNode(bytes([digest[0] | 0xE0, *digest[1:]]).hex())


def _names(body: tuple[Element, ...]) -> set[str]:
    """Return the variables of the solutions of a body, without those inside filters and EXISTS."""
    found: list[Variable] = []
    for element in body:
        if isinstance(element, Atom):
            found += [variable for position in element.positions for variable in variables_of(position)]
        elif isinstance(element, Assignment):
            found.append(element.variable)
        elif isinstance(element, Values | EngineBlock):
            found += element.variables
        elif isinstance(element, Aggregate):
            found += [*element.keys, *(column.variable for column in element.columns)]
    return {variable.name for variable in found}


@cache
def _spelt(term: Term) -> bytes:
    """Return a term in the spelling of a store's dump."""
    store = Store()
    store.add(Quad(_ROW, _ROW, term))
    line = store.dump(format=RdfFormat.N_QUADS)
    assert line is not None
    return line.removeprefix(b"<urn:row> <urn:row> ").removesuffix(b" .\n")


def _solutions(body: tuple[Element, ...], start: Solution, facts: _Facts) -> list[Solution]:
    solutions = [start]
    for element in body:
        solutions = [after for before in solutions for after in _after(element, before, facts)]
    return solutions


def _after(element: Element, solution: Solution, facts: _Facts) -> Iterable[Solution]:
    if isinstance(element, Atom):
        return _matches(element, solution, facts.asserted if element.asserted else facts.known)
    if isinstance(element, Filter):
        value = _value(f"IF({element.expression.text}, true, false)", element.expression, solution)
        return [solution] if value == Literal(True) else []
    if isinstance(element, Assignment):
        value = _value(element.expression.text, element.expression, solution)
        joined = _joined(solution, {element.variable.name: value}) if value is not None else None  # as in SPARQL
        return [joined] if joined is not None else []
    if isinstance(element, Exists):
        found = bool(_solutions(element.body, solution, facts.finished() if element.negated else facts))
        return [solution] if found != element.negated else []
    if isinstance(element, Values):
        rows = ({v.name: t for v, t in zip(element.variables, row, strict=True)} for row in element.rows)
        return [joined for row in rows if (joined := _joined(solution, row)) is not None]
    if isinstance(element, Aggregate):
        groups = _groups(element, facts.finished())
        return [joined for row in groups if (joined := _joined(solution, row)) is not None]
    read = facts.known if element.monotone else facts.before
    return [joined for row in _block(element, read) if (joined := _joined(solution, row)) is not None]


def _joined(left: Solution, right: Solution) -> Solution | None:
    if any(name in left and left[name] != term for name, term in right.items()):
        return None
    return {**left, **right}


def _matches(atom: Atom, solution: Solution, facts: set[Fact]) -> Iterator[Solution]:
    given: list[tuple[int, Term]] = []
    free: list[tuple[int, Pattern]] = []
    for place, pattern in enumerate(atom.positions):
        term = solution.get(pattern.name) if isinstance(pattern, Variable) else pattern
        if term is None or isinstance(term, TripleTerm):
            free.append((place, pattern))
        else:
            given.append((place, term))
    for fact in facts:
        for place, term in given:  # most facts end here, which is most of the time of these tests
            if fact[place] != term:
                break
        else:
            if isinstance(atom.predicate, Variable) and str(fact[1]).startswith("<" + AUXILIARY):
                continue
            bound: Solution | None = solution
            for place, pattern in free:
                bound = _bound(pattern, fact[place], bound)
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
    """Evaluate an expression over a solution."""
    return _evaluated(text, tuple((name, solution.get(name)) for name in expression.variables))


@lru_cache(maxsize=1 << 14)
def _evaluated(text: str, arguments: tuple[tuple[str, Term | None], ...]) -> Term | None:
    """Evaluate an expression; its arguments are put into a store, which allows blank nodes."""
    store = Store()
    store.add(Quad(_ROW, NamedNode("urn:is"), _ROW))
    pattern = "<urn:row> <urn:is> <urn:row>"
    for index, (name, term) in enumerate(arguments):
        if term is not None:
            store.add(Quad(_ROW, NamedNode(f"urn:argument:{index}"), term))
            pattern += f" . <urn:row> <urn:argument:{index}> ?{name}"
    (found,) = list(store.query(f"SELECT ?kg_value {{ {pattern} BIND({text} AS ?kg_value) }}"))  # type: ignore[arg-type]  # a SELECT gives solutions
    value: Term | None = found["kg_value"]
    return value


def _groups(aggregate: Aggregate, facts: _Facts) -> Iterator[Solution]:
    members: dict[tuple[Term, ...], list[Solution]] = {} if aggregate.keys else {(): []}
    for solution in _solutions(aggregate.body, {}, facts):
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
    values.sort(key=lambda value: b"" if value is None else _spelt(value))
    if column.function == "SAMPLE":
        return next((value for value in values if value is not None), None)
    terms = " ".join("UNDEF" if value is None else _spelt(value).decode() for value in values)
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
