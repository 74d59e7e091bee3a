"""One launch configuration, wired, and findings on the wiring of all: the views `system` and `lint`."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.codes import CATALOGUE
from kg.facts import LaunchArgument, LaunchConfiguration, LaunchInclude, Location, NodeInstance, System
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.reading.systems import SystemName
from kg.graph.reading.systems import systems as read_systems
from kg.holes import is_known
from kg.lint.allowing import Comments, allowances
from kg.lint.objects import as_object
from kg.lint.question import Question
from kg.lint.reading import read_findings
from kg.lint.report import Choice, Report, report
from kg.lint.running import check
from kg.render.system_graph import Bundle, Member, SystemGraph, bundles, instance_keys, of_framework, system_graph
from kg.render.text import count
from kg.settings import Settings, table
from kg.views.evidence import Places, places
from kg.views.names import require_package
from kg.views.node_rows import fact
from kg.views.remembered import while_last
from kg.views.system_rows import MISMATCHES, instance_rows, setting_row
from kg.views.systems import configuration_names, included_names, system_named

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from kg.lint.finding import Evidence, Finding
    from kg.store.snapshot import EmbeddedSnapshot

_TRANSFORMS: Final = frozenset({"/tf", "/tf_static"})
_NAMED: Final = 12  # so many channels of a bundle are named
_DRAWN: Final[Mapping[str, Any]] = {
    "package": None,
    "iri": None,
    "findings": [],
    "debug": False,
    "transforms": False,
    "loose": False,
    "unknown": False,
}
"""What a node of a picture has, unless more is known of it."""

_TYPE: Final = v.bare(v.TYPE)
_FINDING: Final = f"{v.RNKG}Finding"


def lint(  # noqa: PLR0913 - what is looked at
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    system: str = "",
    package: str = "",
    repository: str = "",
    level: str = "note",
) -> dict[str, Any]:
    """Return the findings of `kg lint` on one `system` (as the view of that name takes it), of a `package`, or of all.

    `level` is the least severity: error, warning or note. The answer is `{"findings", "allowed", "systems"}`: what is
    reported, how many findings kg.toml and comments allow, how many configurations were looked at. A finding has the
    keys of `kg lint --json` (docs/formats.md), and `iri`, `place` (where to mend it, as
    `kg.views.evidence.Places.evidence`, with `words`, `chain`, `line_text` and `line_stored`), `evidence` (a list
    of the same), `way_out` (what to do about findings of its code) and `fact`, which the view `why` proves.

    Raises:
        UnknownNameError: KG422 and KG001 for an unknown system and package.
        UsageError: KG002 and KG421 for kg.toml, KG003 for an ambiguous name of a system.
    """
    least = level if level in {"error", "warning", "note"} else "note"
    if system:
        name = system_named(snapshot, system, repository, settings.base)
        reported, looked_at = system_report(snapshot, settings, name, least), 1
    else:
        if package:
            require_package(snapshot, package)
        checked = check(snapshot, Question(package=package or None, level=least), settings, Path.cwd())
        reported, looked_at = checked.report, checked.systems
    where = places(snapshot)
    return {
        "findings": finding_objects(reported.findings, where),
        "allowed": len(reported.allowed),
        "systems": looked_at,
    }


def system_report(snapshot: EmbeddedSnapshot, settings: Settings, name: SystemName, level: str = "note") -> Report:
    """Return the findings on one configuration; others are not read."""
    configuration = Iris(settings.base).configuration(name.repository, name.path)
    findings = read_findings(snapshot, settings.base, configuration)
    where = places(snapshot)
    roots = {one: state.root for one, state in where.sources.items() if state.root}
    entries = allowances(table("lint", Path.cwd()), {one.code for one in findings})
    choice = Choice(frozenset({name.name}), level=level)
    included = included_names(snapshot)
    return report(findings, choice, included=included, entries=entries, comments=Comments(roots))


def finding_objects(findings: tuple[Finding, ...], where: Places) -> list[dict[str, Any]]:
    """Return findings as faces show them; see `lint`."""
    return [
        {
            **as_object(finding),
            "iri": finding.iri,
            "place": _place(finding.place, where) if finding.place else None,
            "evidence": [_place(one, where) for one in finding.evidence],
            "way_out": CATALOGUE[finding.code].way_out if finding.code in CATALOGUE else None,
            "fact": fact(finding.iri, _TYPE, _FINDING),
        }
        for finding in findings
    ]


def _place(place: Evidence, where: Places) -> dict[str, Any]:
    location = Location(place.path, place.line or 0)
    return {
        **where.evidence(place.repository, location),
        "words": place.words or None,
        "chain": place.chain or None,
        **where.code(place.repository, location),
    }


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
        drawn = _member(member, _within(member.name, spaces), about)
        nodes.append({**drawn, "iri": iri, "package": kind.package if kind else None})
    # The names of channels that are at least one node's own doing.
    ends = (end for one in keys.values() for end in one.interfaces)
    ordinary = frozenset(end.resolved or "" for end in ends if not of_framework(end))
    unfit = {
        (name, node) for one in findings if one.code in MISMATCHES for name in one.subjects[:1] for node in one.subjects
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


def _parted(graph: SystemGraph, ordinary: Collection[str], about: Collection[str]) -> Iterable[Bundle]:
    """Yield bundles, split: a channel with a finding is alone, those of frameworks are together."""
    for bundle in bundles(graph):
        parts: defaultdict[object, list[Any]] = defaultdict(list)
        for channel in bundle.channels:
            alone = channel.name if channel.name in about else ""
            parts[alone, channel.name in ordinary or channel.open, channel.name in _TRANSFORMS].append(channel)
        for channels in parts.values():
            yield replace(bundle, key=channels[0].key, channels=tuple(channels))


def _member(member: Member, group: str | None, about: Mapping[str, list[int]]) -> dict[str, Any]:
    parts = [member.about, "" if member.kind == "node" else member.kind, f"in {member.host}" if member.host else ""]
    parts += [f"if {member.condition}" if member.condition else "", member.reason or "", member.place]
    return {
        **_DRAWN,
        "id": member.key,
        "label": member.name.rpartition("/")[2] if group else member.name,
        "kind": "node",
        "group": group,
        "detail": ", ".join(filter(None, parts)),
        "findings": about.get(member.name, []),
        "unknown": member.reason is not None,
    }


def _channels(
    bundle: Bundle, spaces: Collection[str], ordinary: Collection[str], about: Mapping[str, list[int]]
) -> dict[str, Any]:
    first, names = bundle.channels[0], [one.name for one in bundle.channels]
    more, group = len(names) - 1, _shared({*bundle.sources, *bundle.targets}, spaces)
    label = first.name.removeprefix(f"{group}/") if group else first.name
    types = sorted({kind for one in bundle.channels for kind in one.types})
    parts = [
        ", ".join(names[:_NAMED]) if more else "",
        f"and {len(names) - _NAMED} more" if len(names) > _NAMED else "",
    ]
    parts += [", ".join(types[:_NAMED]), "the name is not known" if first.open else ""]
    return {
        **_DRAWN,
        "id": f"{bundle.key} ({len(names)})",
        "label": f"{label} and {count(more, f'other {bundle.kind}')}" if more else label,
        "kind": bundle.kind,
        "group": group,
        "detail": "; ".join(filter(None, parts)),
        "names": names,
        "findings": sorted({number for name in names for number in about.get(name, ())}),
        "debug": not first.open and first.name not in ordinary,
        "transforms": first.name in _TRANSFORMS,
        "loose": bundle.dangling,
        "unknown": first.open,
    }


def _shared(members: Iterable[str], spaces: Collection[str]) -> str | None:
    """Return the innermost namespace that contains all members of a channel; it closes with them."""
    first, *others = [_within(member, spaces) or "" for member in members]
    namespace: str | None = first or None
    for other in others:
        while namespace is not None and not f"{other}/".startswith(f"{namespace}/"):
            namespace = _within(namespace, spaces)
    return namespace


def _unknown(member: str, those: Sequence[Bundle], group: str | None) -> dict[str, Any]:
    """Return the node for all ends of a member with unknown names."""
    names = [channel.name for bundle in those for channel in bundle.channels]
    more = f", and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return {
        **_DRAWN,
        "id": f"unknown {member}",
        "label": count(len(names), "unknown name"),
        "kind": "unknown",
        "group": group,
        "detail": ", ".join(names[:_NAMED]) + more,
        "names": names,
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

    * `name`, `iri`, `repository`, `path`, `package`, `ros`, `dialect`, `start` (the command), `evidence` (the launch
      file), `arguments` (`name`, `default`, `value`, `description`, `fixed`, `choices`, `evidence`), `includes`
      (`name`, `iri`, `path`), `settings` (parameters that are no instance's), `problems` (`kind`, `message`,
      `subject`, `evidence`).
    * `instances`: what is started, see `kg.views.system_rows`; with their ends this is the table of the system.
    * `picture`: the same as a graph, see `kg.views.system`.
    * `findings` and `allowed`: as the view `lint` has them.
    * `counts`: of `nodes`, `topics`, `services`, `actions`, `unresolved` (ends whose name is not known).

    Raises:
        UnknownNameError: KG422 with suggestions if there is none.
        UsageError: KG003 if there are several.
    """
    configuration = system_named(snapshot, name, repository, settings.base)
    wired = _read(snapshot, configuration, settings.base)
    where, iris, source = places(snapshot), Iris(settings.base), configuration.repository
    report = system_report(snapshot, settings, configuration)
    graph, own = system_graph(wired, every=True), wired.configuration
    keys = instance_keys(wired.instances)
    unresolved = sum(not is_known(end.resolved) for one in keys.values() for end in one.interfaces)
    kinds = [channel.kind for channel in graph.channels if not channel.open]
    return {
        "name": configuration.name,
        "iri": iris.configuration(source, configuration.path),
        "repository": source,
        "path": configuration.path,
        "package": own.package,
        "ros": configuration.ros,
        "dialect": str(own.dialect),
        "start": _start(configuration, own),
        "evidence": where.evidence(source, Location(configuration.path, 0)),
        "arguments": [_argument(one, source, where) for one in own.arguments],
        "includes": _includes(own.includes, snapshot, iris),
        "settings": [setting_row(one, source, where) for one in wired.shared_parameters],
        "problems": [
            {
                "kind": str(one.kind),
                "message": one.message,
                "subject": one.subject,
                "evidence": where.evidence(source, one.location),
            }
            for one in own.problems
        ],
        "instances": instance_rows(wired, keys, graph, where, iris, every=bool(every)),
        "picture": picture(graph, keys, report.findings, iris),
        "findings": finding_objects(report.findings, where),
        "allowed": len(report.allowed),
        "counts": {
            "nodes": len(wired.instances),
            **{f"{kind}s": kinds.count(kind) for kind in ("topic", "service", "action")},
            "unresolved": unresolved,
        },
    }


