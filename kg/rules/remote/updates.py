"""A rule as an update that adds its derivations to the graph of new triples, from all data or from a delta."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.rules.dependencies import depends, reads, writes
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    EngineBlock,
    Exists,
    Filter,
    Rule,
    binds,
    bound_in,
    has_blank,
    is_auxiliary,
    mentions,
    readers_of,
)
from kg.rules.sparql import Placed, group, spelling, triple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pyoxigraph import NamedNode

    from kg.rules.form import Element
    from kg.rules.remote.graphs import Graphs
    from kg.rules.stratify import Stratum


def first_update(rule: Rule, graphs: Graphs) -> str:
    """Return the update that applies a rule to all data."""
    return _insert(rule, [_placed(rule.body, graphs)], graphs)


def next_update(rule: Rule, stratum: Stratum, graphs: Graphs) -> str | None:
    """Return the update that applies a rule to what is new since the last round, None for one that reads none of it.

    For each atom that a rule of the stratum feeds there is one reading in which that atom is taken from the delta. A
    block of SPARQL cannot be read so: a rule with one that the stratum feeds is applied to everything.
    """
    heads = [head for other in stratum.rules for head in writes(other)]
    if _fed_block(rule, heads):
        return first_update(rule, graphs)
    variants = list(_variants(rule.body, heads, graphs))
    return _insert(rule, variants, graphs) if variants else None


def _insert(rule: Rule, bodies: Sequence[tuple[Element, ...]], graphs: Graphs) -> str:
    head = " ".join(f"GRAPH {graphs.channel(atom.predicate).new} {{ {triple(atom)} }}" for atom in rule.head)
    groups = [group(body) for body in bodies]
    where = groups[0] if len(groups) == 1 else "\nUNION\n".join(f"{{\n{text}\n}}" for text in groups)
    if any(has_blank(position) for atom in rule.head for position in atom.positions):
        # Each solution gives one blank node, however many of the readings find it.
        names = " ".join(sorted(map(spelling, bound_in(rule.body)))) or "*"
        where = f"{{ SELECT DISTINCT {names} WHERE {{\n{where}\n}} }}"
    read = (graphs.asserted, graphs.plain.derived)
    placed = (graphs.asserted, graphs.plain.delta, graphs.auxiliary.derived, graphs.auxiliary.delta)
    using = [*(f"USING {graph}" for graph in read), *(f"USING NAMED {graph}" for graph in placed)]
    return f"INSERT {{ {head} }}\n{' '.join(using)}\nWHERE {{\n{where}\n}}"


def _placed(body: Sequence[Element], graphs: Graphs) -> tuple[Element, ...]:
    """Return a body whose atoms on asserted data and auxiliary predicates name their graphs."""
    return tuple(_placed_element(element, graphs) for element in body)


def _placed_element(element: Element, graphs: Graphs) -> Element:
    if isinstance(element, Placed):
        return element
    if isinstance(element, Atom) and is_auxiliary(element.predicate):
        return _at(element, graphs.auxiliary.derived)
    if isinstance(element, Atom) and element.asserted:
        return _at(element, graphs.asserted)
    if isinstance(element, Exists | Aggregate):
        return replace(element, body=_placed(element.body, graphs))
    return element


def _at(atom: Atom, graph: NamedNode) -> Placed:
    return Placed(*atom.positions, asserted=atom.asserted, place=atom.place, graph=graph)


def _fed_block(rule: Rule, heads: Sequence[Atom]) -> bool:
    blocks = replace(rule, body=tuple(each for each, _ in readers_of(rule.body) if isinstance(each, EngineBlock)))
    return any(depends(read.atom, head) for read in reads(blocks) for head in heads)


def _variants(body: tuple[Element, ...], heads: Sequence[Atom], graphs: Graphs) -> Iterator[tuple[Element, ...]]:
    """Yield a body once for each of its atoms that `heads` feed, with that atom read from the delta."""
    for index, element in enumerate(body):
        before, behind = body[:index], body[index + 1 :]
        if isinstance(element, Atom) and not element.asserted and any(depends(element, head) for head in heads):
            atom = _at(element, graphs.channel(element.predicate).delta)
            # The delta is small, and servers join from left to right where they know no better.
            moved = (atom, *before, *behind) if _may_lead(atom, before) else (*before, atom, *behind)
            yield _placed(moved, graphs)
        elif isinstance(element, Exists) and not element.negated:
            for inner in _variants(element.body, heads, graphs):
                yield _placed((*before, Exists(inner), *behind), graphs)


def _may_lead(atom: Atom, before: Sequence[Element]) -> bool:
    """Return whether an atom means the same in front of what is before it, which then sees what it binds."""
    bound = binds(atom)
    seen = frozenset[object]()
    for element in before:
        if isinstance(element, Filter | Exists) and mentions(element) & bound - seen:
            return False
        if isinstance(element, Assignment) and element.variable in bound:
            return False
        seen |= binds(element)
    return True
