"""Queries over the whole store, answered from the columns that the last run of rules left.

    graph = columns_of(snapshot)
    rows = graph.query("SELECT ?node ?name { ?node a rnkg:NodeType ; rnkg:name ?name }", prefixes=PREFIXES)

The engine of the store takes microseconds to turn each term of an answer into text. Columns have the texts of all terms
one after the other, and joins over them take milliseconds, so that a query with many rows takes a tenth of the time. A
look-up of few rows is cheaper in the store, for it loads nothing.

What rules cannot express (`kg.rules.questions`) is left to the store, and everything where the columns do not belong to
its generation.
"""

from __future__ import annotations

import re
from collections import defaultdict
from functools import cached_property, lru_cache, partial
from itertools import chain, islice, pairwise
from typing import TYPE_CHECKING, Any, Final, TypeAlias, TypeVar, cast

import numpy as np
from pyoxigraph import Literal, NamedNode, Store

from kg.rules import memory as memories
from kg.rules.columns import graph_name, patched, stated, union_of
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import EMPTY, NOTHING, Facts, Keys, Packed, pack, unpack
from kg.rules.engine.planning import plan
from kg.rules.engine.solve import Solver
from kg.rules.engine.tables import Table, concatenate, distinct_rows
from kg.rules.form import Atom, TripleTerm, Variable
from kg.rules.questions import COLUMN, MARK, Among, Question, question
from kg.store.changes import since
from kg.store.terms import Term, of_spelling, spell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kg.rules.engine.terms import Dictionary
    from kg.store.snapshot import EmbeddedSnapshot

    Row: TypeAlias = tuple[Term | None, ...]

_INTEGER: Final = b'"^^<http://www.w3.org/2001/XMLSchema#integer>'


def modified(question: Question, solutions: Table, dictionary: Dictionary) -> Table | None:
    """Return the rows of an answer; None where it has an order of terms that only the store knows."""
    table = _counted(question, solutions, dictionary) if question.grouped else solutions
    table = Table({name: table.columns[name] for name in question.shown}, table.rows)
    if question.distinct:
        table = distinct_rows(table)
    if not question.order:
        return table.take(slice(question.limit))
    return _ordered(table, question.order, question.limit, dictionary)


def _counted(question: Question, table: Table, dictionary: Dictionary) -> Table:
    """Return a row for each group of solutions; without keys all are one group, be there none."""
    if question.keys:
        _, first, group = np.unique(table.packed(question.keys), return_index=True, return_inverse=True)
        columns, size = {key: table.columns[key][first] for key in question.keys}, first.size
    else:
        columns, size, group = {}, 1, np.zeros(table.rows, np.int64)
    for name, counted in question.shown.items():
        if counted is not None:
            among = group if counted == "*" else group[table.columns[counted] != 0]
            numbers, places = np.unique(np.bincount(among, minlength=size), return_inverse=True)
            columns[name] = dictionary.intern_all(spell(Literal(number)) for number in numbers.tolist())[places]
    return Table(columns, size)


def _ordered(
    table: Table, order: Sequence[tuple[str, bool]], limit: int | None, dictionary: Dictionary
) -> Table | None:
    """Return sorted rows. With a limit only those are sorted that the first column leaves among the first."""
    keys: list[Keys] = []
    for name, down in order:
        ranks = _ranks(table.columns[name], dictionary)
        if ranks is None:
            return None
        keys.append(-ranks if down else ranks)
        if len(keys) == 1 and limit and table.rows > limit:
            best = keys[0] <= np.partition(keys[0], limit - 1)[limit - 1]
            table, keys = table.take(best), [keys[0][best]]
    return table.take(np.lexsort(keys[::-1])[:limit])


def _ranks(column: Keys, dictionary: Dictionary) -> Keys | None:
    """Return for each term its place in the order; None unless all are IRIs, plain strings or integers."""
    terms, places = np.unique(column, return_inverse=True)
    spelt = dictionary.spellings(terms[terms != 0])
    values = _compared(spelt)
    if values is None:
        return None
    numbers = {value: number for number, value in enumerate(sorted(set[Any](values)), 1)}
    # What is unbound comes first.
    ranks = np.array([0] * int(terms.size - len(values)) + [numbers[value] for value in values], np.int64)
    result: Keys = ranks[places]
    return result


