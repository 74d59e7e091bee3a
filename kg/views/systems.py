"""Launch configurations: the view `systems`, and the one that a name means."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from kg.graph.iris import Iris
from kg.graph.reading.systems import SystemName, included, system_names
from kg.graph.usual_ends import channels_by_system
from kg.pipeline.launch_names import matching, several_launches, unknown_launch
from kg.query.rows import rows
from kg.views import answers
from kg.views.arguments import whole
from kg.views.remembered import once

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 1000
_STARTED: Final = """SELECT ?system (COUNT(?instance) AS ?count) {
  GRAPH ?g { ?system rnkg:hasInstance ?instance }
} GROUP BY ?system"""
_FINDINGS: Final = """SELECT ?system ?severity (COUNT(?finding) AS ?count) {
  GRAPH ?g { ?finding a rnkg:Finding ; rnkg:inConfiguration ?system ; rnkg:severity ?severity }
} GROUP BY ?system ?severity"""


def systems(
    snapshot: EmbeddedSnapshot, settings: Settings, *, text: str = "", offset: str = "0", limit: str = "200"
) -> dict[str, Any]:
    """Return the launch configurations of the store, those that others include last.

    `text` chooses those whose name or source has all its words. The answer is `{"total", "offset", "systems"}`. Each of
    these, at most `limit` (1,000 at most) from `offset` on, has `name`, `iri`, `repository`, `path`, `package`, `ros`,
    `included` (others include it), how many `nodes`, `topics`, `services` and `actions` there are, and `findings`: how
    many of each severity `kg lint --all` has, before anything is allowed.
    """
    words = text.lower().split()
    matching_rows = [
        one for one in all_systems(snapshot, settings.base)
        if all(word in f"{one['name']} {one['repository']}".lower() for word in words)
    ]  # fmt: skip
    start, most = whole(offset, 0), min(whole(limit, 200), _MOST)
    return {"total": len(matching_rows), "offset": start, "systems": matching_rows[start : start + most]}


@once
def configuration_names(snapshot: EmbeddedSnapshot) -> tuple[SystemName, ...]:
    """Return the names of all configurations."""
    return tuple(system_names(snapshot))


@once
def included_names(snapshot: EmbeddedSnapshot) -> frozenset[str]:
    """Return the names of the configurations that others include."""
    return included(snapshot)


def chosen_systems(snapshot: EmbeddedSnapshot, name: str, base: str) -> frozenset[str] | None:
    """Return the IRIs of all configurations that a name may mean; None (all) for an empty one.

    Raises UnknownNameError: KG422 with suggestions if there is none.
    """
    if not name.strip():
        return None
    names = configuration_names(snapshot)
    matches = matching(names, name)
    if not matches:
        raise unknown_launch(names, name)
    return frozenset(Iris(base).configuration(one.repository, one.path) for one in matches)


def system_named(snapshot: EmbeddedSnapshot, name: str, repository: str = "", base: str = "") -> SystemName:
    """Return the configuration that a name means: whole, the end of it by segments, or the IRI of it.

    `repository` distinguishes several of one name.

    Raises:
        UnknownNameError: KG422 with suggestions if there is none.
        UsageError: KG003 if there are several.
    """
    names = [one for one in configuration_names(snapshot) if repository in {"", one.repository}]
    thing = Iris(base).parse(name) if base and name.startswith(base) else None
    if thing is not None and thing.kind == "configuration":
        matches = [one for one in names if (one.repository, one.path) == thing.parts]
    else:
        matches = matching(names, name) if name.strip() else []
    if not matches:
        raise unknown_launch(names, name)
    if len(matches) > 1:
        raise several_launches(names, matches, name)
    return matches[0]


@once
def all_systems(snapshot: EmbeddedSnapshot, base: str) -> tuple[dict[str, Any], ...]:
    """Return all launch configurations as `systems` has them; the store keeps them, and nobody changes them."""
    return tuple(answers.rows(snapshot, "list-systems", lambda: _systems(snapshot, base)))


def _systems(snapshot: EmbeddedSnapshot, base: str) -> list[dict[str, Any]]:
    iris, inner = Iris(base), included_names(snapshot)
    nodes = Counter({system: int(number) for system, number in rows(snapshot, _STARTED)})
    channels = {system: Counter(kind for kind, _ in listed) for system, listed in channels_by_system(snapshot).items()}
    none = Counter[str]()
    severities: dict[str, dict[str, int]] = {}
    for system, severity, number in rows(snapshot, _FINDINGS):
        severities.setdefault(system, {})[severity] = int(number)
    listed = []
    for one in configuration_names(snapshot):
        iri = iris.configuration(one.repository, one.path)
        listed.append(
            {
                "name": one.name,
                "iri": iri,
                "repository": one.repository,
                "path": one.path,
                "package": one.name.partition("/")[0],
                "ros": one.ros,
                "included": one.name in inner,
                "nodes": nodes[iri],
                **{f"{kind}s": channels.get(iri, none)[kind] for kind in ("topic", "service", "action")},
                "findings": severities.get(iri, {}),
            }
        )
    return sorted(listed, key=lambda one: (one["included"], one["name"], one["repository"]))
