"""Requests for changes, and their results; both are sent between processes as MessagePack."""

from __future__ import annotations

from typing import Literal, TypeAlias

import msgspec


class Update(msgspec.Struct, frozen=True, tag="update", kw_only=True):
    """A SPARQL update: its operations are atomic.

    `using` and `using_named` replace the dataset of each WHERE (SPARQL 1.1 Protocol, section 2.2.3). `snapshot`
    requires data of that identity. Relative IRIs are resolved against `base`. `path` is the path of the text in errors.
    """

    text: str
    using: tuple[str, ...] = ()
    using_named: tuple[str, ...] = ()
    base: str | None = None
    snapshot: str | None = None
    path: str = "update"


class GraphChange(msgspec.Struct, frozen=True, tag="graph", kw_only=True):
    """A write of one graph (SPARQL 1.1 Graph Store HTTP Protocol); `graph` None is the default graph.

    `put` replaces its content by `parts`, `post` adds them, `delete` removes it. Each part is RDF with its media type
    or the name of its format (`ttl`, `nt`, `rdf`, ...); relative IRIs are resolved against `base`, else against the
    graph. `snapshot` requires data of that identity.
    """

    action: Literal["put", "post", "delete"]
    graph: str | None = None
    parts: tuple[tuple[bytes, str], ...] = ()
    base: str | None = None
    snapshot: str | None = None


Change: TypeAlias = Update | GraphChange


class Updated(msgspec.Struct, frozen=True, kw_only=True):
    """Result of a change.

    `snapshot` is the identity of the current data, a new one only if `changed`. `graphs` contains the numbers of
    triples removed from and added to each graph that was written ("" is the default graph). `inferred` is the number of
    inferred triples, `inferred_added` and `inferred_removed` are the differences; `mode` is how rules ran: `full`,
    `incremental`, or `none`. `created` is whether the graph of a `GraphChange` is new. `warnings` are sentences for the
    user. `seconds` is wall time.
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
        """Number of triples removed, without inferred ones."""
        return sum(removed for removed, _ in self.graphs.values())

    @property
    def added(self) -> int:
        """Number of triples added, without inferred ones."""
        return sum(added for _, added in self.graphs.values())