def _compared(spelt: Sequence[bytes]) -> Sequence[bytes] | Sequence[int] | None:
    """Return what terms are compared by."""
    if all(one.startswith(b"<") and not one.startswith(b"<<") for one in spelt):
        return [one[1:-1] for one in spelt]
    if all(one.startswith(b'"') and one.endswith(b'"') for one in spelt):
        return [str(getattr(of_spelling(one), "value", "")).encode() if b"\\" in one else one[1:-1] for one in spelt]
    if all(one.endswith(_INTEGER) for one in spelt):
        return [int(one[1 : -len(_INTEGER)]) for one in spelt]
    return None


_T = TypeVar("_T")
_ESCAPE: Final = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))")
_UNESCAPED: Final = {"n": "\n", "r": "\r", "t": "\t", "b": "\b", "f": "\f"}
"""Escapes that stand for other characters than their second one (N-Triples, ECHAR)."""
_MANY: Final = 2_000
"""With fewer triples of its smallest pattern, a query is left to the store: it takes no longer than columns do."""


def columns_of(snapshot: EmbeddedSnapshot) -> Columns | EmbeddedSnapshot:
    """Return the columns of a generation, to be asked as the snapshot is; the snapshot itself where none are kept."""
    memory = memories.load(snapshot.layout.cache) if snapshot.layout else None
    if snapshot.layout is None or memory is None or memory.generation is None:
        return snapshot
    changed = since(snapshot.layout, memory.generation, snapshot.generation).graphs
    if changed is None:
        return snapshot
    builds = memory.names.builds
    parts: dict[str, Facts | Packed] = {graph_name(graph): part for graph, part in memory.graphs.items()}
    parts[memory.names.inferred.value] = memory.written
    for graph, patches in changed.items():
        if graph != builds.value:
            if patches is None:
                return snapshot
            parts[graph] = patched(parts.get(graph, NOTHING), patches, memory.dictionary)[0]
    # Rules do not read the record of builds, which is short.
    parts[builds.value] = stated(snapshot.engine.quads_for_pattern(None, None, None, builds), memory.dictionary)
    return Columns(snapshot, memory.dictionary, parts)


