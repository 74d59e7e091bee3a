"""What the graph `builds` says of each source: when it was read last, from where, and what was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.builds import COUNTS, Counts
from kg.graph.queries import texts

if TYPE_CHECKING:
    from kg.graph.reading import Queryable

_BUILDS: Final = """
SELECT ?name ?build ?predicate ?object WHERE {
  ?repository a rnkg:Repository ; rnkg:name ?name .
  ?build prov:used ?repository ; ?predicate ?object .
}"""
_REPOSITORIES: Final = """
SELECT ?name ?remote ?branch WHERE {
  ?repository a rnkg:Repository ; rnkg:name ?name .
  OPTIONAL { ?repository rnkg:remote ?remote }
  OPTIONAL { ?repository rnkg:branch ?branch }
}"""


@dataclass(frozen=True, slots=True)
class SourceState:
    """A source as it was read last; `read` is a moment in ISO 8601, `root` the folder on the machine that read it."""

    name: str
    remote: str | None
    branch: str | None
    commit: str | None
    dirty: bool
    root: str | None
    read: str | None
    version: str | None
    counts: Counts


def sources(graph: Queryable) -> list[SourceState]:
    """Return the sources of the store, sorted by name."""
    found, latest = [], _latest(graph)
    for name, remote, branch in texts(graph, _REPOSITORIES):
        build = latest.get(name, {})
        found.append(
            SourceState(
                name=name,
                remote=remote,
                branch=branch,
                commit=build.get(v.bare(v.COMMIT)),
                dirty=build.get(v.bare(v.DIRTY)) == "true",
                root=build.get(v.bare(v.ROOT)),
                read=build.get(v.bare(v.STARTED)),
                version=build.get(v.bare(v.KG_VERSION)),
                counts=Counts(**{key: int(build.get(v.bare(term), 0)) for key, term in COUNTS.items()}),
            )
        )
    return sorted(found, key=lambda one: one.name)


def _latest(graph: Queryable) -> dict[str, dict[str, str]]:
    """Return the properties of the last build of each source."""
    builds: dict[str, dict[str, dict[str, str]]] = {}
    for name, build, predicate, value in texts(graph, _BUILDS):
        builds.setdefault(name, {}).setdefault(build, {})[predicate] = value
    started = v.bare(v.STARTED)
    return {name: max(found.values(), key=lambda one: one.get(started, "")) for name, found in builds.items()}
