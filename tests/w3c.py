"""The SPARQL 1.1 test suites of W3C, read from a folder next to the repository: cases, data and expected results.

    for case in cases("protocol/manifest.ttl"): ...         what a manifest lists
    put(layout, case.default, case.named)                    a store with the data of a case
    same_solutions(expected, found)                          whether two results are the same but for blank nodes

The suites are w3c/rdf-tests; their files are named as they are published, below `BASE`.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import pyoxigraph
import pytest
from pyoxigraph import BlankNode, Dataset, DefaultGraph, Literal, NamedNode, RdfFormat, Store
from repository import ROOT

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.store.layout import Layout

__all__ = [
    "BASE",
    "KNOWN",
    "MF",
    "SUITES",
    "Case",
    "Manifest",
    "Solutions",
    "cases",
    "expected_solutions",
    "parameters",
    "put",
    "same_graphs",
    "same_solutions",
]

SUITES: Final = ROOT.parent / "shared" / "w3c" / "rdf-tests" / "sparql" / "sparql11"
"""The folder of the suites; their tests skip without it."""
BASE: Final = "https://w3c.github.io/rdf-tests/sparql/sparql11/"
"""The prefix of the addresses of their files."""

MF: Final = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#"
_QT: Final = "http://www.w3.org/2001/sw/DataAccess/tests/test-query#"
_UT: Final = "http://www.w3.org/2009/sparql/tests/test-update#"
_RS: Final = "http://www.w3.org/2001/sw/DataAccess/tests/result-set#"
_RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
_LABEL: Final = NamedNode("http://www.w3.org/2000/01/rdf-schema#label")

_GRAPH_SCOPE: Final = "the engine scopes the variable of GRAPH in another way"
_PATHS: Final = "the engine gives paths of length zero in another way when one end is in no triple"
_CONCATENATION: Final = "the engine keeps the language of what it concatenates"
KNOWN: Final[Mapping[str, str]] = {
    "negation/manifest#graph-minus": _GRAPH_SCOPE,
    "aggregates/manifest#agg-empty-group-count-graph": _GRAPH_SCOPE,
    "bindings/manifest#graph": _GRAPH_SCOPE,
    "property-path/manifest#zero_or_more_set_start": _PATHS,
    "property-path/manifest#zero_or_more_set_end": _PATHS,
    "property-path/manifest#zero_or_one_set_start": _PATHS,
    "property-path/manifest#zero_or_one_set_end": _PATHS,
    "aggregates/manifest#agg-groupconcat-04": _CONCATENATION,
    "aggregates/manifest#agg-groupconcat-06": _CONCATENATION,
    "functions/manifest#bnode01": "BNODE gives one node for a text in all rows; Oxigraph's tests compare row by row",
}
"""Cases that the engine fails, with the reason: those that Oxigraph's own tests skip (0.5.9) or do not detect."""

Node: TypeAlias = NamedNode | BlankNode
Row: TypeAlias = "tuple[Any, ...]"


@dataclass(frozen=True, slots=True)
class Solutions:
    """Rows, or a Boolean: the result of SELECT and ASK."""

    variables: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    boolean: bool | None = None