class Columns:
    """The triples of each graph of a generation as columns."""

    def __init__(
        self, snapshot: EmbeddedSnapshot, dictionary: Dictionary, graphs: Mapping[str, Facts | Packed]
    ) -> None:
        """`graphs` are named by IRI; the default graph has the empty name."""
        self.dictionary = dictionary
        self.graphs = graphs
        self._snapshot = snapshot
        self._values: dict[int, _Value | None] = {0: None}
        self._texts: dict[int, str | None] = {0: None}
        self._read: dict[tuple[Among, bool], Facts] = {}

    @cached_property
    def union(self) -> Facts:
        """The triples of all graphs, each once."""
        return union_of(self.graphs.values())

    def query(self, text: str, *, prefixes: Mapping[str, str] | None = None) -> Iterable[Any]:
        """Return the rows of a SELECT over the union of all graphs; raises as the store does.

        A triple of several graphs, and a pair that a path connects in two ways, count once. With DISTINCT, or where
        distinct values are counted, the rows are those of the store.
        """
        names, table = self._evaluate(text, prefixes or {})
        if table is None:
            return cast("Iterable[Any]", self._snapshot.query(text, prefixes=prefixes))
        return map(_row_of(names), self._terms(names, table, self._values, _values_of))

    def texts(self, text: str, *, prefixes: Mapping[str, str]) -> Iterator[tuple[str | None, ...]]:
        """Yield the rows of `query` as tuples of IRIs and texts, with None for unbound variables."""
        names, table = self._evaluate(text, prefixes)
        if table is not None:
            return self._terms(names, table, self._texts, _texts_of)
        rows = cast("Iterable[Any]", self._snapshot.query(text, prefixes=prefixes))
        return (tuple(None if term is None else term.value for term in row) for row in rows)

    def _evaluate(self, text: str, prefixes: Mapping[str, str]) -> tuple[tuple[str, ...], Table | None]:
        """Return the variables and rows of a SELECT; no rows where only the store has them."""
        parsed = question(text, prefixes)
        if parsed is None:
            return (), None
        return tuple(parsed.shown), modified(parsed, self._solutions(parsed), self.dictionary)

    def answer(self, text: str, *, prefixes: Mapping[str, str]) -> tuple[tuple[str, ...], list[Row]] | None:
        """Return variables and rows of a SELECT, exactly as the store has them but for an order that is not asked for.

        None where columns do not have the answer, or where the store finds it as fast: a pattern has few triples.
        """
        parsed = question(text, prefixes)
        if parsed is None or not parsed.as_set or self._least(parsed) < _MANY:
            return None
        table = modified(parsed, self._solutions(parsed), self.dictionary)
        if table is None:
            return None
        terms: dict[int, Term | None] = {0: None}
        return tuple(parsed.shown), list(self._terms(list(parsed.shown), table, terms, partial(map, of_spelling)))

    def _least(self, parsed: Question) -> int:
        """Return how many triples the smallest pattern of each rule has, added up."""
        atoms = ([atom for atom in rule.body if isinstance(atom, Atom)] for rule in parsed.rules)
        return sum(min(map(self._size, some), default=0) for some in atoms)

    def _size(self, atom: Atom) -> int:
        """Return how many triples have the constants of an atom."""
        if not isinstance(atom.predicate, NamedNode):
            return len(self.union)
        predicate = self.dictionary.find(spell(atom.predicate)) or 0
        for end, by_object in ((atom.subject, False), (atom.object, True)):
            if not isinstance(end, Variable | TripleTerm):
                number = self.dictionary.find(spell(end))
                return 0 if number is None else self.union.pairs_of(predicate, number, by_object=by_object).size
        return self.union.keys(predicate).size

    def properties(self, graph: str) -> dict[str, dict[str, list[str]]]:
        """Return what a graph says: the values of each property, by its IRI, of each subject."""
        facts = list(self.graphs.get(graph, NOTHING))
        subjects, objects = unpack(np.concatenate([EMPTY, *(keys for _, keys in facts)]))
        predicates = np.repeat([one for one, _ in facts], [keys.size for _, keys in facts]).astype(np.int64)
        return self._grouped(subjects, predicates, objects)

    def grouped(self, text: str, *, prefixes: Mapping[str, str]) -> dict[str, dict[str, list[str]]] | None:
        """Return the rows of a SELECT of subject, predicate and object as `properties` does; None as `answer`."""
        names, table = self._evaluate(text, prefixes)
        return None if table is None else self._grouped(*(table.columns[name] for name in names))

    def _grouped(self, subjects: Keys, predicates: Keys, objects: Keys) -> dict[str, dict[str, list[str]]]:
        """Return the values of each property of each subject."""
        keys = pack(subjects, predicates)
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        begins = np.flatnonzero(np.diff(keys, prepend=-1))
        owners, properties = unpack(keys[begins])
        sizes = np.flatnonzero(np.diff(owners, prepend=-1))
        columns = owners[sizes], properties, objects[order]
        named, terms, values = map(list, cast("list[Iterator[str]]", self._made(columns, self._texts, _texts_of)))
        several = [values[begin:end] for begin, end in pairwise([*begins.tolist(), len(values)])]
        pairs = zip(terms, several, strict=True)
        counts = np.diff(sizes, append=len(terms)).tolist()
        return {name: dict(islice(pairs, number)) for name, number in zip(named, counts, strict=True)}

    def count(self) -> int:
        """Return how many quads the store holds."""
        return sum(map(len, self.graphs.values()))

    def _among(self, among: Among, *, as_set: bool) -> Facts:
        """Return the triples of some graphs: each once, or as often as graphs have it."""
        facts = self._read.get((among, as_set))
        if facts is None:
            names = " ".join(str(NamedNode(name)) for name in self.graphs if name)
            tests = " ".join(f"FILTER({one})" for one in among.conditions)
            text = f"SELECT ?{among.variable} {{ VALUES ?{among.variable} {{ {names} }} {tests} }}"
            parts = [self.graphs[row[0].value] for row in cast("Iterable[Any]", Store().query(text))]
            facts = self._read[among, as_set] = union_of(parts) if as_set else _together(parts)
        return facts

    def _solutions(self, parsed: Question) -> Table:
        """Return what the rules of a query bind its variables to; 0 where that is nothing."""
        names, rules = parsed.names, parsed.rules
        helping = Program(rule for rule in rules if rule.head[0].predicate != MARK)
        facts = self.union
        if helping.rules:
            facts = facts.copy()
            for predicate, keys in evaluate(helping, self.dictionary, self.union).inferred:
                facts.add(predicate, keys)
        state = helping.state(self.dictionary)
        tables = []
        for rule in (rule for rule in rules if rule.head[0].predicate == MARK):
            prepared = plan(rule, self.dictionary)
            heads = zip(rule.head, prepared.heads, strict=True)
            columns = {cast("NamedNode", atom.predicate).value: head.object for atom, head in heads}
            chosen = [columns.get(f"{COLUMN}{name}", 0) for name in names]
            outputs = prepared.outputs if parsed.as_set else prepared.outputs | prepared.body.names
            among = [parsed.among(source.reads) for source in prepared.sources]
            sources = [facts if one is None else self._among(one, as_set=parsed.as_set) for one in among]
            tables += [
                Table({name: _values(table, node) for name, node in zip(names, chosen, strict=True)}, table.rows)
                for table in Solver(state, sources).solutions(prepared.body, outputs, bag=not parsed.as_set)
            ]
        every = concatenate(tables, names)
        return distinct_rows(every) if parsed.as_set else every

    def _terms(
        self, names: Sequence[str], table: Table, terms: dict[int, _T], make: Callable[[list[bytes]], Iterable[_T]]
    ) -> Iterator[tuple[_T, ...]]:
        """Yield solutions as rows; `terms` has what was made of terms already, and gets the others."""
        columns = [table.columns[name] for name in names]
        return zip(*self._made(columns, terms, make), strict=True)

    def _made(
        self, columns: Sequence[Keys], terms: dict[int, _T], make: Callable[[list[bytes]], Iterable[_T]]
    ) -> list[Iterator[_T]]:
        """Return for each column an iterator over what is made of its terms."""
        numbers = [column.tolist() for column in columns]
        # A difference of sets would go through all that is known.
        new = [term for term in set(chain.from_iterable(numbers)) if term not in terms]
        terms.update(zip(new, make(self.dictionary.spellings(new)), strict=True))
        return [map(terms.__getitem__, column) for column in numbers]


