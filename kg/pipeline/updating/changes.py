"""Requests for changes, and their results; both travel between processes as MessagePack."""

from __future__ import annotations

from typing import Literal, TypeAlias

import msgspec


class Update(msgspec.Struct, frozen=True, tag="update", kw_only=True):
    """A SPARQL update: operations of which all happen or none.

    `using` and `using_named` replace the data set of each WHERE (SPARQL 1.1 Protocol, section 2.2.3). With `snapshot`
    it happens only to the data of that identity. Relative IRIs are relative to `base`. `path` is the place of the text
    in errors.
    """

    text: str
    using: tuple[str, ...] = ()
    using_named: tuple[str, ...] = ()
    base: str | None = None
    snapshot: str | None = None
    path: str = "update"


class GraphChange(msgspec.Struct, frozen=True, tag="graph", kw_only=True):
    """A write of one graph (SPARQL 1.1 Graph Store HTTP Protocol); `graph` None is the default graph.

    `put` gives it the content of `parts`, `post` adds that, `delete` removes it. Each part is RDF with its media type
    or the name of its format (`ttl`, `nt`, `rdf`, ...); relative IRIs are relative to `base`, else to the graph. With
    `snapshot` it happens only to the data of that identity.
    """

    action: Literal["put", "post", "delete"]
    graph: str | None = None
    parts: tuple[tuple[bytes, str], ...] = ()
    base: str | None = None
    snapshot: str | None = None


Change: TypeAlias = Update | GraphChange


class Updated(msgspec.Struct, frozen=True, kw_only=True):
    """Result of a change.

    `snapshot` is the identity of the data that holds now, a new one only where `changed`. `graphs` counts the triples
    removed from and added to each graph that was written ("" is the default graph). `inferred` counts what rules infer
    now, `inferred_added` and `inferred_removed` what of it is new and gone; `mode` is how rules ran: `full`,
    `incremental`, or `none` where they did not. `created` is whether the graph of a `GraphChange` is new. `warnings`
    are for people. `seconds` is wall time.
    """

    snapshot: str
    changed: bool
    graphs: dict[str, tuple[int, int]] = {}
    inferred: int | None = None
    inferred_added: int = 0
    inferred_removed: int = 0
    mode: str = "none"
    created: bool = False
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def removed(self) -> int:
        """How many triples were taken out, those of rules not counted."""
        return sum(removed for removed, _ in self.graphs.values())

    @property
    def added(self) -> int:
        """How many triples were put in, those of rules not counted."""
        return sum(added for _, added in self.graphs.values())
