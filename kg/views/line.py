"""What one line of code or of a launch file does: the interfaces that it creates, and the nodes that it starts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Interface, Location, NodeReference
from kg.graph.iris import Iris
from kg.graph.ntriples import literal
from kg.graph.reading.channels import defining_places
from kg.graph.reading.nodes import code_facts
from kg.graph.reading.queries import among, column, texts
from kg.holes import is_known
from kg.views.channel import channel
from kg.views.evidence import Places, places
from kg.views.wording import how, quality

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 3
"""Number of names of one interface that are looked up; a wrapper can have many."""
_ENDS: Final = "?subject rnkg:path %s ; rnkg:line %d ; rnkg:implicit false ."
_NAMES: Final = """
SELECT DISTINCT ?name WHERE {
  %s ?end rnkg:declaredBy|rnkg:overrides ?code ; rnkg:connectsTo/rdfs:label ?name .
  [] a rnkg:NodeInstance ; ros:hasComponent ?end
}"""
_STARTS: Final = """
SELECT DISTINCT ?name ?program ?package ?source ?path ?line ?configuration ?written WHERE {
  ?instance a rnkg:NodeInstance ; rnkg:path %s ; rnkg:line %d ; rnkg:name ?name ; rnkg:instanceOf ?type .
  ?configuration rnkg:hasInstance ?instance .
  OPTIONAL { ?instance rnkg:inRepository ?written }
  ?type rnkg:name ?program ; rnkg:path ?path ; rnkg:line ?line .
  ?owner rnkg:contains ?type ; rnkg:name ?package .
  ?repository rnkg:contains ?owner ; a rnkg:Repository ; rnkg:name ?own .
  OPTIONAL { ?type rnkg:inRepository ?other }
  BIND(COALESCE(?other, ?own) AS ?source)
} ORDER BY ?name ?program"""


def line(snapshot: EmbeddedSnapshot, settings: Settings, *, file: Path, number: int) -> dict[str, Any]:
    """Return what the line `number` (from one) of a `file` (absolute) does, as far as the store knows.

    The keys:

    * `ends`: an object for each interface and name: `title`, `name` (None if unknown), `type`, `node` (`package/node`),
      `quality`, `definitions` (evidence of the files that define the type), `own` and `others` (endpoints of the view
      `kg.views.channel`: its own, and those on the other side);
    * `starts`: an object for each started node: `name`, `node`, `evidence` (of its code).
    """
    where = places(snapshot)
    place = _inside(where, file)
    if place is None:
        return {"ends": [], "starts": []}
    source, path = place
    written = literal(path)
    ends = []
    for iri, (owner, fact) in code_facts(snapshot, _ENDS % (written, number)).items():
        if isinstance(fact, Interface) and (fact.location.repository or owner.repository) == source:
            ends += _ends(snapshot, settings, where, iri, owner, fact)
    iris = Iris(settings.base)
    starts = {
        (name, f"{package}/{program}"): where.evidence(owner, Location(inner, int(at)))
        for name, program, package, owner, inner, at, system, other in texts(snapshot, _STARTS % (written, number))
        if (other or _source_of(iris, system)) == source
    }
    return {
        "ends": sorted(ends, key=str),
        "starts": [{"name": name, "node": node, "evidence": place} for (name, node), place in starts.items()],
    }


def _source_of(iris: Iris, configuration: str) -> str | None:
    thing = iris.parse(configuration)
    return thing.parts[0] if thing else None


def _inside(where: Places, file: Path) -> tuple[str, str] | None:
    """Return the source that has a file, the innermost of several, and the path in it."""
    roots = [(Path(one.root).resolve(), name) for name, one in where.sources.items() if one.root]
    inside = [(root, name) for root, name in roots if file.is_relative_to(root)]
    if not inside:
        return None
    root, name = max(inside, key=lambda pair: len(pair[0].parts))
    return name, file.relative_to(root).as_posix()


def _ends(  # noqa: PLR0913, PLR0917 - one interface, and where it is looked up
    snapshot: EmbeddedSnapshot, settings: Settings, where: Places, iri: str, owner: NodeReference, fact: Interface
) -> list[dict[str, Any]]:
    """Return an interface under each of its names: those under launch files, else that of the node alone."""
    names = sorted(column(snapshot, _NAMES % among("code", [iri])))[:_MOST]
    if not names and fact.resolved is not None and is_known(fact.resolved):
        names = [fact.resolved]
    common = {
        "title": fact.role.heading,
        "type": fact.type,
        "node": f"{owner.package}/{owner.node}",
        "definitions": [where.evidence(*one) for one in defining_places(snapshot, [fact.type] if fact.type else [])],
    }
    place = where.evidence(owner.repository, fact.location)
    rows = []
    for name in names:
        found = channel(snapshot, settings, name=name, kind=fact.role.channel)["endpoints"]
        own = [one for one in found if one["role"] == str(fact.role) and one["evidence"] == place]
        others = [one for one in found if one["role"] != str(fact.role) and not one.get("possible")]
        rows.append({**common, "name": name, "quality": quality(fact.switches, fact.qos), "own": own, "others": others})
    unnamed = {**common, "name": fact.name, "quality": how(fact), "own": [], "others": []}
    return rows or [unnamed]
