"""Names that a user types, checked against the store: an unknown one gets the nearest that are known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import UnknownNameError, UsageError, choices
from kg.graph.ntriples import literal
from kg.lazily import lazily
from kg.similar import unknown
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.graph.reading.nodes import NodeRecord
    from kg.store.interface import Queryable

with lazily():
    from kg.graph.reading.nodes import loaded_as, node_names, node_records
    from kg.graph.reading.overview import packages
    from kg.graph.reading.systems import started_names, started_types, system_names
    from kg.pipeline.launch_names import matching, unknown_launch


def require_package(graph: Queryable, name: str) -> None:
    """Raise KG001 unless the store has a package of this name (`name` or `repository:name`)."""
    repository, _, own = name.rpartition(":")
    owner = f"?r rnkg:contains ?p ; rnkg:name {literal(repository)} ." if repository else ""
    if graph.query(f"ASK {{ ?p a rnkg:Package ; rnkg:name {literal(own)} . {owner} }}", prefixes=dict(PREFIXES)):
        return
    existing = packages(graph)
    names = [one.name for one in existing] + [f"{one.repository}:{one.name}" for one in existing]
    raise unknown("package", name, names, otherwise="`kg packages` lists the packages.")


def one_node(graph: Queryable, name: str) -> list[NodeRecord]:
    """Return the node called `name`, `package/name` or `repository:package/name`; of a plugin its class will do.

    A package may declare a node twice (for two robots, say); these are one node here, and all are returned.

    KG001 with suggestions if there is none, KG003 with the full names if there are several.
    """
    front, _, last = name.rpartition("/")
    records = [*node_records(graph, node=name)]
    if front and not records:
        records = node_records(graph, node=last, package=front)
    if not records:
        package = front or None
        records = [
            one for loaded in loaded_as(graph, last) for one in node_records(graph, node=loaded, package=package)
        ]
    if len({one.full_name for one in records}) == 1:
        return records
    if not records:
        names = node_names(graph)
        if front:
            names = [f"{one.package}/{one.node.name}" for one in node_records(graph)]
        inside = [f"`kg node {one.package}/{one.node.name}`" for one in node_records(graph, package=name)]
        if inside:
            raise UnknownNameError("KG001", f"`{name}` is a package, not a node", hint=choices(inside))
        raise unknown("node", name, names, otherwise="`kg nodes` lists the nodes.")
    packages = [one.package for one in records]
    ways = [f"{one.package}/{one.node.name}" if packages.count(one.package) == 1 else one.full_name for one in records]
    lines = choices(
        [f"`kg node {way}`  ({one.node.kind}, {one.node.location})" for way, one in zip(ways, records, strict=True)]
    )
    raise UsageError("KG003", f"{len(records)} nodes are called `{name}`; choose one", hint=lines)


def starting_system(graph: Queryable, name: str, launch: str | None) -> str:
    """Return the one launch file that starts the instance `name` (an absolute name), or `launch`, which must start it.

    KG001 with suggestions when none does, KG003 with the launch files when there are several.
    """
    matches = started_names(graph, name).get(name, [])
    if launch is not None:
        starting = matching(system_names(graph, named=matches), launch)
        matches = [one for one in matches if one in {each.name for each in starting}]
    if not matches:
        started = started_names(graph)
        if launch is not None:
            names = system_names(graph)
            launches = {one.name for one in matching(names, launch)}
            if not launches:
                raise unknown_launch(names, launch)
            started = {key: systems for key, systems in started.items() if not launches.isdisjoint(systems)}
        raise unknown("instance", name, started, otherwise="`kg instances` lists the instances.")
    if len(matches) > 1:
        ways = choices([f"`kg node {name} --launch {one}`" for one in matches])
        code = choices([f"`kg node {one}` shows its code" for one in started_types(graph, name)])
        hint = "\n".join(filter(None, (ways, code)))
        raise UsageError("KG003", f"{len(matches)} launch files start `{name}`; choose one", hint=hint)
    return matches[0]
