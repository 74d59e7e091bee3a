"""The graph `shared`: things of no single source, such as topics, services, actions, types, names and people.

Many sources describe the same topic with the same triples. If each source's graph had them, a query over all graphs
would return a result for every source. So they are stored once, in the graph `shared`. `split` separates them by their
subjects.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.graph.ntriples import apart

if TYPE_CHECKING:
    from kg.graph.iris import Iris

SHARED: Final = "shared"
"""The name of the graph."""

_KINDS: Final = (
    "topic",
    "service",
    "action",
    "message",
    "service-type",
    "action-type",
    "package-name",
    "person",
    "phrase",
    "qos",
)


def split(content: bytes, iris: Iris) -> tuple[list[bytes], list[bytes]]:
    """Return the lines of N-Triples that belong to a source, and those about what sources share, in their order."""
    return apart(content, tuple(f"<{iris.base}{kind}/".encode() for kind in _KINDS))
