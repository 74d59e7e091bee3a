"""Rows of the lists over the whole store, as plain values; `kg.views.lists` declares the lists."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.reading import overview
from kg.graph.reading.queries import select
from kg.lint.objects import as_object
from kg.lint.question import Question
from kg.lint.running import check
from kg.settings import Settings
from kg.views import answers
from kg.views.systems import all_systems

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.lint.finding import Finding
    from kg.store.snapshot import EmbeddedSnapshot

    Rows = Sequence[dict[str, Any]]

_ROLES: Final = ("publishes", "subscribes", "services", "clients", "action_servers", "action_clients")
_CLASSES: Final = {
    f"{v.RNKG}hasFunction": "functions",
    f"{v.RNKG}usesHardware": "hardware",
    f"{v.RNKG}usesDevice": "hardware",
    f"{v.RNKG}hasCapability": "capabilities",
}
_GRADES: Final = {
    f"{v.RNKG}gradeCertain": "certain",
    f"{v.RNKG}gradeStrong": "strong",
    f"{v.RNKG}gradeWeak": "weak",
}
_HELD: Final = f"""SELECT DISTINCT ?node ?property ?class (STR(?label) AS ?text) {{
  VALUES ?property {{ {" ".join(f"<{iri}>" for iri in _CLASSES)} }}
  ?node a rnkg:NodeType ; ?property ?class . ?class rdfs:label ?label
}} ORDER BY ?text"""
_GRADED: Final = f"""SELECT DISTINCT ?node ?grade ?class {{
  VALUES ?grade {{ {" ".join(f"<{iri}>" for iri in _GRADES)} }} ?node ?grade ?class
}}"""
_KINDS: Final = {"MessageType": "message", "ServiceType": "service", "ActionType": "action"}
_TYPES: Final = f"""SELECT DISTINCT ?type ?kind ?label {{
  VALUES ?kind {{ {" ".join(f"rnkg:{name}" for name in _KINDS)} }} ?type a ?kind ; rdfs:label ?label
}} ORDER BY ?label ?kind"""
_DEFINED: Final = """SELECT DISTINCT ?type ?repository {
  ?definition rnkg:defines ?type . ?package rnkg:contains ?definition . ?source rnkg:contains ?package ;
    a rnkg:Repository ; rnkg:name ?repository
} ORDER BY ?repository"""
_USED: Final = """SELECT ?type (COUNT(DISTINCT ?node) AS ?nodes) {
  ?node a rnkg:NodeType ; ros:hasComponent ?end .
  ?end ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?type
} GROUP BY ?type"""
_SIDES: Final = {
    "topic": ("publishers", "subscribers"),
    "service": ("servers", "clients"),
    "action": ("servers", "clients"),
}


def nodes(snapshot: EmbeddedSnapshot, _base: str) -> Rows:
    """Return the node types; `at` is the place of a node among those of `kg nodes --json`."""

    def make() -> list[dict[str, Any]]:
        labels = _labels(snapshot)
        return [_node(at, one, labels[one.iri]) for at, one in enumerate(answers.node_lines(snapshot))]

    return answers.rows(snapshot, "list-nodes", make)


def _node(at: int, line: answers.NodeLine, labels: dict[str, list[str]]) -> dict[str, Any]:
    node = msgspec.json.decode(line.text)
    own = {role: [one for one in node[role] if not one["implicit"]] for role in _ROLES}
    copied = ("repository", "package", "kind", "ros", "language", "description", "executable", "plugin", "file", "line")
    return {
        "at": at,
        "iri": line.iri,
        "node": node["node"],
        **{name: node[name] for name in copied},
        **{role: len(own[role]) for role in _ROLES[:4]},
        "actions": len(own["action_servers"]) + len(own["action_clients"]),
        "parameters": len({one["name"] for one in node["parameters"] if not one["implicit"]}),
        "types": sorted({one["type"] for role in _ROLES for one in own[role] if one["type"]}),
        **{name: labels.get(name, []) for name in dict.fromkeys(_CLASSES.values())},
    }


def node_objects(snapshot: EmbeddedSnapshot, rows: Rows) -> Rows:
    """Return the objects of `kg nodes --json` for rows of nodes, each with its `iri`."""
    lines = answers.node_lines(snapshot)
    return [{**msgspec.json.decode(lines[row["at"]].text), "iri": row["iri"]} for row in rows]


def packages(snapshot: EmbeddedSnapshot, base: str) -> Rows:
    """Return the packages, as `kg packages --json` has them."""
    iris = Iris(base)

    def make() -> list[dict[str, Any]]:
        return [{"iri": iris.package(one.repository, one.name), **asdict(one)} for one in overview.packages(snapshot)]

    return answers.rows(snapshot, "list-packages", make)


def channels(snapshot: EmbeddedSnapshot, base: str, kind: str) -> Rows:
    """Return the topics, services or actions with the nodes at their two ends."""
    iris = Iris(base)
    return [
        {
            "iri": iris.channel(kind, one.name),
            **asdict(one),
            "giving": one.giving,
            "taking": one.taking,
            "ends": _ends(one, kind),
            "packages": sorted({node.partition("/")[0] for node in (*one.givers, *one.takers)}),
        }
        for one in answers.channels(snapshot, kind)
    ]


def _ends(one: overview.Channel, kind: str) -> str:
    givers, takers = _SIDES[kind]
    if one.givers and one.takers:
        return "both ends"
    return f"{givers} only" if one.givers else f"{takers} only" if one.takers else "no known node"


def types(snapshot: EmbeddedSnapshot, _base: str) -> Rows:
    """Return the types of messages, services and actions, with the sources that define them and the number of users."""

    def make() -> list[dict[str, Any]]:
        sources: defaultdict[str, list[str]] = defaultdict(list)
        for row in select(snapshot, _DEFINED):
            sources[row["type"].value].append(row["repository"].value)
        used = Counter({row["type"].value: int(row["nodes"].value) for row in select(snapshot, _USED)})
        return [
            {
                "iri": row["type"].value,
                "name": row["label"].value,
                "kind": _KINDS[row["kind"].value.removeprefix(v.RNKG)],
                "package": row["label"].value.partition("/")[0],
                "nodes": used[row["type"].value],
                "repositories": sources.get(row["type"].value, []),
                "defined": "in this store" if row["type"].value in sources else "elsewhere",
            }
            for row in select(snapshot, _TYPES)
        ]

    return answers.rows(snapshot, "list-types", make)


def classes(snapshot: EmbeddedSnapshot, _base: str, of: str) -> Rows:
    """Return functions or capabilities of nodes, or their hardware and devices, with the number of nodes by grade."""

    def make() -> list[dict[str, Any]]:
        grades: defaultdict[str, Counter[str]] = defaultdict(Counter)
        for row in select(snapshot, _GRADED):
            grades[row["class"].value][_GRADES[row["grade"].value]] += 1
        by_class: dict[tuple[str, str], dict[str, Any]] = {}
        for row in select(snapshot, _HELD):
            iri, prop = row["class"].value, row["property"].value
            kind = "device" if prop.endswith("usesDevice") else "kind"
            empty = {"iri": iri, "name": row["text"].value, "of": _CLASSES[prop], "kind": kind, "nodes": 0}
            by_class.setdefault((iri, prop), empty)["nodes"] += 1
        return [
            {**one, **{grade: grades[one["iri"]][grade] for grade in _GRADES.values()}} for one in by_class.values()
        ]

    return [row for row in answers.rows(snapshot, "list-classes", make) if row["of"] == of]


def systems(snapshot: EmbeddedSnapshot, base: str) -> Rows:
    """Return the launch configurations, as the view `systems` has them; `worst` is the worst severity of a finding."""
    return [
        {
            **one,
            "worst": next((level for level in ("error", "warning", "note") if one["findings"].get(level)), "none"),
            "problems": sum(one["findings"].values()),
            "use": "included by others" if one["included"] else "started by itself",
        }
        for one in all_systems(snapshot, base)
    ]


def parameters(snapshot: EmbeddedSnapshot, _base: str) -> Rows:
    """Return the parameters of nodes, each once a node, without those that frameworks create."""

    def make() -> list[dict[str, Any]]:
        return [row for one in answers.node_lines(snapshot) for row in _parameters(one)]

    return answers.rows(snapshot, "list-parameters", make)


def _parameters(line: answers.NodeLine) -> Iterable[dict[str, Any]]:
    node = msgspec.json.decode(line.text)
    groups: defaultdict[str | None, list[dict[str, Any]]] = defaultdict(list)
    for one in node["parameters"]:
        if not one["implicit"]:
            groups[one["name"]].append(one)
    for name in sorted(groups, key=lambda one: one or ""):
        group = groups[name]
        first = next((one for one in group if one["access"] == "declare"), group[0])
        shared = {
            key: next((one[key] for one in (first, *group) if one[key] is not None), None)
            for key in ("type", "default", "description")
        }
        yield {
            "iri": line.iri,
            "name": name,
            **shared,
            "access": sorted({one["access"] for one in group}),
            "node": node["node"],
            "package": node["package"],
            "repository": node["repository"],
            "file": first["file"],
            "line": first["line"],
        }


def findings(snapshot: EmbeddedSnapshot, base: str) -> Rows:
    """Return what `kg lint` reports, as `kg lint --json` has it; UsageError KG002 and KG421 for kg.toml.

    A row also has `systems` and `packages`, all launch files with the finding and their packages, and `others`, the
    number of launch files beside `system`.
    """
    reported = check(snapshot, Question(), Settings(base=base), Path.cwd()).report.findings
    return [_finding(one) for one in reported]


def _finding(one: Finding) -> dict[str, Any]:
    systems = [one.system, *one.also]
    packages = list(dict.fromkeys(system.partition("/")[0] for system in systems))
    return {
        **as_object(one),
        "iri": one.iri,
        "package": packages[0],
        "systems": systems,
        "packages": packages,
        "others": len(one.also),
    }


def _labels(snapshot: EmbeddedSnapshot) -> defaultdict[str, dict[str, list[str]]]:
    """Return the labels of functions, hardware and capabilities: by IRI of the node, then by list."""
    by_node: defaultdict[str, dict[str, list[str]]] = defaultdict(dict)
    for row in select(snapshot, _HELD):
        labels = by_node[row["node"].value].setdefault(_CLASSES[row["property"].value], [])
        if row["text"].value not in labels:
            labels.append(row["text"].value)
    return by_node
