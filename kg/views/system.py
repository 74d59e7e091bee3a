"""One launch configuration, wired: the view `system`."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Location
from kg.graph.iris import Iris
from kg.graph.systems_reading import systems as read_systems
from kg.holes import is_known
from kg.render.system_graph import bundles, instance_keys, of_framework, system_graph
from kg.render.text import count
from kg.views.evidence import places
from kg.views.lint import finding_objects, system_report
from kg.views.remembered import while_last
from kg.views.system_rows import instance_rows, setting_row
from kg.views.systems import known_names, system_named

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from kg.facts import LaunchArgument, LaunchInclude, LaunchProblem, NodeInstance, System
    from kg.graph.systems_reading import SystemName
    from kg.lint.finding import Finding
    from kg.render.system_graph import Bundle, Member, SystemGraph
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot
    from kg.views.evidence import Places

_TRANSFORMS: Final = frozenset({"/tf", "/tf_static"})
_NAMED: Final = 12
"""So many channels of a bundle are named."""
_MISMATCHES: Final = frozenset({"KG403", "KG405", "KG410"})
"""Findings about types or QoS of two ends that do not fit."""


def picture(
    graph: SystemGraph, keys: Mapping[str, NodeInstance], findings: Sequence[Finding], iris: Iris
) -> dict[str, Any]:
    """Return `{"nodes", "edges", "groups"}` for a graph of all ends, and the instances of its members by key.

    A node has `id`, `label`, `kind` (node, topic, service, action, unknown), `group` (the innermost namespace that it
    lies in, None for the root), `package` (of the node type, None where none is known), `detail` (words), `iri` (of the
    node type, None without one), `findings` (places in the list of findings that are about it), `debug` (frameworks
    make it, or nearly every node has it), `transforms` (tf) and `loose` (a channel with one side only). Channels of one
    kind between the same nodes are one node, whose `names` they are. Ends of a node whose names are not known are one
    node together, of the kind unknown. An edge has `source`, `target`, `kind` and `marked` (types or QoS of this end do
    not fit another); a group `id`, `label` and `group`.

    Edges lead from publishers or clients over the channel to subscribers or servers.
    """
    about: defaultdict[str, list[int]] = defaultdict(list)
    for number, finding in enumerate(findings):
        for subject in finding.subjects:
            about[subject].append(number)
    spaces = _namespaces(graph.members)
    types = {key: one.type for key, one in keys.items()}
    nodes: list[dict[str, Any]] = []
    edges: list[dict[str, Any]] = []
    unknown: defaultdict[str, list[Bundle]] = defaultdict(list)
    for member in graph.members:
        kind = types.get(member.key)
        iri = iris.node(kind.repository, kind.package, kind.node) if kind else None
        drawn = _member(member, iri, _within(member.name, spaces), about)
        nodes.append({**drawn, "package": kind.package if kind else None})
    ordinary = _ordinary(keys)
    unfit = {
        (name, node)
        for one in findings
        if one.code in _MISMATCHES
        for name in one.subjects[:1]
        for node in one.subjects
    }
    for bundle in _parted(graph, ordinary, about):
        if bundle.channels[0].open:
            unknown[(*bundle.sources, *bundle.targets)[0]].append(bundle)
            continue
        nodes.append(_channels(bundle, spaces, ordinary, about))
        edges += _edges(bundle, unfit)
    for key, bundles_of_one in unknown.items():
        nodes.append(_unknown(key, bundles_of_one, _within(key, spaces)))
        edges.append({"source": key, "target": f"unknown {key}", "kind": "unknown", "marked": False})
    groups = [{"id": space, "label": space.rpartition("/")[2], "group": _within(space, spaces)} for space in spaces]
    return {"nodes": nodes, "edges": edges, "groups": groups}


def _namespaces(members: Iterable[Member]) -> list[str]:
    """Return the namespaces with more than one member in them, and those that they lie in."""
    inside: defaultdict[str, int] = defaultdict(int)
    for member in members:
        parts = member.name.split("/")[1:-1]
        for level in range(1, len(parts) + 1):
            inside["/" + "/".join(parts[:level])] += 1
    return sorted(space for space, number in inside.items() if number > 1)


def _within(name: str, spaces: Collection[str]) -> str | None:
    """Return the innermost of some namespaces that a name lies in."""
    parts = name.split("/")[:-1]
    inner = ("/".join(parts[:level]) for level in range(len(parts), 1, -1))
    return next((space for space in inner if space in spaces), None)


def _ordinary(keys: Mapping[str, NodeInstance]) -> frozenset[str]:
    """Return the names of channels that are at least one node's own doing."""
    ends = (end for one in keys.values() for end in one.interfaces)
    return frozenset(end.resolved or "" for end in ends if not of_framework(end))


