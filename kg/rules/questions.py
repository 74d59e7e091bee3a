"""A SELECT about the whole store as rules: what `kg.rules.selecting` evaluates over columns.

    SELECT ?kind (COUNT(DISTINCT ?node) AS ?nodes) { ?node a ?kind } GROUP BY ?kind ORDER BY DESC(?nodes) LIMIT 5

The pattern becomes a rule whose head has a blank node for each solution, with one property for each variable. What
follows after the solutions (counts, order, limit) is read here, and applied to the table of solutions.

`GRAPH ?graph { ?s ?p ?o }` is a pattern of one triple in some graphs, if nothing but filters mentions ?graph. It then
becomes an atom over the triples of the graphs whose names fulfil these filters.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pyoxigraph import NamedNode

from kg.errors import KgError
from kg.rules.decompose import decompose
from kg.rules.decompose.renaming import uses
from kg.rules.form import Atom, EngineBlock, Rule, Variable, readers_of
from kg.syntax.parser import parse_rq
from kg.syntax.tree import Alternative, Filter, GraphBlock, Group, Inverse, Node, Path, SubSelect, TriplePattern, Union

COLUMN: Final = "urn:kg:column:"
"""Begins the predicates of the head, one for each variable; they are not derived."""
MARK: Final = NamedNode(COLUMN)
"""The predicate of the first triple of the head."""

_COUNT: Final = r"\(\s*COUNT\s*\(\s*(?:DISTINCT\s+)?(?:\*|\?\w+)\s*\)\s*AS\s+\?\w+\s*\)"
_SELECT: Final = re.compile(
    r"(?P<prologue>(?:\s*(?:#|PREFIX\b)[^\n]*\n)*)\s*SELECT\s+(?P<distinct>DISTINCT\s+)?"
    rf"(?P<shown>(?:(?:\?\w+|{_COUNT})\s*)+)(?:WHERE\s*)?(?=\{{)",
    re.IGNORECASE,
)
_SHOWN: Final = re.compile(
    r"\?(?P<name>\w+)|\(\s*COUNT\s*\(\s*(?P<distinct>DISTINCT\s+)?(?P<counted>\*|\?\w+)\s*\)\s*AS\s+\?(?P<count>\w+)\s*\)",
    re.IGNORECASE,
)
_TAIL: Final = re.compile(
    r"(?<=\})\s*(?:GROUP\s+BY(?P<keys>(?:\s+\?\w+)+)\s*)?"
    r"(?:ORDER\s+BY(?P<order>(?:\s*(?:(?:DESC|ASC)\s*\(\s*\?\w+\s*\)|\?\w+))+)\s*)?(?:LIMIT\s+(?P<limit>\d+)\s*)?\Z",
    re.IGNORECASE,
)
_ORDER: Final = re.compile(r"(?P<down>DESC\s*\(\s*)?(?:ASC\s*\(\s*)?\?(?P<name>\w+)", re.IGNORECASE)
_NO_LIMIT: Final = re.compile(r"\bLIMIT 1000000000\b")
"""More than a store has: it tells the engine of the store how to plan (docs/query-core.md), and limits nothing."""


@dataclass(frozen=True, slots=True)
class Among:
    """The graphs in which a pattern is read: those whose name, as a variable, fulfils all conditions."""

    variable: str
    conditions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Question:
    """A SELECT as rules that bind `names`.

    `shown` are the columns of the answer, with what each counts: None for a column that is one of `names`, `*`, or a
    name. With `grouped` there is a row for each value of `keys`. Solutions are a set with `as_set`, rows with
    `distinct`. `order` has names, each with whether the largest comes first.
    """

    names: Sequence[str]
    rules: Sequence[Rule]
    as_set: bool
    shown: Mapping[str, str | None]
    keys: Sequence[str]
    distinct: bool
    order: Sequence[tuple[str, bool]]
    limit: int | None
    chosen: Mapping[tuple[int, int], Among]
    lines: Sequence[int]

    @property
    def grouped(self) -> bool:
        """Whether solutions are counted."""
        return any(self.shown.values())

    def among(self, reads: Atom | EngineBlock) -> Among | None:
        """Return the graphs that an atom is read in; None for all."""
        assert reads.place is not None  # noqa: S101 - `decompose` gives all atoms one
        at = self.lines[(reads.place.line or 1) - 1] + (reads.place.column or 1) - 1
        return next((one for (begin, end), one in self.chosen.items() if begin <= at < end), None)


def question(text: str, prefixes: Mapping[str, str]) -> Question | None:
    """Return what a SELECT becomes; None for one that rules cannot express."""
    match, tail = _SELECT.match(text), _TAIL.search(text)
    if match is None or tail is None:
        return None
    shown, counted, as_set = _counts(match["shown"])
    keys = tail["keys"].replace("?", " ").split() if tail["keys"] else []
    plain = [name for name, count in shown.items() if count is None]
    order = [(one["name"], bool(one["down"])) for one in _ORDER.finditer(tail["order"] or "")]
    grouped = len(plain) < len(shown)
    if as_set is None or (grouped and not set(plain) <= set(keys)) or (keys and not grouped):
        return None
    if not {name for name, _ in order} <= shown.keys():
        return None
    names = list(dict.fromkeys([*keys, *counted] if grouped else plain))
    distinct = match["distinct"] is not None
    as_set = as_set if grouped else distinct
    body = _NO_LIMIT.sub(lambda clause: " " * len(clause[0]), text[match.end() : tail.start()])
    read = _rules(match["prologue"], names, body, prefixes)
    if read is None:
        return None
    rules, chosen, lines = read
    limit = int(tail["limit"]) if tail["limit"] else None
    return Question(names, rules, as_set, shown, keys, distinct, order, limit, chosen, lines)


def _counts(text: str) -> tuple[dict[str, str | None], list[str], bool | None]:
    """Return the columns of an answer, the variables that are counted, and whether solutions count as a set.

    The last is None for counts of different kinds.
    """
    shown: dict[str, str | None] = {}
    kinds = set()
    for one in _SHOWN.finditer(text):
        shown[one["name"] or one["count"]] = one["counted"] and one["counted"].removeprefix("?")
        if one["counted"]:
            kinds.add((one["distinct"] is not None, one["counted"] if one["distinct"] else ""))
    counted = [name for name in shown.values() if name not in {None, "*"}]
    as_set = None if len(kinds) > 1 or (True, "*") in kinds else any(distinct for distinct, _ in kinds)
    return shown, [str(name) for name in counted], as_set


def _rules(
    prologue: str, names: Sequence[str], body: str, prefixes: Mapping[str, str]
) -> tuple[Sequence[Rule], Mapping[tuple[int, int], Among], Sequence[int]] | None:
    """Return the rules of a pattern, the graphs of parts of their text, and where the lines of this begin."""
    declared = "".join(f"PREFIX {name}: <{iri}>\n" for name, iri in prefixes.items() if f"{name}:" in body)
    # A new blank node for each solution: no solution may then be left out, or come more often than the query has it.
    head = " ".join(f"_:row <{COLUMN}{name}> ?{name} ." for name in names)
    whole = f"{declared}{prologue}CONSTRUCT {{ _:row <{COLUMN}> <{COLUMN}> . {head} }} WHERE {body}"
    chosen: dict[tuple[int, int], Among] = {}
    try:
        (stated,) = parse_rq(whole, "query").rules
        if whole[stated.group.span.end :].strip():
            return None  # a final VALUES is joined after counting, which rules cannot express
        stated = replace(stated, group=_simpler(stated.group, Counter(names), chosen))
        rules = decompose(stated, "query", "query", whole, alone=True)
    except KgError:
        return None
    if any(isinstance(element, EngineBlock) for rule in rules for element, _ in readers_of(rule.body)):
        return None
    return rules, chosen, [0, *(newline.end() for newline in re.finditer("\n", whole))]


def _simpler(group: Group, outside: Counter[str], chosen: dict[tuple[int, int], Among]) -> Group:
    """Return a group with triples in the place of its `GRAPH ?graph { triple }`; `chosen` gets the graphs of each.

    `outside` are the names that are mentioned around the group.
    """
    nodes = list(group.nodes)
    everything = uses(nodes)
    for block in [node for node in nodes if isinstance(node, GraphBlock)]:
        inner = _single(block)
        if inner is None:
            continue
        name = str(getattr(block.name, "name", ""))
        choosing = {id(node): tests for node in nodes if (tests := _conditions(node, name)) is not None}
        others = uses(node for node in nodes if id(node) not in choosing and node is not block)
        if others[name] or outside[name] or uses([inner])[name]:
            continue
        chosen[inner.span.start, inner.span.end] = Among(
            name, tuple(one for tests in choosing.values() for one in tests)
        )
        nodes = [inner if node is block else node for node in nodes if id(node) not in choosing]
    return replace(group, nodes=tuple(_inside(node, outside + everything - uses([node]), chosen) for node in nodes))


def _inside(node: Node, outside: Counter[str], chosen: dict[tuple[int, int], Among]) -> Node:
    """Return a node with simpler groups. What may be negated or left out stays as it is."""
    if isinstance(node, Union):
        return replace(node, groups=tuple(_simpler(group, outside, chosen) for group in node.groups))
    if isinstance(node, SubSelect):
        shown = Counter(column.variable.name for column in (*node.projections, *node.keys))
        return replace(node, group=_simpler(node.group, shown if node.projections else outside, chosen))
    return node


def _single(block: GraphBlock) -> TriplePattern | None:
    """Return the pattern of one triple that is all that a block looks for, in any graph."""
    if not isinstance(block.name, Variable) or len(block.group.nodes) != 1:
        return None
    inner = block.group.nodes[0]
    return inner if isinstance(inner, TriplePattern) and _is_step(inner.predicate) else None


def _is_step(path: Path) -> bool:
    """Return whether each pair of a path is one triple."""
    if isinstance(path, Alternative):
        return all(map(_is_step, path.parts))
    return _is_step(path.path) if isinstance(path, Inverse) else isinstance(path, NamedNode | Variable)


def _conditions(node: Node, name: str) -> Iterable[str] | None:
    """Return what a node demands of the name of a graph; None if it does anything else."""
    if isinstance(node, Filter):
        alone = node.expression.variables == (name,) and not node.expression.exists
        return [node.expression.text] if alone else None
    if isinstance(node, GraphBlock):
        return [] if getattr(node.name, "name", None) == name and not node.group.nodes else None
    if isinstance(node, Union) and len(node.groups) == 1:
        return _all(node.groups[0], name)
    if isinstance(node, SubSelect):
        plain = [column.variable.name for column in node.projections] == [name] and not (node.keys or node.sliced)
        return _all(node.group, name) if plain else None
    return None


def _all(group: Group, name: str) -> list[str] | None:
    """Return what a group demands of the name of a graph; None if it does anything else."""
    parts = [_conditions(node, name) for node in group.nodes]
    return None if None in parts else [one for part in parts for one in part or ()]
