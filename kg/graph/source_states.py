"""The state of each source in the graph `builds`: its last build, origin, and numbers of facts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

from kg.graph.builds import COUNTS, Counts
from kg.graph.fields import Properties, one
from kg.graph.reading.queries import properties_in, select

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.store.interface import Queryable

_BUILDS: Final = """
SELECT ?name ?build ?started ?commit ?dirty ?root ?version WHERE {
  ?repository a rnkg:Repository ; rnkg:name ?name .
  ?build prov:used ?repository .
  OPTIONAL { ?build prov:startedAtTime ?started }
  OPTIONAL { ?build rnkg:commit ?commit }
  OPTIONAL { ?build rnkg:dirty ?dirty }
  OPTIONAL { ?build rnkg:root ?root }
  OPTIONAL { ?build rnkg:kgVersion ?version }
}"""
"""One row for each build: most commands read all of them, for the places of what they show."""
_FORGES: Final = {
    "github.com": "https://{name}/blob/{commit}/{path}#L{line}",
    "gitlab.com": "https://{name}/-/blob/{commit}/{path}#L{line}",
    "bitbucket.org": "https://{name}/src/{commit}/{path}#lines-{line}",
}
_COUNTED: Final = "SELECT ?build ?predicate ?object WHERE { ?build prov:used ?repository ; ?predicate ?object }"
_REPOSITORIES: Final = """
SELECT ?name ?remote ?branch WHERE {
  ?repository a rnkg:Repository ; rnkg:name ?name .
  OPTIONAL { ?repository rnkg:remote ?remote }
  OPTIONAL { ?repository rnkg:branch ?branch }
}"""


@dataclass(frozen=True, slots=True)
class SourceState:
    """A source as it was read last; `read` is a moment in ISO 8601, `root` the folder on the machine that read it.

    `counts` are zeros unless `sources` was to read them.
    """

    name: str
    remote: str | None
    branch: str | None
    commit: str | None
    dirty: bool
    root: str | None
    read: str | None
    version: str | None
    counts: Counts

    def page(self, path: str, line: int | None) -> str | None:
        """Return the address of a line, or a file, at the commit that was read; None except on well-known forges."""
        pattern = _FORGES.get(self.name.partition("/")[0])
        if pattern is None or self.commit is None:
            return None
        name, commit, path = (quote(part, errors="surrogatepass") for part in (self.name, self.commit, path))
        address = pattern.format(name=name, commit=commit, path=path, line=line)
        return address if line else address.partition("#")[0]


def sources(graph: Queryable, *, counted: bool = False) -> list[SourceState]:
    """Return the sources of the store, sorted by name; only with `counted` how much was found in them."""
    builds: dict[str, Any] = {}
    for row in select(graph, _BUILDS):
        last = builds.setdefault(row["name"].value, row)
        if (_value(row["started"]) or "") > (_value(last["started"]) or ""):
            builds[row["name"].value] = row
    numbers = properties_in(graph, _COUNTED) if counted else {}
    states = [
        _state(row["name"].value, _value(row["remote"]), _value(row["branch"]), builds.get(row["name"].value), numbers)
        for row in select(graph, _REPOSITORIES)
    ]
    return sorted(states, key=lambda state: state.name)


def _state(
    name: str, remote: str | None, branch: str | None, build: Any, numbers: Mapping[str, Properties]
) -> SourceState:
    commit, dirty, root, read, version = (
        None if build is None else _value(build[key]) for key in ("commit", "dirty", "root", "started", "version")
    )
    counts = {} if build is None else numbers.get(build["build"].value, {})
    return SourceState(
        name=name,
        remote=remote,
        branch=branch,
        commit=commit,
        dirty=dirty == "true",
        root=root,
        read=read,
        version=version,
        counts=Counts(**{key: int(one(counts, term) or 0) for key, term in COUNTS.items()}),
    )


def _value(term: Any) -> str | None:
    return None if term is None else term.value
