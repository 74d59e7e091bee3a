"""What rules inferred of a node type: the functions it has, and the hardware it works with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.queries import select

if TYPE_CHECKING:
    from kg.graph.reading import Queryable

__all__ = ["Classes", "classes"]

_QUERY: Final = """
SELECT DISTINCT ?property (STR(?label) AS ?text) WHERE {{
  VALUES ?property {{ rnkg:hasFunction rnkg:usesHardware rnkg:usesDevice }}
  <{iri}> ?property ?class . ?class rdfs:label ?label .
}} ORDER BY ?text"""


@dataclass(frozen=True, slots=True)
class Classes:
    """Labels of functions, of kinds of hardware and of devices, each sorted."""

    functions: tuple[str, ...] = ()
    hardware: tuple[str, ...] = ()
    devices: tuple[str, ...] = ()


def classes(graph: Queryable, iri: str) -> Classes:
    """Return what is inferred of the node type with this IRI; nothing where no rules ran."""
    found = {name: list[str]() for name in ("hasFunction", "usesHardware", "usesDevice")}
    for row in select(graph, _QUERY.format(iri=iri)):
        found[row["property"].value.removeprefix(v.RNKG)].append(row["text"].value)
    return Classes(*map(tuple, found.values()))