class _Value:
    """A term of a row. Readings want the value alone: one text for each term, whose hash is computed once."""

    __slots__ = ("value",)

    def __init__(self, text: str) -> None:
        self.value = text


def _values_of(spellings: list[bytes]) -> Iterable[_Value]:
    return map(_Value, _texts_of(spellings))


def _texts_of(spellings: list[bytes]) -> list[str]:
    """Return the values of terms. Answers about a whole store have 100,000, so they are decoded together."""
    every = b"\n".join(spellings).decode().split("\n") if spellings else []
    return [
        one[1:-1] if "\\" not in one and (one[0] == '"' == one[-1] or one[0] == "<" != one[1]) else _text(one)
        for one in every
    ]


def _text(spelling: str) -> str:
    """Return the value of a term: of a literal the text between its quotes, with escapes resolved."""
    if spelling[0] != '"':
        return str(getattr(of_spelling(spelling), "value", ""))
    return _ESCAPE.sub(_unescaped, spelling[1 : spelling.rindex('"')])


def _unescaped(escape: re.Match[str]) -> str:
    return chr(int(escape[1] or escape[2], 16)) if escape[3] is None else _UNESCAPED.get(escape[3], escape[3])


def _values(table: Table, node: object) -> Keys:
    """Return the values of a column, or as many times a constant."""
    return table.columns[node] if isinstance(node, str) else np.full(table.rows, node, np.int64)


@lru_cache(maxsize=64)
def _row_of(names: tuple[str, ...]) -> type[tuple[_Value | None, ...]]:
    """Return the type of rows, which have their terms by place and by the name of a variable."""
    places = {name: place for place, name in enumerate(names)}

    class Row(tuple[Any, ...]):
        __slots__ = ()

        def __getitem__(self, key: Any) -> Any:
            return tuple.__getitem__(self, places[key] if isinstance(key, str) else key)

    return Row


def _together(parts: Sequence[Facts | Packed]) -> Facts:
    """Return the triples of some sets, each as often as sets have it; they are only read."""
    every: defaultdict[int, list[Keys]] = defaultdict(list)
    for predicate, keys in chain(*parts):
        every[predicate].append(keys)
    return Facts({one: np.sort(np.concatenate(several), kind="stable") for one, several in every.items()})
