"""Triples of a store as columns: which ones rules need, reading them graph by graph, and their lines of N-Triples.

Only what the rules read, or might infer, is read: for `?x :p ?y` the triples of a predicate, for `?x a :Node` those of
a predicate with one object. Reading takes far longer than evaluation, so it is
done in two threads, while a third interns what they give.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass
from itertools import groupby, islice
from operator import itemgetter
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from pyoxigraph import Literal, NamedNode, Quad, RdfFormat, Triple, parse

from kg.lazily import lazily
from kg.rules.engine.facts import Facts, Keys, Packed, Shelf, gathered, pack, union, unpack
from kg.rules.form import AUXILIARY, EngineBlock, Rule, Term, is_auxiliary, readers_of
from kg.store.terms import cells, spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from kg.rules.engine.pages import Pages
    from kg.rules.engine.terms import Dictionary

with lazily():
    from concurrent.futures import ThreadPoolExecutor

_THREADS: Final = 2
_SMALL: Final = 20_000
"""A graph that gives fewer rows than this is read by one query: most are, and there are hundreds of predicates."""
_PIECE_BYTES: Final = 4 << 20
_OBJECT: Final = np.int64((1 << 32) - 1)

_TOGETHER: Final = 256
"""How many sets are united at once."""

_ROWS: Final = 1 << 12
"""How many lines are made at once."""

_AUXILIARY: Final = b"<" + AUXILIARY.encode()


def stored(facts: Facts, dictionary: Dictionary) -> Facts:
    """Return the triples that belong into a store: those of predicates that decomposition did not make."""
    result = Facts()
    for predicate, keys in facts:
        if not dictionary.spelling(predicate).startswith(_AUXILIARY):
            result.replace(predicate, keys)
    return result


def lines(facts: Facts, dictionary: Dictionary, predicates: Iterable[int] | None = None) -> Iterator[bytes]:
    """Yield the triples, or those of some predicates, as chunks of N-Triples, in the order of predicates."""
    for predicate in sorted(facts.predicates if predicates is None else predicates, key=dictionary.spelling):
        keys = facts.keys(predicate)
        middle = b" " + dictionary.spelling(predicate) + b" "
        for begin in range(0, keys.size, _ROWS):
            subjects, objects = unpack(keys[begin : begin + _ROWS])
            parts = [middle] * (4 * subjects.size)
            parts[0::4] = dictionary.spellings(subjects)
            parts[2::4] = dictionary.spellings(objects)
            parts[3::4] = [b" .\n"] * subjects.size
            yield b"".join(parts)
            if dictionary.pages is not None:
                dictionary.pages.release()


def graph_name(graph: NamedNode | None) -> str:
    """Return the IRI of a graph, empty for the default graph."""
    return "" if graph is None else graph.value


class Tables(Protocol):
    """Source of columns: a snapshot of a store, or an open transaction."""

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph (None: the default graph) as TSV, without the line of names."""

    def graphs(self) -> list[NamedNode]:
        """Return the named graphs."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which triples: of whole predicates, and of a predicate with one object; None is every triple."""

    predicates: frozenset[NamedNode] | None
    members: frozenset[tuple[NamedNode, Term]] = frozenset()

    @property
    def names(self) -> frozenset[NamedNode]:
        """All predicates of which some triples are wanted, unless every triple is."""
        return frozenset({*(self.predicates or ()), *(predicate for predicate, _ in self.members)})

    def __or__(self, other: Wanted) -> Wanted:
        """Return the union of both."""
        if self.predicates is None or other.predicates is None:
            return EVERYTHING
        return _simplified(self.predicates | other.predicates, self.members | other.members)


EVERYTHING: Final = Wanted(None)


def wanted(rules: Iterable[Rule]) -> Wanted:
    """Return the triples that rules read or might infer: an asserted triple is not inferred."""
    predicates: set[NamedNode] = set()
    members: set[tuple[NamedNode, Term]] = set()
    for rule in rules:
        for element in (*rule.head, *(each for each, _ in readers_of(rule.body))):
            if isinstance(element, EngineBlock):
                if element.reads is None:
                    return EVERYTHING
                predicates |= element.reads
            elif not isinstance(element.predicate, NamedNode):
                return EVERYTHING
            elif not isinstance(element.object, NamedNode | Literal):
                # Queries cannot name a blank node.
                predicates.add(element.predicate)
            else:
                members.add((element.predicate, element.object))
    return _simplified(predicates, members)


