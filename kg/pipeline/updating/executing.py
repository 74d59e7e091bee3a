"""Run the operations of an update one after the other inside a transaction, and record their changes.

The engine's own updates do not report their changes. So the engine only evaluates the WHERE of an operation, as a
query. Templates are filled here, and the differences are written as a patch.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import DefaultGraph, NamedNode, Quad

from kg.errors import QueryError
from kg.pipeline.updating.operations import Data, Manage, Modify, Operation
from kg.pipeline.updating.templates import Template, data, iris
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.store.transaction import EmbeddedTransaction

_DEFAULT: Final = DefaultGraph()


class Executor:
    """Writes into a transaction and counts; the graphs `protected` are refused.

    `removed` and `added` count triples by the name of their graph, "" for the default graph.
    """

    def __init__(self, transaction: EmbeddedTransaction, protected: Iterable[NamedNode]) -> None:
        self._transaction = transaction
        self._protected = frozenset(protected)
        self.removed: Counter[str] = Counter()
        self.added: Counter[str] = Counter()
        self.touched: set[str] = set()
        self.skipped: set[NamedNode] = set()
        """Protected graphs that an operation on all graphs skipped."""

    def run(self, operation: Operation, text: str, using: Sequence[str], using_named: Sequence[str]) -> None:
        """Run one operation of the update `text`.

        Raises:
            QueryError: KG560 if a graph exists already, or does not exist; KG561 for a protected graph; KG565 for
                `using` combined with USING or WITH.
        """
        match operation:
            case Data():
                quads = data(operation.prologue, operation.quads.of(text))
                self.patch(() if operation.insert else quads, quads if operation.insert else ())
            case Modify():
                self._modify(operation, text, using, using_named)
            case Manage():
                self._manage(operation)

    def patch(self, removed: Iterable[Quad], added: Iterable[Quad]) -> None:
        """Remove quads and then add others; only differences are written. KG561."""
        coming = dict.fromkeys(added)
        gone = [quad for quad in dict.fromkeys(removed) if quad not in coming and self._transaction.contains(quad)]
        new = [quad for quad in coming if not self._transaction.contains(quad)]
        for graph in {quad.graph_name for quad in (*gone, *new)}:
            self.allow(graph)
            self.touched.add(_name(graph))
        self.removed.update(_name(quad.graph_name) for quad in gone)
        self.added.update(_name(quad.graph_name) for quad in new)
        if gone or new:
            self._transaction.patch_quads(gone, new)

    def create(self, graph: NamedNode | DefaultGraph) -> None:
        """Create an empty graph, unless it exists; KG561."""
        self.allow(graph)
        if isinstance(graph, NamedNode) and not self._transaction.has_graph(graph):
            self._transaction.create_graph(graph)
            self.touched.add(graph.value)

    def graphs(self) -> dict[str, tuple[int, int]]:
        """Return the numbers of triples removed from and added to each graph that was written."""
        return {name: (self.removed[name], self.added[name]) for name in sorted(self.touched)}

    def allow(self, graph: Any) -> None:
        """Raise KG561 for a graph that may not be written."""
        if graph in self._protected:
            hint = "Change another graph. FILTER(?g != ...) leaves it out of GRAPH ?g."
            raise QueryError("KG561", f"the graph {graph} is written by kg alone", hint=hint)

    def _modify(self, operation: Modify, text: str, using: Sequence[str], using_named: Sequence[str]) -> None:
        own = operation.graph is not None or operation.using or operation.named
        if own and (using or using_named):
            message = "the request names its data set by parameters and the update by USING or WITH"
            raise QueryError("KG565", message, hint="Keep one of them.")
        graph: NamedNode | DefaultGraph = _DEFAULT
        if operation.graph is not None:
            (graph,) = iris(operation.prologue, [operation.graph])
        delete, insert = (
            Template(operation.prologue, part, text, graph) if part is not None else None
            for part in (operation.delete, operation.insert)
        )
        templates = [template for template in (delete, insert) if template is not None]
        variables = sorted({name for template in templates for name in template.variables})
        query = _select(operation, text, variables, distinct=not (insert and insert.fresh))
        default, named = self._data_set(operation, graph, using, using_named)
        removed: dict[Quad, None] = {}
        added: dict[Quad, None] = {}
        pickers = [
            ([variables.index(name) for name in one.variables], one, removed if one is delete else added)
            for one in templates
        ]
        # Do not hold the solutions longer than this, as they keep the store open.
        for row in self._transaction.solutions(query, default=default, named=named, prefixes=PREFIXES):
            for picker, template, into in pickers:
                into.update(dict.fromkeys(template.fill([row[number] for number in picker])))
        self.patch(removed, added)

    def _data_set(
        self, operation: Modify, graph: NamedNode | DefaultGraph, using: Sequence[str], using_named: Sequence[str]
    ) -> tuple[list[NamedNode | DefaultGraph], list[NamedNode] | None]:
        """Return the graphs of the default graph, and the named graphs (None for all), of a WHERE."""
        if using or using_named:
            return [NamedNode(name) for name in using], [NamedNode(name) for name in using_named]
        if operation.using or operation.named:
            return [*iris(operation.prologue, operation.using)], iris(operation.prologue, operation.named)
        return [graph], None

    def _manage(self, operation: Manage) -> None:
        if operation.verb in {"clear", "drop"}:
            self._empty(operation)
            return
        source, target = self._graph(operation, operation.source), self._graph(operation, operation.target)
        if operation.verb == "create":
            if isinstance(target, NamedNode) and self._check_exists(operation, target, wanted=False):
                self.create(target)
        elif source != target and self._check_exists(operation, source, wanted=True):
            quads = list(self._transaction.quads(source))
            before = [] if operation.verb == "add" else list(self._transaction.quads(target))
            self.patch(before, (Quad(quad.subject, quad.predicate, quad.object, target) for quad in quads))
            if operation.verb == "move":
                self.remove(source, drop=True)

    def _empty(self, operation: Manage) -> None:
        if operation.target in {"NAMED", "ALL"}:
            every = set(self._transaction.graphs())
            self.skipped |= every & self._protected
            for graph in every - self._protected:
                self.remove(graph, drop=operation.verb == "drop")
        if operation.target in {"DEFAULT", "ALL"}:
            self.remove(_DEFAULT, drop=False)
        if operation.target not in {"NAMED", "DEFAULT", "ALL"}:
            target = self._graph(operation, operation.target)
            if self._check_exists(operation, target, wanted=True):
                self.remove(target, drop=operation.verb == "drop")

    def remove(self, graph: NamedNode | DefaultGraph, *, drop: bool) -> None:
        """Clear a graph, and with `drop` remove it; KG561."""
        self.allow(graph)
        triples = self._transaction.count(graph)
        if isinstance(graph, NamedNode) and drop:
            self._transaction.drop_graph(graph)
        elif triples:
            self._transaction.clear_graph(graph)
        if triples or drop:
            self.touched.add(_name(graph))
        self.removed.update({_name(graph): triples})

    def _graph(self, operation: Manage, name: str) -> NamedNode | DefaultGraph:
        return _DEFAULT if name == "DEFAULT" else iris(operation.prologue, [name])[0]

    def _check_exists(self, operation: Manage, graph: NamedNode | DefaultGraph, *, wanted: bool) -> bool:
        """Return whether the existence of a graph is as `wanted`.

        If not, raise KG560 unless the operation is SILENT.
        """
        if isinstance(graph, DefaultGraph) or self._transaction.has_graph(graph) == wanted:
            return True
        if operation.silent:
            return False
        message = f"the graph {graph} does not exist" if wanted else f"the graph {graph} already exists"
        raise QueryError("KG560", message, hint=f"{operation.verb.upper()} SILENT ignores the error.")


def _name(graph: Any) -> str:
    return graph.value if isinstance(graph, NamedNode) else ""


def _select(operation: Modify, text: str, variables: Sequence[str], *, distinct: bool) -> str:
    """Return the query for the values of some variables in the solutions of a WHERE."""
    chosen = " ".join(f"?{name}" for name in variables) or f"(1 AS ?{_unused(text)})"
    return f"{operation.prologue} SELECT {'DISTINCT ' * distinct}{chosen} WHERE {{{operation.where.of(text)}\n}}"


def _unused(text: str) -> str:
    number = 0
    while f"one{number}" in text:
        number += 1
    return f"one{number}"
