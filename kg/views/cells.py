"""Cells of a table of results: inferred facts, source lines, kinds of IRIs: the views `cells` and `place`."""

from __future__ import annotations

import json
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import Variable

from kg.errors import UsageError
from kg.facts import Location
from kg.graph.iris import Iris
from kg.query.rows import rows
from kg.syntax.names import PREFIXES
from kg.views.arguments import whole
from kg.views.evidence import places as known_places
from kg.views.terms import called, given_term, listing, named_node

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_HELD: Final = "ASK { GRAPH <%s> { ?s ?p ?o } }"
_NODE: Final = "ASK { ?s a rnkg:NodeType }"
_TYPES: Final = "SELECT DISTINCT ?thing ?type { VALUES ?thing { %s } GRAPH ?g { ?thing a ?type } } ORDER BY ?type"
_TRIPLE: Final = 3


def cells(  # noqa: PLR0913 - each list is of another kind
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    triples: str | Sequence[Sequence[str]] = (),
    places: str | Sequence[Sequence[str]] = (),
    iris: str | Sequence[str] = (),
    things: str | Sequence[str] = (),
) -> dict[str, Any]:
    """Return details of some cells, each list as long as the one given.

    `inferred` has for each of the `triples` (subject, predicate, object, as N-Triples writes terms) whether rules
    derived it. `places` has for each pair of a path and a line the evidence (see `kg.views.evidence`), or null where no
    source, or more than one, has such a file. `nodes` tells for each of the `iris` whether it is a node with a page of
    its own. `things` has for each of those IRIs its `label`, null where nothing that has one is known of it, and its
    `types` in alphabetical order. Lists may also be given as JSON.

    Raises UsageError: KG003 for a malformed list or term.
    """
    graph = _HELD % Iris(settings.base).graph("inferred")
    where = known_places(snapshot)
    evidence = []
    for path, line in _lists(places, 2):
        source = where.find(path)
        at = Location(path, whole(line, 0))
        evidence.append(None if source is None else where.evidence(source, at))
    return {
        "inferred": [_holds(snapshot, graph, "spo", triple) for triple in _lists(triples, _TRIPLE)],
        "places": evidence,
        "nodes": [_holds(snapshot, _NODE, "s", [f"<{iri}>"]) for (iri,) in _lists([[iri] for iri in _list(iris)], 1)],
        "things": _things(snapshot, [named_node(iri).value for (iri,) in _lists([[iri] for iri in _list(things)], 1)]),
    }


def _things(snapshot: EmbeddedSnapshot, iris: Sequence[str]) -> list[dict[str, Any]]:
    labels = called(snapshot, iris)
    types: defaultdict[str, list[str]] = defaultdict(list)
    for thing, kind in rows(snapshot, _TYPES % listing(iris)):
        types[thing].append(kind)
    return [{"label": labels[iri] if labels[iri] != iri else None, "types": types[iri]} for iri in iris]


def _holds(snapshot: EmbeddedSnapshot, ask: str, names: str, terms: Sequence[str]) -> bool:
    if any(term.startswith("_:") for term in terms):
        return False
    given = {Variable(name): given_term(term) for name, term in zip(names, terms, strict=True)}
    return bool(snapshot.query(ask, prefixes=PREFIXES, substitutions=given))


def _lists(given: str | Sequence[Sequence[str]], length: int) -> list[list[str]]:
    items = _list(given)
    if not all(isinstance(one, list | tuple) and len(one) == length for one in items):
        raise UsageError("KG003", f"each entry needs {length} texts")
    return [[str(part) for part in one] for one in items]


def _list(given: Any) -> list[Any]:
    try:
        items = json.loads(given or "[]") if isinstance(given, str) else list(given)
    except json.JSONDecodeError as error:
        raise UsageError("KG003", f"the list is not valid JSON: {error}") from error
    if not isinstance(items, list):
        raise UsageError("KG003", "expected a list")
    return items


def place(snapshot: EmbeddedSnapshot, settings: Settings, *, path: str, line: str = "") -> dict[str, Any] | None:  # noqa: ARG001 - every view is given settings
    """Return the evidence of a path of a source and a line of it, where only one source has that file; else None."""
    where = known_places(snapshot)
    source = where.find(path)
    return None if source is None else where.evidence(source, Location(path, whole(line, 0)))
