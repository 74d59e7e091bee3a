"""References stored in the graph `reference`, so the stored queries also run over the endpoint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph.iris import Iris
from kg.pipeline.inferring import Inference
from kg.store.opening import writable

if TYPE_CHECKING:
    from kg.settings import Settings

_NAME: Final = "reference"


def keep(settings: Settings, triples: bytes) -> None:
    """Replace the references in the current store.

    Raises StoreError: KG301 no store, KG302 another process is writing, KG304 the disk is full.
    """
    graph = NamedNode(Iris(settings.base).graph(_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            transaction.replace_graphs({graph: [triples]})
            inference.run(transaction)
            inference.remember(transaction.commit())


def forget(settings: Settings) -> bool:
    """Remove the references from the current store; return whether there were any.

    Raises StoreError: KG301 no store, KG302 another process is writing.
    """
    graph = NamedNode(Iris(settings.base).graph(_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            exists = graph in transaction.graphs()
            if exists:
                transaction.drop_graph(graph)
                inference.run(transaction)
                inference.remember(transaction.commit())
    return exists
