"""References in the store, so that the stored queries run over the endpoint too: the graph `reference`."""

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
    """Make these the references of the store in force, in place of those that were kept before.

    Raises:
        StoreError: KG301 when there is no store, KG302 while another process writes, KG304 when the disk is full.
    """
    graph = NamedNode(Iris(settings.base).graph(_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            transaction.replace_graphs({graph: [triples]})
            inference.run(transaction)
            inference.remember(transaction.commit())


def forget(settings: Settings) -> bool:
    """Take the references out of the store in force; tell whether there were any.

    Raises:
        StoreError: KG301 when there is no store, KG302 while another process writes.
    """
    graph = NamedNode(Iris(settings.base).graph(_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            known = graph in transaction.graphs()
            if known:
                transaction.drop_graph(graph)
                inference.run(transaction)
                inference.remember(transaction.commit())
    return known