def _parted(graph: SystemGraph, ordinary: Collection[str], about: Collection[str]) -> Iterable[Bundle]:
    """Yield bundles, split: a channel with a finding is alone, those of frameworks are together."""
    for bundle in bundles(graph):
        parts: defaultdict[object, list[Any]] = defaultdict(list)
        for channel in bundle.channels:
            alone = channel.name if channel.name in about else ""
            parts[alone, channel.name in ordinary or channel.open, channel.name in _TRANSFORMS].append(channel)
        for channels in parts.values():
            yield replace(bundle, key=channels[0].key, channels=tuple(channels))


def _member(member: Member, iri: str | None, group: str | None, about: Mapping[str, list[int]]) -> dict[str, Any]:
    told = [member.about, "" if member.kind == "node" else member.kind, f"in {member.host}" if member.host else ""]
    told += [f"if {member.condition}" if member.condition else "", member.reason or "", member.place]
    return {
        "id": member.key,
        "label": member.name.rpartition("/")[2] if group else member.name,
        "kind": "node",
        "group": group,
        "detail": ", ".join(filter(None, told)),
        "iri": iri,
        "findings": about.get(member.name, []),
        "debug": False,
        "transforms": False,
        "loose": False,
        "unknown": member.reason is not None,
    }


def _channels(
    bundle: Bundle, spaces: Collection[str], ordinary: Collection[str], about: Mapping[str, list[int]]
) -> dict[str, Any]:
    first, names = bundle.channels[0], [one.name for one in bundle.channels]
    more, group = len(names) - 1, _shared({*bundle.sources, *bundle.targets}, spaces)
    label = first.name.removeprefix(f"{group}/") if group else first.name
    types = sorted({kind for one in bundle.channels for kind in one.types})
    told = [", ".join(names[:_NAMED]) if more else "", f"and {len(names) - _NAMED} more" if len(names) > _NAMED else ""]
    told += [", ".join(types[:_NAMED]), "the name is not known" if first.open else ""]
    return {
        "id": f"{bundle.key} ({len(names)})",
        "label": f"{label} and {count(more, f'other {bundle.kind}')}" if more else label,
        "kind": bundle.kind,
        "group": group,
        "package": None,
        "detail": "; ".join(filter(None, told)),
        "iri": None,
        "names": names,
        "findings": sorted({number for name in names for number in about.get(name, ())}),
        "debug": not first.open and first.name not in ordinary,
        "transforms": first.name in _TRANSFORMS,
        "loose": bundle.dangling,
        "unknown": first.open,
    }


def _shared(members: Iterable[str], spaces: Collection[str]) -> str | None:
    """Return the innermost namespace that contains all members of a channel; it closes with them."""
    found = None
    for number, member in enumerate(sorted(members)):
        space = _within(member, spaces)
        found = space if number == 0 else _common(found, space, spaces)
    return found


def _common(one: str | None, other: str | None, spaces: Collection[str]) -> str | None:
    while one is not None and other != one and not (other or "").startswith(f"{one}/"):
        one = _within(one, spaces)
    return one


def _unknown(member: str, those: Sequence[Bundle], group: str | None) -> dict[str, Any]:
    """Return the node for all ends of a member with unknown names."""
    names = [channel.name for bundle in those for channel in bundle.channels]
    more = f", and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return {
        "id": f"unknown {member}",
        "label": count(len(names), "unknown name"),
        "kind": "unknown",
        "group": group,
        "package": None,
        "detail": ", ".join(names[:_NAMED]) + more,
        "iri": None,
        "names": names,
        "findings": [],
        "debug": False,
        "transforms": False,
        "loose": False,
        "unknown": True,
    }


