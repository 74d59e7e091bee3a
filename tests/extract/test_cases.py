"""Extraction cases are files: `cases/<language>/<case>/` has a small source and `expected.json`.

`expected.json` is a list of nodes as printed by `kg nodes --json` (docs: machine-readable outputs), each with the keys
under test. Lists of interfaces and parameters are compared completely, without implicit ones, on the keys of the
expected entries; an unlisted node fails the case. `implicit` lists names of required implicit interfaces, `problems`
(in an object next to `nodes`) the codes of problems.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.extract.package import extract_package
from kg.facts import Repository
from kg.graph.chains import chain_text

if TYPE_CHECKING:
    from kg.facts import Interface, NodeType, PackageFacts, Parameter, PluginSlot, Qos

LANGUAGES = ("cpp", "python")
CASES = [
    path.parent
    for language in LANGUAGES
    for path in sorted((Path(__file__).parent / "cases" / language).glob("*/expected.json"))
]
ROLES = ("publishes", "subscribes", "services", "clients", "action_servers", "action_clients")
Record = dict[str, Any]


def extract(case: Path) -> list[PackageFacts]:
    """Return the facts of all packages of a case."""
    workspace = Workspace([scan(case, Repository(f"local/{case.name}", str(case)))])
    packages = [(source, package) for source in workspace.sources for package in source.packages]
    return [extract_package(Reader(workspace, source, package)) for source, package in packages]


def record_of(node: NodeType, package: str) -> Record:
    """Return a node in the form of `kg nodes --json`, with implicit interfaces separated."""
    written = [item for item in node.interfaces if not item.implicit]
    return {
        "package": package,
        "node": node.name,
        "kind": node.kind.value,
        "executable": node.executable,
        "plugin": node.plugin,
        "language": node.language,
        "ros": node.ros,
        "node_name": node.node_name,
        "node_namespace": node.node_namespace,
        "line": node.location.line,
        "sources": list(node.sources),
        **{role: [interface_record(item) for item in written if item.role == role] for role in ROLES},
        "parameters": [parameter_record(item) for item in node.parameters if not item.implicit],
        "slots": [slot_record(item) for item in node.slots],
        "base_class": node.base_class,
        "exported": str(node.exported) if node.exported is not None else None,
        "implicit": sorted({item.name or "" for item in node.interfaces if item.implicit}),
    }


def interface_record(item: Interface) -> Record:
    """Return an interface in the form of `kg nodes --json`, including the fields omitted there."""
    record = asdict(item)
    del record["role"], record["location"]
    if item.qos is not None:
        record["qos"] = quality(item.qos)
    record |= {name: list(record[name]) for name in ("switches", "upon", "unset", "filled")}
    return {**record, "resolution": item.resolution.value, **evidence_record(item)}


def slot_record(item: PluginSlot) -> Record:
    """Return a plugin slot in the form of `kg nodes --json`, each default as `NAME: CLASS`."""
    record = asdict(item)
    del record["location"]
    defaults = [f"{one.name or '-'}: {one.class_name}" for one in item.defaults]
    return {**record, "defaults": defaults, **evidence_record(item)}


def evidence_record(item: Interface | Parameter | PluginSlot) -> Record:
    """Return the line of a fact, and all calls from there to the framework."""
    return {"file": item.location.path, "line": item.location.line, "via": chain_text(item.via)}


def quality(qos: Qos) -> Record:
    """Return a quality of service in the form of `kg nodes --json`: the rarer policies only if they are known."""
    usual = {"reliability", "durability", "history", "depth"}
    return {name: value for name, value in asdict(qos).items() if name in usual or value is not None}


def parameter_record(item: Parameter) -> Record:
    """Return a parameter in the form of `kg nodes --json`."""
    record = asdict(item)
    del record["location"]
    return {**record, "access": item.access.value, **evidence_record(item)}


def restricted(found: object, wanted: object, key: str = "") -> object:
    """Return the result with only the expected keys, and lists of entries in a fixed order."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        return {name: restricted(found.get(name), value, name) for name, value in wanted.items()}
    if key == "implicit" and isinstance(found, list) and isinstance(wanted, list):
        return [name for name in found if name in wanted]
    if isinstance(found, list) and isinstance(wanted, list) and wanted and isinstance(wanted[0], dict):
        names = sorted({name for entry in wanted for name in entry})
        return ordered([{name: entry.get(name) for name in names} for entry in found])
    return found


def expected(wanted: object, key: str = "") -> object:
    """Return the expected result of a case in the order of `restricted`."""
    if isinstance(wanted, dict):
        return {name: expected(value, name) for name, value in wanted.items()}
    if isinstance(wanted, list) and wanted and isinstance(wanted[0], dict):
        names = sorted({name for entry in wanted for name in entry})
        return ordered([{name: entry.get(name) for name in names} for entry in wanted])
    return sorted(wanted) if key == "implicit" and isinstance(wanted, list) else wanted


def ordered(entries: list[Record]) -> list[Record]:
    """Return entries in an order that depends on their content alone."""
    return sorted(entries, key=lambda entry: json.dumps(entry, sort_keys=True))


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.parent.name}/{case.name}")
def test_case(case: Path) -> None:
    """The nodes of a case are exactly the expected ones, with exactly the expected interfaces."""
    wanted = json.loads((case / "expected.json").read_text())
    nodes = wanted["nodes"] if isinstance(wanted, dict) else wanted
    facts = extract(case)
    found = {
        (item.package.name, node.name): record_of(node, item.package.name) for item in facts for node in item.nodes
    }
    by_name = {name: record for (_, name), record in found.items()}
    assert sorted(name for _, name in found) == sorted(node["node"] for node in nodes)
    for node in nodes:
        assert restricted(by_name[node["node"]], node) == expected(node)
    if isinstance(wanted, dict) and "problems" in wanted:
        codes = sorted({problem.code for item in facts for problem in item.problems})
        assert codes == wanted["problems"]


def test_cases_are_found() -> None:
    """The runner finds cases of both languages, so no case passes without running."""
    assert {case.parent.name for case in CASES} >= {"python"}
