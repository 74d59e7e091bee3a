"""Remove sources from a store permanently: their graphs, and their entries for builds without names."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.graph.iris import Iris
from kg.pipeline.inferring import Inference, Inferred
from kg.pipeline.sharing import keep_shared
from kg.pipeline.state import State, load, save
from kg.pipeline.systems import update_systems
from kg.pipeline.writing import shared_of
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore


def forget(
    store: EmbeddedStore, settings: Settings, names: Sequence[str], command: str = "kg forget", *, rules: bool = True
) -> Inferred | None:
    """Remove sources from the store and from builds without names; unknown names are ignored.

    Inferences from them are removed too; unusable rules are left out. Without `rules` these stay until the next build,
    and None is returned.

    Raises:
        RuleError: KG208 for a rule pack that cannot be loaded, KG231 for an unreadable folder of rules.
        StoreError: KG301 without data, KG302 while another process writes, KG304 if the disk is full.
    """
    iris, inference = Iris(settings.base), Inference(store, settings)
    with store.write(command) as transaction:
        state = load(store.layout.cache)
        for name in names:
            transaction.drop_graph(NamedNode(iris.source_graph(name)))
        left = _without(state, frozenset(names))
        packages = [package for source in left.sources.values() for package in source.packages.values()]
        contents = (shared_of(store.layout.cache, package) for package in packages)
        keep_shared(transaction, iris, contents, left.sources)
        present = {(name, path): one for name, source in left.sources.items() for path, one in source.packages.items()}
        systems, _ = update_systems(transaction, store.layout.cache, iris, present, state.systems, state.version)
        inferred = inference.run(transaction) if rules else None
        generation = transaction.commit()
        inference.remember(generation)
        current = generation if generation and state.generation + 1 == generation else state.generation
        with translated(str(store.layout.cache)):
            store.layout.cache.mkdir(parents=True, exist_ok=True)
            save(store.layout.cache, replace(left, generation=current, rules=inference.digest, systems=systems))
    return inferred


def _without(state: State, names: frozenset[str]) -> State:
    """Return the state without sources; a root is removed with its last source."""
    remaining = {name: source for name, source in state.sources.items() if name not in names}
    gone = [source.repository.root for name, source in state.sources.items() if name in names]
    left = [source.repository.root for source in remaining.values()]

    def stays(root: str) -> bool:
        return any(_inside(folder, root) for folder in left) or not any(_inside(folder, root) for folder in gone)

    return replace(state, sources=remaining, roots=tuple(root for root in state.roots if stays(root)))


def _inside(folder: str, root: str) -> bool:
    return folder == root or folder.startswith(f"{root}/") or root.startswith(f"{folder}/")