def _edges(bundle: Bundle, unfit: Collection[tuple[str, str]]) -> Iterable[dict[str, Any]]:
    channel, names = f"{bundle.key} ({len(bundle.channels)})", [one.name for one in bundle.channels]
    ends = [(one, one, channel) for one in bundle.sources] + [(one, channel, one) for one in bundle.targets]
    for member, source, target in ends:
        marked = any((name, member) in unfit for name in names)
        yield {"source": source, "target": target, "kind": bundle.kind, "marked": marked}


def system(
    snapshot: EmbeddedSnapshot, settings: Settings, *, name: str, repository: str = "", every: str = ""
) -> dict[str, Any]:
    """Return the computation graph of a launch configuration, with its findings.

    `name` is its name, the end of it by whole segments, or its IRI; `repository` distinguishes several of one name.
    With `every` (any text) the table has what frameworks make, too. The keys:

    * `name`, `iri`, `repository`, `path`, `package`, `ros`, `dialect`, `evidence` (the launch file), `arguments`
      (`name`, `default`, `value`, `description`, `fixed`, `choices`, `evidence`), `includes` (`name`, `iri`, `path`),
      `settings` (parameters that are no instance's), `problems` (`kind`, `message`, `subject`, `evidence`).
    * `instances`: what is started, see `kg.views.system_rows`; with their ends this is the table of the system.
    * `picture`: the same as a graph, see `kg.views.system`.
    * `findings` and `allowed`: as the view `lint` has them.
    * `counts`: of `nodes`, `topics`, `services`, `actions`, `unresolved` (ends whose name is not known).

    Raises:
        UnknownNameError: KG422 with suggestions if there is none.
        UsageError: KG003 if there are several.
    """
    meant = system_named(snapshot, name, repository, settings.base)
    found = _read(snapshot, meant, settings.base)
    where, iris, source = places(snapshot), Iris(settings.base), meant.repository
    report = system_report(snapshot, settings, meant)
    graph, own = system_graph(found, every=True), found.configuration
    keys = instance_keys(found.instances)
    unresolved = sum(not is_known(end.resolved) for one in keys.values() for end in one.interfaces)
    kinds = [channel.kind for channel in graph.channels if not channel.open]
    return {
        "name": meant.name,
        "iri": iris.configuration(source, meant.path),
        "repository": source,
        "path": meant.path,
        "package": own.package,
        "ros": meant.ros,
        "dialect": str(own.dialect),
        "evidence": where.evidence(source, Location(meant.path, 0)),
        "arguments": [_argument(one, source, where) for one in own.arguments],
        "includes": _includes(own.includes, snapshot, iris),
        "settings": [setting_row(one, source, where) for one in found.shared_parameters],
        "problems": [_problem(one, source, where) for one in own.problems],
        "instances": instance_rows(found, keys, graph, where, iris, every=bool(every)),
        "picture": picture(graph, keys, report.findings, iris),
        "findings": finding_objects(report.findings, where),
        "allowed": len(report.allowed),
        "counts": {
            "nodes": len(found.instances),
            **{f"{kind}s": kinds.count(kind) for kind in ("topic", "service", "action")},
            "unresolved": unresolved,
        },
    }


@while_last
def _read(snapshot: EmbeddedSnapshot, name: SystemName, base: str) -> System:
    """Read a system, the parts of whose page may each ask for it."""
    (found,) = read_systems(snapshot, [name], base)
    return found


def _argument(one: LaunchArgument, source: str, where: Places) -> dict[str, Any]:
    return {
        "name": one.name,
        "default": one.default,
        "value": one.value,
        "description": one.description,
        "fixed": one.fixed,
        "choices": list(one.choices),
        "evidence": where.evidence(source, one.location),
    }


def _includes(those: Iterable[LaunchInclude], snapshot: EmbeddedSnapshot, iris: Iris) -> list[dict[str, Any]]:
    named = {(other.repository, other.path): other.name for other in known_names(snapshot)}
    found = [(one.repository or "", one.path or one.written) for one in those]
    return [
        {"name": named.get((repository, path), path), "iri": iris.configuration(repository, path), "path": path}
        for repository, path in found
    ]


def _problem(one: LaunchProblem, source: str, where: Places) -> dict[str, Any]:
    return {
        "kind": str(one.kind),
        "message": one.message,
        "subject": one.subject,
        "evidence": where.evidence(source, one.location),
    }
