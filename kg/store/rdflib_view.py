"""A generation of a store as an rdflib `Dataset`, for programs that use rdflib."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Any, NoReturn, Self, TypeAlias

from oxrdflib import OxigraphStore
from oxrdflib._converter import from_ox, from_ox_graph_name, to_ox, to_ox_quad_pattern
from pyoxigraph import BlankNode, Literal, NamedNode, Store
from rdflib import Dataset
from rdflib.graph import ModificationException

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rdflib.query import Result

    from kg.store.snapshot import EmbeddedSnapshot

    Prepare: TypeAlias = Callable[[str, Mapping[str, NamedNode | Literal]], str]


class SnapshotDataset(Dataset):
    """All graphs of a snapshot, read-only; their union is what the dataset itself and its queries see.

    Use it as a context manager, or close it: it protects its generation on disk, and closes the snapshot with itself.
    Queries run in the engine of the store. The given prefixes are bound. `prepare` checks a query, and returns it with
    values for its variables.

    Raises on every change:
        rdflib.graph.ModificationException: a snapshot never changes.
    """

    def __init__(self, snapshot: EmbeddedSnapshot, prefixes: Mapping[str, str], prepare: Prepare) -> None:
        self._snapshot = snapshot
        super().__init__(store=_SnapshotStore(snapshot.engine, prepare), default_union=True)
        for prefix, iri in prefixes.items():
            self.bind(prefix, iri, replace=True)

    def close(self, commit_pending_transaction: bool = False) -> None:  # noqa: ARG002, FBT001, FBT002 - as rdflib has it
        """Close the snapshot; closing twice is allowed."""
        self._snapshot.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _SnapshotStore(OxigraphStore):
    """A read-only `oxrdflib` store, in which the union of all graphs has each triple once."""

    def __init__(self, engine: Store, prepare: Prepare) -> None:
        super().__init__(store=engine)
        self._prepare = prepare

    def query(self, query: Any, initNs: Any, initBindings: Any, queryGraph: Any, **kwargs: object) -> Result:  # noqa: N803 - names of rdflib
        """Run a query; `initBindings` gives values to any of its variables, whether or not it returns them."""
        blank = initBindings
        if isinstance(query, str):
            terms = {str(name): to_ox(value) for name, value in initBindings.items()}
            values = {name: term for name, term in terms.items() if not isinstance(term, BlankNode)}
            query = self._prepare(query, values)  # type: ignore[arg-type] # all others were IRIs and literals
            blank = {name: value for name, value in initBindings.items() if str(name) not in values}
        return super().query(query, initNs, blank, queryGraph, **kwargs)

    def triples(self, triple_pattern: Any, context: Any = None) -> Iterator[Any]:
        """Yield the matching triples, each once, with the graphs that contain it."""
        pattern = to_ox_quad_pattern(triple_pattern, context)
        # The engine reads an index with the graph as its last column, so equal triples are adjacent.
        for triple, quads in groupby(self._inner.quads_for_pattern(*pattern), lambda quad: quad.triple):
            graphs = [from_ox_graph_name(quad.graph_name, self) for quad in quads]
            yield (from_ox(triple.subject), from_ox(triple.predicate), from_ox(triple.object)), iter(graphs)

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise ModificationException

    add = addN = remove = update = remove_graph = _refuse  # noqa: N815 - names of rdflib

    def add_graph(self, graph: Any) -> None:
        """Do nothing: rdflib announces each graph that is accessed, the default graph first."""
