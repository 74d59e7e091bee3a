"""Queries over the whole store, answered from the columns that the last run of rules left.

    graph = columns_of(snapshot)
    rows = graph.query("SELECT ?node ?name { ?node a rnkg:NodeType ; rnkg:name ?name }", prefixes=PREFIXES)

The engine of the store takes microseconds to turn each term of an answer into text. Columns have the texts of all terms
one after the other, and joins over them take milliseconds, so that a query with many rows takes a tenth of the time. A
look-up of few rows is cheaper in the store, for it loads nothing.

What rules cannot express (GRAPH but for a choice of graphs, aggregates, other forms than SELECT) is left to the store,
and everything where the columns do not belong to its generation. The record of builds is in no column.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from pyoxigraph import NamedNode, Store

from kg.errors import KgError
from kg.rules import memory as memories
from kg.rules.columns import patched, union_of
from kg.rules.decompose import decompose
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import Facts
from kg.rules.engine.planning import plan
from kg.rules.engine.solve import Solver, View
from kg.rules.engine.tables import Table, concatenate, distinct_rows
from kg.rules.form import EngineBlock, readers_of
from kg.store.changes import since
from kg.store.terms import of_spelling
from kg.syntax.parser import parse_rq

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.facts import Keys
    from kg.rules.engine.terms import Dictionary
    from kg.rules.form import Atom, Rule
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["Columns", "columns_of"]

_COLUMN: Final = "urn:kg:column:"
"""Begins the predicates of the head of the rule that a query becomes, one for each variable; they are not derived."""
_TYPE: Final = b"<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
_OBJECT: Final = 0xFFFFFFFF
_MARK: Final = NamedNode(_COLUMN)
"""The predicate of its first triple."""
_SELECT: Final = re.compile(
    r"(?P<prologue>(?:\s*(?:#|PREFIX\b)[^\n]*\n)*)\s*SELECT\s+(?P<distinct>DISTINCT\s+)?(?P<names>(?:\?\w+\s+)+)(?:WHERE\s*)?(?=\{)"
)
_GRAPHS: Final = re.compile(
    r"\{\s*SELECT \?graph \{\s*GRAPH \?graph \{\}\s*FILTER\((?P<condition>[^{}]*)\)\s*\}\s*\}\s*"
    r"GRAPH \?graph (?=\{(?P<body>[^{}.]*)\})"
)
"""One triple pattern in the graphs whose names fulfil a condition."""
_NO_LIMIT: Final = re.compile(r"\bLIMIT 1000000000\b")
"""More than a store has: it tells the engine of the store how to plan (docs/query-core.md), and limits nothing."""


def columns_of(snapshot: EmbeddedSnapshot) -> Columns | EmbeddedSnapshot:
    """Return the columns of a generation, to be asked as the snapshot is; the snapshot itself where none are kept."""
    memory = memories.load(snapshot.layout.cache) if snapshot.layout else None
    if snapshot.layout is None or memory is None or memory.generation is None:
        return snapshot
    changed = since(snapshot.layout, memory.generation, snapshot.generation).graphs
    if changed is None:
        return snapshot
    parts = {_name(graph): facts for graph, facts in memory.graphs.items()}
    parts[memory.names.inferred.value] = memory.written
    for graph, patches in changed.items():
        if graph != memory.names.builds.value:
            if patches is None:
                return snapshot
            parts[graph] = patched(parts.get(graph, Facts()), patches, memory.dictionary)[0]
    return Columns(snapshot, memory.dictionary, parts, memory.names.builds)


class Columns:
    """The triples of each graph of a generation as columns, but for the record of builds."""

    def __init__(
        self, snapshot: EmbeddedSnapshot, dictionary: Dictionary, graphs: Mapping[str, Facts], builds: NamedNode
    ) -> None:
        """`graphs` are named by IRI; the default graph has the empty name. `builds` is the graph of no column."""
        self.dictionary = dictionary
        self._builds = builds
        self.graphs = graphs
        self._snapshot = snapshot
        self._terms: dict[int, _Value | None] = {0: None}

    @cached_property
    def union(self) -> Facts:
        """The triples of all graphs, each once."""
        return union_of(self.graphs.values())

    def query(self, text: str, *, prefixes: Mapping[str, str] | None = None) -> Iterable[Any]:
        """Return the rows of a SELECT over the union of all graphs, in any order; raises as the store does.

        A triple of several graphs, and a pair that a path connects in two ways, count once. With DISTINCT the rows are
        those of the store.
        """
        question = _question(text, prefixes or {})
        if question is None:
            return cast("Iterable[Any]", self._snapshot.query(text, prefixes=prefixes))
        return self._rows(question.names, self._solutions(question))

    def related(self, numbers: Mapping[str, int], condition: str, everywhere: Iterable[str]) -> NDArray[np.int64]:
        """Return pairs of things, by the numbers of their IRIs, that any property but rdf:type relates.

        The properties `everywhere` are read in all graphs, others in those whose names fulfil a condition on ?graph. A
        pair comes as often as triples say so.
        """
        known = np.full(len(self.dictionary), -1, np.int64)
        for iri, number in numbers.items():
            known[self.dictionary.find(b"<%s>" % iri.encode()) or 0] = number
        known[0] = -1
        parts = [keys for predicate, keys in self._among(condition) if self.dictionary.spelling(predicate) != _TYPE]
        parts += [self.union.keys(self.dictionary.find(b"<%s>" % one.encode()) or 0) for one in everywhere]
        keys = np.concatenate(parts)
        pairs = np.stack([known[keys >> 32], known[keys & _OBJECT]], axis=1)
        related: NDArray[np.int64] = pairs[(pairs >= 0).all(axis=1)]
        return related

    def count(self) -> int:
        """Return how many quads the store holds."""
        return sum(map(len, self.graphs.values())) + self._snapshot.count(self._builds)

    def _among(self, condition: str) -> Facts:
        """Return the triples of the graphs whose names fulfil a condition on ?graph, each once."""
        names = " ".join(str(NamedNode(name)) for name in self.graphs if name)
        rows = Store().query(f"SELECT ?graph {{ VALUES ?graph {{ {names} }} FILTER({condition}) }}")
        return union_of(self.graphs[row[0].value] for row in cast("Iterable[Any]", rows))

    def _solutions(self, question: _Question) -> Table:
        """Return what the rules of a query bind its variables to; 0 where that is nothing."""
        names, rules, distinct = question.names, question.rules, question.distinct
        among = {place: self._among(condition) for place, condition in question.chosen.items()}
        helping = Program(rule for rule in rules if rule.head[0].predicate != _MARK)
        known = self.union
        if helping.rules:
            known = known.copy()
            for predicate, keys in evaluate(helping, self.dictionary, self.union).inferred:
                known.add(predicate, keys)
        shop = helping.workshop(self.dictionary)
        tables = []
        for rule in (rule for rule in rules if rule.head[0].predicate == _MARK):
            prepared = plan(rule, self.dictionary)
            heads = zip(rule.head, prepared.heads, strict=True)
            columns = {cast("NamedNode", atom.predicate).value: head.object for atom, head in heads}
            chosen = [columns.get(f"{_COLUMN}{name}", 0) for name in names]
            outputs = prepared.outputs if distinct else prepared.outputs | prepared.body.names
            view = View([among.get(question.block(source.reads), known) for source in prepared.sources])
            tables += [
                Table({name: _column(table, node) for name, node in zip(names, chosen, strict=True)}, table.rows)
                for table in Solver(shop, view).solutions(prepared.body, outputs, bag=not distinct)
            ]
        every = concatenate(tables, names)
        return distinct_rows(every) if distinct else every

    def _rows(self, names: Sequence[str], table: Table) -> Iterable[Any]:
        """Return solutions as rows of terms."""
        columns = [table.columns[name].tolist() for name in names]
        self._learn(set(chain.from_iterable(columns)))
        terms = [map(self._terms.__getitem__, column) for column in columns]
        return map(_row_of(tuple(names)), zip(*terms, strict=True))

    def _learn(self, identifiers: set[int]) -> None:
        """Make terms of those that have not been made yet."""
        new = list(identifiers - self._terms.keys())
        self._terms.update(zip(new, map(_Value, self.dictionary.spellings(new)), strict=True))


class _Value:
    """A term of a row. Readings want the value alone: one text for each term, whose hash is computed once."""

    __slots__ = ("value",)

    def __init__(self, spelling: bytes) -> None:
        if b"\\" in spelling or spelling.startswith((b"<<", b"_")):
            self.value = str(getattr(of_spelling(spelling), "value", ""))
        else:
            self.value = spelling[1 : -1 if spelling.startswith(b"<") else spelling.rindex(b'"')].decode()


def _column(table: Table, node: object) -> Keys:
    """Return the values of a column, or as many times a constant."""
    return table.columns[node] if isinstance(node, str) else np.full(table.rows, node, np.int64)


def _name(graph: NamedNode | None) -> str:
    return "" if graph is None else graph.value


@dataclass(frozen=True, slots=True)
class _Question:
    """A query as rules; `chosen` has the conditions on graphs of parts of their text, from one place to another."""

    names: Sequence[str]
    rules: Sequence[Rule]
    distinct: bool
    chosen: Mapping[tuple[int, int], str]
    lines: Sequence[int]

    def block(self, reads: Atom | EngineBlock) -> tuple[int, int]:
        """Return the part of the text, of those with a condition, in which an atom is; (0, 0) without one."""
        assert reads.place is not None  # noqa: S101 - `decompose` gives all atoms one
        at = self.lines[(reads.place.line or 1) - 1] + (reads.place.column or 1) - 1
        return next((part for part in self.chosen if part[0] <= at < part[1]), (0, 0))


@lru_cache(maxsize=64)
def _row_of(names: tuple[str, ...]) -> type[tuple[_Value | None, ...]]:
    """Return the type of rows, which have their terms by place and by the name of a variable."""
    places = {name: place for place, name in enumerate(names)}

    class Row(tuple[Any, ...]):
        __slots__ = ()

        def __getitem__(self, key: Any) -> Any:
            return tuple.__getitem__(self, places[key] if isinstance(key, str) else key)

    return Row


def _question(text: str, prefixes: Mapping[str, str]) -> _Question | None:
    """Return what a SELECT becomes; None for one that rules cannot express."""
    match = _SELECT.match(text)
    if match is None:
        return None
    names = match["names"].replace("?", " ").split()
    declared = "".join(f"PREFIX {name}: <{iri}>\n" for name, iri in prefixes.items() if f"{name}:" in text)
    # A new blank node for each solution: no solution may then be left out, or come more often than the query has it.
    head = " ".join(f"_:row <{_COLUMN}{name}> ?{name} ." for name in names)
    whole = f"{declared}{match['prologue']}CONSTRUCT {{ _:row <{_COLUMN}> <{_COLUMN}> . {head} }} WHERE "
    whole += _NO_LIMIT.sub("", text[match.end() :])
    chosen = {}
    if match["distinct"]:  # a triple of several graphs would come several times
        for block in _GRAPHS.finditer(whole):
            chosen[block.end(), block.end("body")] = block["condition"]
        whole = _GRAPHS.sub(lambda block: " " * len(block[0]), whole)
    try:
        (stated,) = parse_rq(whole, "query").rules
        rules = decompose(stated, "query", "query", whole)
    except KgError:
        return None
    if any(isinstance(element, EngineBlock) for rule in rules for element, _ in readers_of(rule.body)):
        return None
    starts = [0, *(found.end() for found in re.finditer("\n", whole))]
    return _Question(names, rules, match["distinct"] is not None, chosen, starts)
