"""From sources to answers: a build of examples/workspace finds exactly the entries of examples/expected.json.

The file is written by hand from the code. Only the fields that an entry gives are compared. Interfaces created by a
framework are marked `implicit`; only the named ones have to be found.
"""

from __future__ import annotations

import json
import shutil
from typing import Any, Final, TypeAlias

import pytest
from cli.program import Program
from repository import ROOT

from kg.facts import Role

Entry: TypeAlias = dict[str, Any]

EXPECTED: Final[list[Entry]] = json.loads((ROOT / "examples" / "expected.json").read_text(encoding="utf-8"))
NAMES: Final = [f"{entry['package']}/{entry['node']}" for entry in EXPECTED]
LISTS: Final = (*(role.value for role in Role), "parameters")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Entry]:
    """Build a copy of the workspace, outside any git checkout, and return its nodes by package and name."""
    folder = tmp_path_factory.mktemp("examples")
    shutil.copytree(ROOT / "examples" / "workspace", folder / "workspace")
    kg = Program(folder)
    built, listed = kg("build", "workspace"), kg("nodes", "--json")
    assert (built.code, listed.code) == (0, 0), built.err + listed.err
    nodes = [json.loads(line) for line in listed.out.splitlines()]
    return {f"{node['package']}/{node['node']}": node for node in nodes}


def place(entry: Entry) -> tuple[str, ...]:
    """Return the key that distinguishes the entries of a list."""
    return tuple(str(entry.get(key)) for key in ("file", "line", "name", "access"))


def differences(wanted: list[Entry], given: list[Entry]) -> list[str]:
    """Describe the missing, wrong and superfluous entries of a list of interfaces or parameters."""
    open_ends = {place(entry): entry for entry in given if not entry.get("implicit")}
    words = []
    for entry in wanted:
        match = open_ends.pop(place(entry), None)
        if match is None:
            words.append(f"missing: {entry}")
        else:
            words += [
                f"{entry['name']}: {key} is {match.get(key)!r}, not {value!r}"
                for key, value in entry.items()
                if match.get(key) != value
            ]
    return words + [f"too much: {entry}" for entry in open_ends.values()]


def test_exactly_the_nodes_are_found(found: dict[str, Entry]) -> None:
    """Exactly the expected nodes are found, each by its name."""
    assert sorted(found) == sorted(NAMES)


@pytest.mark.parametrize("wanted", EXPECTED, ids=NAMES)
def test_each_node_is_what_it_is(wanted: Entry, found: dict[str, Entry]) -> None:
    """Kind, executable, plugin, language, ROS version and source files of each node are right."""
    node = found[f"{wanted['package']}/{wanted['node']}"]
    keys = ("kind", "executable", "plugin", "language", "ros")
    assert {key: node[key] for key in keys} == {key: wanted[key] for key in keys}
    assert set(wanted["sources"]) <= set(node["sources"])
    assert node["repository"] == "local/workspace"
    assert node["commit"] is None


@pytest.mark.parametrize("wanted", EXPECTED, ids=NAMES)
@pytest.mark.parametrize("kind", LISTS)
def test_everything_it_declares_is_found_and_nothing_more(wanted: Entry, kind: str, found: dict[str, Entry]) -> None:
    """Exactly the expected interfaces and parameters are found, with name, type, resolution and line."""
    node = found[f"{wanted['package']}/{wanted['node']}"]
    explicit = [entry for entry in wanted[kind] if not entry.get("implicit")]
    assert not differences(explicit, node[kind])


@pytest.mark.parametrize("wanted", EXPECTED, ids=NAMES)
def test_what_frameworks_make_is_found(wanted: Entry, found: dict[str, Entry]) -> None:
    """Topics and services of tf, diagnostics, logging and other frameworks are found with their types."""
    node = found[f"{wanted['package']}/{wanted['node']}"]
    missing = [
        f"{kind} {entry['name']} {entry['type']}"
        for kind in LISTS
        for entry in wanted[kind]
        if entry.get("implicit")
        and not any(
            (one["name"], one["type"], one["implicit"]) == (entry["name"], entry["type"], True) for one in node[kind]
        )
    ]
    assert not missing


def test_what_cannot_be_known_says_why(found: dict[str, Entry]) -> None:
    """Names taken from the environment or the command line each have a reason."""
    unresolved = [
        entry
        for node in found.values()
        for kind in LISTS
        for entry in node[kind]
        if entry.get("name", "") is None and not entry.get("implicit")
    ]
    assert sorted(entry["file"].rsplit("/", 1)[1] for entry in unresolved) == [
        "arm_server.cpp",
        "telemetry.py",
        "topic_logger.py",
    ]
    assert all(entry.get("reason") for entry in unresolved)


def test_every_field_is_documented(found: dict[str, Entry]) -> None:
    """Each field of a node, an interface and a parameter is documented in docs/formats.md."""
    documented = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    fields = {key for node in found.values() for key in node}
    fields |= {key for node in found.values() for kind in LISTS for entry in node[kind] for key in entry}
    assert not [field for field in sorted(fields) if f"`{field}`" not in documented]


def test_every_line_of_the_truth_exists() -> None:
    """The expected entries are current: each line they name mentions the entry."""
    for node in EXPECTED:
        for kind in LISTS:
            for entry in node[kind]:
                if "file" in entry:
                    lines = (ROOT / "examples" / "workspace" / entry["file"]).read_text(encoding="utf-8").splitlines()
                    assert 0 < entry["line"] <= len(lines), entry
                    assert lines[entry["line"] - 1].strip(), entry
