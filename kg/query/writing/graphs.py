"""Serialization of the triples of a query as they arrive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.store.serialization import FORMATS, write_serialized
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pyoxigraph import Triple

GRAPHS: Final = FORMATS
"""Formats of graphs."""

_WITH_PREFIXES: Final = frozenset({"turtle", "trig", "rdfxml"})


def write_triples(name: str, triples: Iterable[Triple], output: Callable[[bytes], object]) -> None:
    """Write `triples` to `output` in the format `name`; raises as `kg.store.serialization.write_serialized`."""
    write_serialized(triples, GRAPHS[name], PREFIXES if name in _WITH_PREFIXES else {}, output)
