"""Make one change in one transaction, including the resulting inferences."""

from __future__ import annotations

import time
from contextlib import suppress
from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING

from pyoxigraph import DefaultGraph, NamedNode, Quad, RdfFormat, parse

from kg.errors import KgError, Place, QueryError
from kg.pipeline.inferring import Inference, Inferred
from kg.pipeline.updating.changes import Change, GraphChange, Updated
from kg.pipeline.updating.checking import parsed
from kg.pipeline.updating.executing import Executor
from kg.pipeline.updating.ownership import protected_graphs, warnings
from kg.store.failure import is_of_store
from kg.store.files import BYTE_ORDER_MARK, parsing

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction


def apply(
    store: EmbeddedStore, settings: Settings, change: Change, *, rules: bool = True, dry_run: bool = False
) -> Updated:
    """Make a change, with its inferences unless `rules` is false; with `dry_run` nothing is written.

    Raises:
        KgError: as `Writer.update`; the store is then unchanged.
    """
    applier = Applier(store, settings)
    updated = applier.apply(change, rules=rules, dry_run=dry_run)
    applier.save()
    return updated


class Applier:
    """Makes changes of one store, one after the other, and retains the memory of the rules between them."""

    def __init__(self, store: EmbeddedStore, settings: Settings) -> None:
        self._store = store
        self._settings = settings
        self._inference = Inference(store, settings)
        self._unsaved = 0

    def warm(self) -> None:
        """Load the rules and the memory of their last run, to speed up the first change."""
        # The first change reports the error.
        with suppress(KgError):
            self._inference.prepare()

    def apply(self, change: Change, *, rules: bool = True, dry_run: bool = False) -> Updated:
        """Make a change; see `apply`. The memory of the rules stays in this process until `save`."""
        try:
            return self._apply(change, rules=rules, dry_run=dry_run)
        except BaseException:
            # The memory of the rules may be inconsistent.
            self._inference = Inference(self._store, self._settings)
            raise

    def save(self) -> None:
        """Save the memory of the rules for other processes, unless nothing changed since."""
        if self._unsaved:
            self._inference.save()
            self._unsaved = 0

    @property
    def unsaved(self) -> int:
        """Number of changes since `save`."""
        return self._unsaved

    def _apply(self, change: Change, *, rules: bool, dry_run: bool) -> Updated:
        began = time.perf_counter()
        inferred: Inferred | None = None
        with self._store.write("kg update") as transaction:
            current = str(transaction.base or 0)
            if change.snapshot is not None and change.snapshot != current:
                message = f"the update is for snapshot {change.snapshot}, and the data is now {current}"
                raise QueryError("KG512", message, hint="Look at the data as it is now, and ask again.")
            executor = Executor(transaction, protected_graphs(self._settings))
            created = _make(executor, transaction, change)
            changed = bool(executor.touched)
            if changed and rules:
                inferred = self._inference.run(transaction)
            if dry_run or not changed:
                transaction.roll_back()
            generation = transaction.commit()
        if inferred is not None and generation is not None:
            self._inference.remember(generation, save=False)
            self._unsaved += 1
        return Updated(
            snapshot=str(generation or self._store.layout.current() or 0),
            changed=changed,
            graphs=executor.graphs(),
            inferred=inferred.triples if inferred else None,
            inferred_added=inferred.added if inferred else 0,
            inferred_removed=inferred.removed if inferred else 0,
            mode=inferred.mode if inferred else "none",
            created=created,
            warnings=tuple(warnings(executor, self._settings, inferred)),
            seconds=time.perf_counter() - began,
        )


def _make(executor: Executor, transaction: EmbeddedTransaction, change: Change) -> bool:
    """Execute a change; return whether it created the graph that it writes."""
    if isinstance(change, GraphChange):
        return _write_graph(executor, transaction, change)
    text, operations = parsed(change.text, change.path, change.base)
    for operation in operations:
        try:
            executor.run(operation, text, change.using, change.using_named)
        except (RuntimeError, ValueError) as error:
            if is_of_store(error):
                raise
            raise QueryError("KG560", str(error), place=Place(change.path)) from error
    return False


def _write_graph(executor: Executor, transaction: EmbeddedTransaction, change: GraphChange) -> bool:
    try:
        graph = DefaultGraph() if change.graph is None else NamedNode(change.graph)
    except ValueError as error:
        raise QueryError("KG560", f"`{change.graph}` is not the IRI of a graph: {error}") from error
    executor.allow(graph)
    exists = isinstance(graph, DefaultGraph) or transaction.has_graph(graph)
    if change.action == "delete":
        if not exists:
            raise QueryError("KG564", f"the graph {graph} does not exist")
        executor.remove(graph, drop=True)
        return False
    base = change.base or change.graph
    content = list(_content(change.parts, graph, base))
    before = list(transaction.quads(graph)) if change.action == "put" and exists else []
    executor.patch(before, content)
    if not exists:
        executor.create(graph)
    return not exists


def _content(parts: Iterable[tuple[bytes, str]], graph: NamedNode | DefaultGraph, base: str | None) -> Iterator[Quad]:
    """Yield the triples of parts, each with its media type or the name of its format, as quads of a graph.

    Relative IRIs are resolved against `base`. Blank nodes are new ones; parts do not share them.

    Raises:
        QueryError: KG562 with the place of a syntax error, KG563 for a format that is not for a single graph.
    """
    for number, (content, kind) in enumerate(parts, 1):
        rdf_format = _format(kind)
        name = "content" if number == 1 else f"content of part {number}"
        plain = content.removeprefix(BYTE_ORDER_MARK)
        try:
            with parsing(rdf_format, partial(BytesIO, plain)):
                quads = parse(plain, rdf_format, base_iri=base, without_named_graphs=True, rename_blank_nodes=True)
                for quad in quads:
                    yield Quad(quad.subject, quad.predicate, quad.object, graph)
        except SyntaxError as error:
            place = Place(name, error.lineno, error.offset)
            raise QueryError("KG562", error.msg, place=place) from error


def _format(name: str) -> RdfFormat:
    """Return the format with a media type, or a file name suffix."""
    plain = name.partition(";")[0].strip().lower()
    form = RdfFormat.from_media_type(plain) if "/" in plain else RdfFormat.from_extension(plain)
    if form is None or (form.supports_datasets and form != RdfFormat.JSON_LD):
        hint = "The formats are text/turtle, application/n-triples, application/rdf+xml and application/ld+json."
        raise QueryError("KG563", f"`{name}` is not a format for one graph", hint=hint)
    return form
