"""Helpers for tests of updates: a store without the rules of `kg`, and its content."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, RdfFormat

from kg.pipeline.updating.applying import Applier
from kg.pipeline.updating.changes import Update
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    from kg.pipeline.updating.changes import Updated
    from kg.settings import Settings

__all__ = ["INFERRED", "PREFIX", "Bench", "bench"]

PREFIX: Final = "PREFIX : <urn:test:> "
INFERRED: Final = "<https://w3id.org/rnkg/graph/inferred>"

_RULES: Final = {
    "reaches": "CONSTRUCT { ?a :reaches ?b } WHERE { ?a :next ?b }",
    "further": "CONSTRUCT { ?a :reaches ?c } WHERE { ?a :reaches ?b . ?b :next ?c }",
    "ends": "CONSTRUCT { ?a a :End } WHERE { ?b :next ?a FILTER NOT EXISTS { ?a :next ?c } }",
    "many": "CONSTRUCT { ?a :degree ?n } WHERE { SELECT ?a (COUNT(?b) AS ?n) { ?a :next ?b } GROUP BY ?a }",
}
"""Recursion, negation and counting."""


@dataclass(slots=True)
class Bench:
    """A store, its settings, and an applier in this process."""

    store: EmbeddedStore
    settings: Settings
    applier: Applier

    def update(self, text: str, *, dry_run: bool = False, snapshot: str | None = None) -> Updated:
        """Run an update, with a declaration of the empty prefix."""
        return self.applier.apply(Update(text=PREFIX + text, snapshot=snapshot), dry_run=dry_run)

    def lines(self, graph: str | None = None) -> list[str]:
        """Return the lines of all graphs, or of one graph, sorted."""
        named = NamedNode(graph.strip("<>")) if graph else None
        rdf_format = RdfFormat.N_TRIPLES if named else RdfFormat.N_QUADS
        with self.store.read() as snapshot:
            return sorted(snapshot.dump(rdf_format, graph=named).decode().splitlines())


def bench(folder: Path) -> Bench:
    """Return an empty store with four rules, and none of those of `kg`."""
    rules = folder / "rules"
    (rules / "mine").mkdir(parents=True)
    for name, text in _RULES.items():
        (rules / "mine" / f"{name}.rq").write_text(PREFIX + text)
    given = {"store": str(folder), "rules": str(rules), "rule_families": "mine"}
    settings = load(given, environment={}, folder=folder)
    store = EmbeddedStore.create(folder / ".kg")
    return Bench(store, settings, Applier(store, settings))