def _simplified(predicates: Iterable[NamedNode], members: Iterable[tuple[NamedNode, Term]]) -> Wanted:
    whole = frozenset(one for one in predicates if not is_auxiliary(one))
    single = (pair for pair in members if pair[0] not in whole and not is_auxiliary(pair[0]))
    return Wanted(whole, frozenset(single))


def read_columns(source: Tables, what: Wanted, graphs: Iterable[NamedNode | None], dictionary: Dictionary) -> Facts:
    """Return the triples that any of `graphs` has (None: the default graph), each once; terms go into `dictionary`."""
    return union_of(read(source, what, graphs, dictionary).values(), dictionary.pages)


def read(
    source: Tables, what: Wanted, graphs: Iterable[NamedNode | None], dictionary: Dictionary
) -> dict[NamedNode | None, Packed]:
    """Return the wanted triples of each graph by itself."""
    by_graph: dict[NamedNode | None, defaultdict[int, list[Keys]]] = {graph: defaultdict(list) for graph in graphs}
    large = list(by_graph)
    if what.predicates is not None:
        large = []
        # One query for everything wanted of a small graph, and of some predicates more than is wanted. With VALUES the
        # engine looks up each predicate; a FILTER would compare all triples with all predicates.
        listed = " ".join(sorted(map(str, what.names)))
        together = _Query(f"SELECT ?s ?p ?o {{ VALUES ?p {{ {listed} }} ?s ?p ?o }} LIMIT {_SMALL}")
        for _, graph, text in _texts(source, [together], list(by_graph)):
            if text.count(b"\n") >= _SMALL:
                large.append(graph)
                continue
            for predicate, keys in only(what, together.keys(text, dictionary), dictionary):
                by_graph[graph][predicate].append(keys)
    for query, graph, text in _texts(source, _queries(what), large):
        for predicate, keys in query.keys(text, dictionary):
            by_graph[graph][predicate].append(keys)
    shelf = Shelf(dictionary.pages)
    result = {graph: shelf.add(packed(columns, dictionary.pages)) for graph, columns in by_graph.items()}
    shelf.move()
    return result


def packed(columns: Mapping[int, Sequence[Keys]], pages: Pages | None) -> Packed:
    """Return the triples of columns in pieces, as `gathered`."""
    return Packed.of(gathered(columns, pages), pages)


def only(
    what: Wanted, columns: Iterable[tuple[int, NDArray[np.int64]]], dictionary: Dictionary
) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield the pairs of those predicates that are wanted, of some with the wanted objects only."""
    whole = {dictionary.intern_term(predicate) for predicate in what.predicates or ()}
    single: dict[int, list[int]] = {}
    for predicate, target in what.members:
        single.setdefault(dictionary.intern_term(predicate), []).append(dictionary.intern_term(target))
    for number, keys in columns:
        if number in whole:
            yield number, keys
        elif number in single:
            yield number, keys[np.isin(keys & _OBJECT, single[number])]


@dataclass(frozen=True, slots=True)
class _Query:
    """A SELECT of whole triples, or without the `predicate` that it names, and without its one object, the `target`."""

    text: str
    predicate: NamedNode | None = None
    target: Term | None = None

    def keys(self, text: bytes, dictionary: Dictionary) -> Iterator[tuple[int, NDArray[np.int64]]]:
        """Yield the predicates of the rows with their keys in any order."""
        if not text:
            return
        if self.predicate is None:
            yield from by_predicate(_interned(text, 3, dictionary).reshape(-1, 3))
        elif self.target is None:
            pairs = _interned(text, 2, dictionary)
            yield dictionary.intern_term(self.predicate), pack(pairs[0::2], pairs[1::2])
        else:
            subjects = _interned(text, 1, dictionary)
            target = np.int64(dictionary.intern_term(self.target))
            yield dictionary.intern_term(self.predicate), (subjects << 32) | target


def _interned(text: bytes, width: int, dictionary: Dictionary) -> NDArray[np.int64]:
    """Return the identifiers of the cells of a table, split piece by piece: cells take several times its size."""
    pieces = []
    begin = 0
    while begin < len(text):
        end = text.find(b"\n", begin + _PIECE_BYTES) + 1 or len(text)
        pieces.append(dictionary.intern_all(cells(text[begin:end], width)))
        begin = end
    return np.concatenate(pieces)


def by_predicate(rows: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield each predicate of rows of subject, predicate and object with its keys in any order."""
    if not len(rows):
        return
    ordered = rows[np.argsort(rows[:, 1], kind="stable")]
    starts = np.flatnonzero(np.diff(ordered[:, 1], prepend=-1))
    for start, end in zip(starts, [*starts[1:], len(ordered)], strict=True):
        part = ordered[start:end]
        yield int(part[0, 1]), pack(part[:, 0], part[:, 2])


