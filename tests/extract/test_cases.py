"""Extraction cases are files: `cases/<language>/<case>/` holds a small source and `expected.json`.

`expected.json` is a list of nodes as `kg nodes --json` prints them (docs: machine-readable outputs), each with the
keys that the case is about. Lists of interfaces and parameters are compared as a whole, without what frameworks make,
on the keys that the expected entries give; a node that is not listed fails the case. `implicit` lists names of
interfaces that must be there through a framework, `problems` (in an object beside `nodes`) the codes of problems.
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
    """Return a node as `kg nodes --json` prints it, what frameworks make apart."""
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
    """Return an interface as `kg nodes --json` prints it, with the fields of the fact that it leaves out."""
    record = asdict(item)
    del record["role"], record["location"]
    if item.qos is not None:
        record["qos"] = quality(item.qos)
    record["switches"] = list(item.switches)
    return {**record, "resolution": item.resolution.value, **evidence_record(item)}


def slot_record(item: PluginSlot) -> Record:
    """Return a plugin slot as `kg nodes --json` prints it, each default as `NAME: CLASS`."""
    record = asdict(item)
    del record["location"]
    defaults = [f"{one.name or '-'}: {one.class_name}" for one in item.defaults]
    return {**record, "defaults": defaults, **evidence_record(item)}


def evidence_record(item: Interface | Parameter | PluginSlot) -> Record:
    """Return the line of a fact, and all calls from there to the framework."""
    return {"file": item.location.path, "line": item.location.line, "via": chain_text(item.via)}


def quality(qos: Qos) -> Record:
    """Return a quality of service as `kg nodes --json` prints it: the rarer policies only where they are known."""
    usual = {"reliability", "durability", "history", "depth"}
    return {name: value for name, value in asdict(qos).items() if name in usual or value is not None}


def parameter_record(item: Parameter) -> Record:
    """Return a parameter as `kg nodes --json` prints it."""
    record = asdict(item)
    del record["location"]
    return {**record, "access": item.access.value, **evidence_record(item)}


def restricted(found: object, wanted: object, key: str = "") -> object:
    """Return what was found with only the keys that are wanted, lists of entries in one order."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        return {name: restricted(found.get(name), value, name) for name, value in wanted.items()}
    if key == "implicit" and isinstance(found, list) and isinstance(wanted, list):
        return [name for name in found if name in wanted]
    if isinstance(found, list) and isinstance(wanted, list) and wanted and isinstance(wanted[0], dict):
        names = sorted({name for entry in wanted for name in entry})
        return ordered([{name: entry.get(name) for name in names} for entry in found])
    return found


def expected(wanted: object, key: str = "") -> object:
    """Return what a case wants in the same order as `restricted` gives it."""
    if isinstance(wanted, dict):
        return {name: expected(value, name) for name, value in wanted.items()}
    if isinstance(wanted, list) and wanted and isinstance(wanted[0], dict):
        names = sorted({name for entry in wanted for name in entry})
        return ordered([{name: entry.get(name) for name in names} for entry in wanted])
    return sorted(wanted) if key == "implicit" and isinstance(wanted, list) else wanted


def ordered(entries: list[Record]) -> list[Record]:
    """Return entries in an order that rests on their content alone."""
    return sorted(entries, key=lambda entry: json.dumps(entry, sort_keys=True))


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.parent.name}/{case.name}")
def test_case(case: Path) -> None:
    """The nodes of a case are those that its file expects, with the interfaces that it expects and no others."""
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
    """The runner finds cases of both languages, so that none of them passes by not being run."""
    assert {case.parent.name for case in CASES} >= {"python"}