@while_last
def _read(snapshot: EmbeddedSnapshot, name: SystemName, base: str) -> System:
    """Read a system, the parts of whose page may each ask for it."""
    (wired,) = read_systems(snapshot, [name], base)
    return wired


def _start(name: SystemName, own: LaunchConfiguration) -> str:
    """Return the command that starts a configuration, with the arguments that it requires."""
    what = f"{own.package} {name.path.rpartition('/')[2]}" if own.package else name.path
    required = [f"{one.name}:=..." for one in own.arguments if one.default is None and not one.fixed]
    return " ".join(["roslaunch" if name.ros == 1 else "ros2 launch", what, *required])


def _argument(one: LaunchArgument, source: str, where: Places) -> dict[str, Any]:
    stated = {name: value for name, value in asdict(one).items() if name != "location"}
    return {**stated, "choices": list(one.choices), "evidence": where.evidence(source, one.location)}


def _includes(those: Iterable[LaunchInclude], snapshot: EmbeddedSnapshot, iris: Iris) -> list[dict[str, Any]]:
    named = {(other.repository, other.path): other.name for other in configuration_names(snapshot)}
    targets = [(one.repository or "", one.path or one.written) for one in those]
    return [
        {"name": named.get((repository, path), path), "iri": iris.configuration(repository, path), "path": path}
        for repository, path in targets
    ]