def _queries(what: Wanted) -> list[_Query]:
    if what.predicates is None:
        return [_Query("SELECT ?s ?p ?o { ?s ?p ?o }")]
    return [
        *(_Query(f"SELECT ?s ?o {{ ?s {one} ?o }}", one) for one in sorted(what.predicates, key=str)),
        *(
            _Query(f"SELECT ?s {{ ?s {one} {spell(target).decode()} }}", one, target)
            for one, target in sorted(what.members, key=str)
        ),
    ]


def _texts(
    source: Tables, queries: list[_Query], graphs: list[NamedNode | None]
) -> Iterator[tuple[_Query, NamedNode | None, bytes]]:
    """Yield the rows of each query over each graph; only a few are read ahead, which bounds memory."""
    with ThreadPoolExecutor(_THREADS) as pool:
        tasks = ((query, graph, pool.submit(source.table, query.text, graph)) for graph in graphs for query in queries)
        pending = deque(islice(tasks, 2 * _THREADS))
        while pending:
            query, graph, rows = pending.popleft()
            pending.extend(islice(tasks, 1))
            yield query, graph, rows.result()


def union_of(parts: Iterable[Facts | Packed], pages: Pages | None = None) -> Facts:
    """Return the triples that any of some sets has; the sets of one are shared. Large arrays go to `pages`."""
    every = list(parts)
    if len(every) == 1:
        return every[0].copy()
    result = Facts(pages=pages)
    # There may be a thousand sets, with few of all predicates each.
    for begin in range(0, len(every), _TOGETHER):
        columns: defaultdict[int, list[Keys]] = defaultdict(list)
        for part in every[begin : begin + _TOGETHER]:
            for predicate, keys in part:
                columns[predicate].append(keys)
        for predicate, pieces in columns.items():
            result.replace(predicate, union(result.keys(predicate), *pieces))
    return result


def rows_of(triples: Iterable[Triple | Quad], dictionary: Dictionary) -> NDArray[np.int64]:
    """Return triples as rows of identifiers, terms spelt as a store spells them; blank nodes keep their labels."""
    terms = (spell(part) for one in triples for part in (one.subject, one.predicate, one.object))
    return dictionary.intern_all(terms).reshape(-1, 3)


def stated(triples: Iterable[Triple | Quad], dictionary: Dictionary) -> Facts:
    """Return triples as columns."""
    return gathered({predicate: [keys] for predicate, keys in by_predicate(rows_of(triples, dictionary))})


def patched(
    facts: Facts | Packed, patches: Iterable[tuple[bytes, bytes]], dictionary: Dictionary
) -> tuple[Facts, set[int]]:
    """Return the columns of a graph after patches, and the predicates that these name."""
    result, touched = facts.copy(), set[int]()
    parts = ((adds, text) for patch in patches for adds, text in enumerate(patch) if text.strip())
    for adds, together in groupby(parts, itemgetter(0)):  # each reading costs more than a few triples
        lines = b"".join(text for _, text in together)
        for predicate, keys in stated(parse(lines, RdfFormat.N_TRIPLES, lenient=True), dictionary):
            (result.add if adds else result.remove)(predicate, keys)
            touched.add(predicate)
    return result, touched
