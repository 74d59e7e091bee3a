from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from extract.workspaces import codes, manifest, written

from kg.corpus.reading import Reader
from kg.extract import cpp, python
from kg.extract.marks import Extracted
from kg.extract.package import extract_package
from kg.facts import Interface, Location, NodeKind, NodeType, Resolution, Role

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

    from kg.facts import PackageFacts

NODE = NodeType("a", NodeKind.EXECUTABLE, "cpp", 1, Location("demo/src/a.cpp", 1), executable="a")
SCAN = Interface(Role.SUBSCRIBES, "scan", "sensor_msgs/LaserScan", Resolution.LITERAL, Location("demo/src/a.cpp", 3))


def extract(root: Path, files: dict[str, str | bytes]) -> PackageFacts:
    """Return the facts of the package `demo` with these files."""
    workspace = written(root, {"demo/package.xml": manifest("demo"), **files})
    found = workspace.package("demo")
    assert found is not None
    return extract_package(Reader(workspace, *workspace.folder(found)))


def test_everything_of_a_package_is_in_its_facts(tmp_path: Path) -> None:
    """One value has the manifest, definitions, files with digests and inputs of a package."""
    facts = extract(tmp_path, {"demo/msg/B.msg": "bool b\n", "demo/msg/A.msg": "bool a\n", "demo/README.md": "hi"})
    assert facts.package.name == "demo"
    assert [definition.name for definition in facts.definitions] == ["A", "B"]
    assert [file.path for file in facts.files] == sorted(file.path for file in facts.files)
    assert {"demo/README.md", "demo/msg/A.msg", "demo/package.xml"} <= {file.path for file in facts.files}
    assert {(f"{facts.repository}:{file.path}", file.digest) for file in facts.files} <= set(facts.inputs)


def test_a_defect_in_one_reader_costs_only_its_facts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A defect in one reader is a problem KG121 with its place; the facts of other readers remain."""

    def fails(*_: object) -> list[Extracted]:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr(cpp, "read_nodes", fails)
    monkeypatch.setattr(python, "read_nodes", lambda *_: [Extracted(replace(NODE, language="python"))])
    facts = extract(tmp_path, {"demo/msg/A.msg": "bool a\n"})
    assert [code for code, _ in codes(facts.problems)] == ["KG121"]
    assert "ZeroDivisionError: oops (test_package.py:" in facts.problems[0].message
    assert [node.language for node in facts.nodes] == ["python"]
    assert len(facts.definitions) == 1


def test_nodes_come_complete_merged_and_resolved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A node read twice is one, with implicit interfaces added and every name resolved."""
    twice = [Extracted(NODE), Extracted(replace(NODE, interfaces=(SCAN,)))]
    monkeypatch.setattr(cpp, "read_nodes", lambda *_: twice)
    monkeypatch.setattr(python, "read_nodes", lambda *_: [])
    (node,) = extract(tmp_path, {}).nodes
    explicit = [interface for interface in node.interfaces if not interface.implicit]
    assert [interface.resolved for interface in explicit] == ["/scan"]
    assert all(interface.resolved for interface in node.interfaces)
    assert "/rosout" in {interface.name for interface in node.interfaces}


def test_extraction_is_a_function_of_the_files(tmp_path: Path) -> None:
    """The same files give equal facts, regardless of their location and order."""
    files: dict[str, str | bytes] = {
        "demo/msg/A.msg": "bool a\n",
        "demo/srv/B.srv": "---\n",
        "demo/src/a.cpp": "int a;",
    }
    one = extract(tmp_path / "x", files)
    other = extract(tmp_path / "y" / "x", dict(reversed(files.items())))
    assert one == other


def test_a_node_has_the_names_that_build_files_know_it_by(tmp_path: Path) -> None:
    """The target of an output name, and a library with a single plugin, are aliases of the node."""
    files: dict[str, str | bytes] = {
        "demo/CMakeLists.txt": "add_executable(demo_talk a.cpp)\n"
        "set_target_properties(demo_talk PROPERTIES OUTPUT_NAME talk)\n",
        "demo/a.cpp": '#include <ros/ros.h>\nint main(int c, char** v) { ros::init(c, v, "t"); ros::NodeHandle n; }\n',
    }
    (node,) = extract(tmp_path, files).nodes
    assert (node.name, node.executable, node.aliases) == ("talk", "talk", ("demo_talk",))