class Manifest:
    """An RDF file to navigate from node to node."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._store = Store()
        base = BASE + str(path.relative_to(SUITES))
        self._store.load(path=str(path), format=RdfFormat.TURTLE, base_iri=base)

    def all(self, node: Any, name: str) -> list[Any]:
        """Return the values of a property."""
        return [quad.object for quad in self._store.quads_for_pattern(node, NamedNode(name), None, None)]

    def one(self, node: Any, name: str) -> Any:
        """Return the value of a property, or None."""
        return next(iter(self.all(node, name)), None)

    def text(self, node: Any, name: str) -> str:
        """Return the text of a property, or an empty text."""
        found = self.one(node, name)
        return found.value if found else ""

    def items(self, head: Any) -> Iterator[Any]:
        """Yield the items of a list."""
        while head is not None and head != NamedNode(_RDF + "nil"):
            yield self.one(head, _RDF + "first")
            head = self.one(head, _RDF + "rest")

    def listed(self, name: str) -> Iterator[Any]:
        """Yield the items of every list that is a value of a property."""
        for quad in self._store.quads_for_pattern(None, NamedNode(name), None, None):
            yield from self.items(quad.object)


@dataclass(frozen=True, slots=True)
class Case:
    """One test: `identity` is its name below `BASE`, `kind` its type, `node` its node in the `manifest`."""

    identity: str
    kind: str
    node: Node
    manifest: Manifest

    @property
    def action(self) -> Any:
        """The action: a file, or a node with its details."""
        return self.manifest.one(self.node, MF + "action")

    @property
    def query(self) -> str:
        """The text of the query or the update, with its published base."""
        named = self.manifest.one(self.action, _QT + "query") or self.manifest.one(self.action, _UT + "request")
        file = named or self.action
        return f"BASE <{file.value}>\n{path_of(file).read_text(encoding='utf-8')}"

    @property
    def default(self) -> list[Any]:
        """The files of the default graph."""
        return self.manifest.all(self.action, _QT + "data") + self.manifest.all(self.action, _UT + "data")

    @property
    def named(self) -> dict[str, Any]:
        """The files of the named graphs."""
        return {
            **{file.value: file for file in self.manifest.all(self.action, _QT + "graphData")},
            **self._updated(self.action),
        }

    def _updated(self, node: Any) -> dict[str, Any]:
        """Return the named graphs of an update test before or after it."""
        graphs = self.manifest.all(node, _UT + "graphData")
        return {self.manifest.text(one, _LABEL.value): self.manifest.one(one, _UT + "graph") for one in graphs}

    @property
    def result(self) -> Any:
        """The expected result: a file, or for updates a node."""
        return self.manifest.one(self.node, MF + "result")

    @property
    def after(self) -> tuple[list[Any], dict[str, Any]]:
        """The files of the default graph and of the named graphs after an update."""
        return self.manifest.all(self.result, _UT + "data"), self._updated(self.result)


def path_of(file: NamedNode) -> Path:
    """Return the local path of a published file."""
    return SUITES / file.value.removeprefix(BASE)


@cache
def cases(name: str) -> tuple[Case, ...]:
    """Return the cases of the manifest `name` and of those it includes; empty without the suites."""
    if not SUITES.is_dir():
        return ()
    manifest = Manifest(SUITES / name)
    found = [case for included in manifest.listed(MF + "include") for case in cases(included.value.removeprefix(BASE))]
    for node in manifest.listed(MF + "entries"):
        kind = manifest.text(node, _RDF + "type").rpartition("#")[2]
        folder = name.rpartition("/")[0]
        found.append(Case(f"{folder}/manifest#{node.value.rpartition('#')[2]}", kind, node, manifest))
    return tuple(found)


def parameters(name: str, *kinds: str) -> list[Any]:
    """Return the cases of some kinds (any by default) as parameters of a test; a skipped one if there are none."""
    found = [case for case in cases(name) if case.kind and (not kinds or case.kind in kinds)]
    if not found:
        return [pytest.param(None, marks=pytest.mark.skip(reason=f"the suites of W3C are not at {SUITES}"))]
    return [pytest.param(case, id=case.identity.replace("/manifest#", ":")) for case in found]


_MADE: Final[dict[Path, tuple[int | None, object]]] = {}


def put(layout: Layout, default: Sequence[Any] = (), named: Mapping[str, Any] = {}) -> None:
    """Put files into a new generation of a store and activate it; older generations are removed.

    A current generation made from the same files remains. It is flushed, because data only in the log of a database is
    missing in a generation derived from it.
    """
    content = (tuple(default), tuple(named.items()))
    if _MADE.get(layout.root) == (layout.current(), content):
        return
    number = max([0, *layout.numbers()]) + 1
    store = Store(str(layout.generation(number)))
    for file in default:
        _load(store, file, DefaultGraph())
    for name, file in named.items():
        store.add_graph(NamedNode(name))
        _load(store, file, NamedNode(name))
    store.flush()
    del store
    layout.switch(number)
    _MADE[layout.root] = (number, content)
    for older in layout.numbers():
        if older < number - 1:
            shutil.rmtree(layout.generation(older), ignore_errors=True)


def _load(store: Store, file: NamedNode, graph: NamedNode | DefaultGraph) -> None:
    store.load(path_of(file).read_bytes(), _format(file), base_iri=file.value, to_graph=graph)


def _format(file: NamedNode) -> RdfFormat:
    found = RdfFormat.from_extension(file.value.rpartition(".")[2])
    assert found is not None, file
    return found


def triples(file: NamedNode) -> list[Any]:
    """Return the triples of a file."""
    return [quad.triple for quad in pyoxigraph.parse(path_of(file).read_bytes(), _format(file), base_iri=file.value)]


def expected_solutions(file: NamedNode) -> Solutions:
    """Return the rows, or the Boolean, of a file of results."""
    extension = file.value.rpartition(".")[2]
    if extension in {"ttl", "rdf"}:
        return _result_set(Manifest(path_of(file)))
    results_format = pyoxigraph.QueryResultsFormat.from_extension(extension)
    assert results_format is not None, file
    return solutions(path_of(file).read_bytes(), results_format)


def solutions(content: bytes, results_format: pyoxigraph.QueryResultsFormat) -> Solutions:
    """Return the rows, or the Boolean, of a text in a format of results."""
    found = pyoxigraph.parse_query_results(content, results_format)
    if isinstance(found, pyoxigraph.QueryBoolean):
        return Solutions(boolean=bool(found))
    variables = tuple(variable.value for variable in found.variables)
    return Solutions(variables, tuple(tuple(row) for row in found))


def _result_set(manifest: Manifest) -> Solutions:
    """Return rows that are given as RDF."""
    sets = manifest._store.quads_for_pattern(None, NamedNode(_RS + "resultVariable"), None, None)
    variables = tuple(sorted({str(getattr(quad.object, "value", "")) for quad in sets}))
    rows = []
    for quad in manifest._store.quads_for_pattern(None, NamedNode(_RS + "solution"), None, None):
        bindings = manifest.all(quad.object, _RS + "binding")
        values = {manifest.text(one, _RS + "variable"): manifest.one(one, _RS + "value") for one in bindings}
        rows.append(tuple(values.get(name) for name in variables))
    return Solutions(variables, tuple(rows))


def same_graphs(expected: Sequence[Any], found: Sequence[Any]) -> bool:
    """Whether two lists of triples or quads are equal except for blank node labels."""
    return _canonical(expected) == _canonical(found)


def _canonical(statements: Sequence[Any]) -> Dataset:
    quads = (one if isinstance(one, pyoxigraph.Quad) else pyoxigraph.Quad(*one) for one in statements)
    dataset = Dataset(quads)
    dataset.canonicalize(pyoxigraph.CanonicalizationAlgorithm.UNSTABLE)
    return dataset


def same_solutions(expected: Solutions, found: Solutions) -> bool:
    """Whether two results have the same rows, with multiplicity, in any order, except for blank node labels."""
    if expected.boolean is not None or found.boolean is not None:
        return expected.boolean == found.boolean
    if set(expected.variables) != set(found.variables) or len(expected.rows) != len(found.rows):
        return False
    order = [found.variables.index(name) for name in expected.variables]
    return _pair(list(expected.rows), [tuple(row[index] for index in order) for row in found.rows], {})


def _pair(expected: list[Row], found: list[Row], names: dict[Any, Any]) -> bool:
    """Find a row of `found` for each of `expected`, with a consistent mapping of blank nodes."""
    if not expected:
        return True
    for index, row in enumerate(found):
        more = _match(expected[0], row, names)
        if more is not None and _pair(expected[1:], found[:index] + found[index + 1 :], more):
            return True
        if more is not None and more == names:
            return False  # the rows are equal: another one would not help
    return False


def _match(expected: Row, found: Row, names: dict[Any, Any]) -> dict[Any, Any] | None:
    more = dict(names)
    for wanted, got in zip(expected, found, strict=True):
        if isinstance(wanted, BlankNode) and isinstance(got, BlankNode):
            if more.setdefault(wanted, got) != got or list(more.values()).count(got) > 1:
                return None
        elif _value(wanted) != _value(got):
            return None
    return more


_DERIVED: Final = {"negativeInteger": "integer"}
"""Number types that the engine does not distinguish from a wider one."""


def _value(term: Any) -> Any:
    """Normalise a term: the engine stores values, not their spelling, so equal values of one type are equal."""
    name = term.datatype.value.rpartition("#")[2] if isinstance(term, Literal) else ""
    name = _DERIVED.get(name, name)
    if name == "boolean":
        return term.value in {"true", "1"}, name
    if name in {"decimal", "double", "float", "integer"}:
        try:
            return float(term.value), name
        except ValueError:
            return term
    return term
