"""Effects of changes in a small workspace: each file of `cases` has a name as typed, and the response of the view.

`KG_WRITE_EXPECTED=1` rewrites the expected responses; the difference shows the changes.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from kg.errors import UnknownNameError, UsageError
from kg.graph.reading.impact import arguments, definition_records, file_records
from kg.graph.reading.nodes import node_records
from kg.graph.reading.systems import started_names, systems
from kg.impact.assessing import impact as assess
from kg.impact.model import Kind, Subject
from kg.pipeline.build import build
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.views.impact import impact
from kg.views.impact_world import StoredWorld
from kg.views.systems import configuration_names

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.facts import System
    from kg.graph.reading.nodes import NodeRecord
    from kg.impact.model import DefinitionRecord, FileRecord
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

HERE = Path(__file__).parent
CASES = sorted((HERE / "cases").glob("*.json"))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> EmbeddedStore:
    """Return the store of the workspace."""
    root = tmp_path_factory.mktemp("impact")
    shutil.copytree(HERE / "cases" / "workspace", root / "harbour")
    found = EmbeddedStore.create(root / ".kg")
    build([str(root / "harbour")], found, settings())
    return found


def settings() -> Settings:
    """Return the default settings."""
    return load({}, environment={})


def asked(store: EmbeddedStore, name: str, kind: str = "") -> dict[str, Any]:
    """Return the response of the view."""
    with store.read() as snapshot:
        return impact(snapshot, settings(), name=name, kind=kind)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_answer(store: EmbeddedStore, path: Path) -> None:
    """Each effect has its grade, its reason and its line."""
    case = json.loads(path.read_text())
    found = asked(store, case["asked"], case.get("as", ""))
    if os.environ.get("KG_WRITE_EXPECTED"):
        path.write_text(json.dumps({**case, "answer": found}, indent=1) + "\n")
    assert found == case["answer"]


def test_what_means_several_things_gets_a_command_for_each(store: EmbeddedStore) -> None:
    """`limit` is a parameter of the hoist and an argument of its launch file."""
    with pytest.raises(UsageError) as raised:
        asked(store, "limit")
    assert raised.value.hint == "`kg impact limit --kind parameter`\n`kg impact limit --kind argument`"


def test_an_unknown_name_gets_those_that_were_meant(store: EmbeddedStore) -> None:
    """An unknown name gets suggestions, also within one kind."""
    with pytest.raises(UnknownNameError) as raised:
        asked(store, "crane_msgs/Laod", "type")
    assert "`crane_msgs/Load`" in (raised.value.hint or "")
    with pytest.raises(UsageError, match="unknown kind `topics`"):
        asked(store, "lift", "topics")


class WholeWorld(StoredWorld):
    """A world with complete systems, and all node types, definitions and files for any subject."""

    def __init__(self, snapshot: EmbeddedSnapshot) -> None:
        super().__init__(snapshot, settings())
        self._every_system = systems(snapshot, configuration_names(snapshot), settings().base)
        self._every_node = node_records(snapshot)
        self._every_definition = definition_records(snapshot)
        self._every_file = [*file_records(snapshot), *self.own]

    def systems(self, subject: Subject) -> Sequence[System]:
        """Return the complete systems of a subject."""
        if subject.kind is Kind.ARGUMENT or (subject.kind is Kind.PARAMETER and not subject.owner):
            return self._every_system
        meant = {one.configuration.path for one in super().systems(subject)}
        return [one for one in self._every_system if one.configuration.path in meant]

    def nodes(self, _subject: Subject) -> Sequence[NodeRecord]:
        """Return all node types."""
        return self._every_node

    def definitions(self, _subject: Subject) -> Sequence[DefinitionRecord]:
        """Return all definitions."""
        return self._every_definition

    def files_at(self, path: str) -> Sequence[FileRecord]:
        """Return the files of a path."""
        return [one for one in self._every_file if one.path == path]


def subjects(snapshot: EmbeddedSnapshot, world: StoredWorld) -> Iterator[Subject]:
    """Yield all names of the workspace."""
    yield from (Subject(Kind(kind), name) for kind, names in world.channels.items() for name in names)
    yield from (Subject(Kind.ARGUMENT, name, launch) for name, launch in arguments(snapshot))
    yield from (Subject(Kind.FILE, one.path, one.repository) for one in world.files)
    for one in definition_records(snapshot):
        yield Subject(Kind.TYPE, one.name)
        yield from (Subject(Kind.FIELD, field.name, one.name) for field in one.definition.fields)
    for record in node_records(snapshot):
        owner = f"{record.package}/{record.node.name}"
        started = [name for name in started_names(snapshot) if name.endswith(f"/{record.node.name}")]
        yield from (Subject(Kind.NODE, name) for name in (owner, *started))
        inner = {one.name for one in record.node.parameters if one.name}
        yield from (Subject(Kind.PARAMETER, name, each) for name in inner for each in ("", owner, *started))


def test_the_parts_of_systems_that_are_read_suffice(store: EmbeddedStore) -> None:
    """Complete systems, and the whole store, give the same effects of each subject."""
    with store.read() as snapshot:
        world, whole = StoredWorld(snapshot, settings()), WholeWorld(snapshot)
        asked = sorted(set(subjects(snapshot, world)))
        assert {one.kind for one in asked} >= {*Kind} - {Kind.ACTION}
        assert [assess(one, world) for one in asked] == [assess(one, whole) for one in asked]


PACKAGE = """<package format="3"><name>yard</name><version>1.0.0</version><description>d</description>
<maintainer email="a@b.c">m</maintainer><license>MIT</license></package>"""
GATE = """import rclpy
from nav2_msgs.action import Spin
from rclpy.action import ActionServer
from rclpy.node import Node


class Gate(Node):
    def __init__(self):
        super().__init__("gate")
        ActionServer(self, Spin, "turn", print)


def main():
    rclpy.init()
    rclpy.spin(Gate())
"""
FILES = {
    "package.xml": PACKAGE,
    "setup.py": 'from setuptools import setup\nsetup(name="yard", packages=["yard"], '
    'entry_points={"console_scripts": ["gate = yard.gate:main"]})\n',
    "yard/__init__.py": "",
    "yard/gate.py": GATE,
    "launch/yard.launch.xml": '<launch><node pkg="yard" exec="gate" name="gate" namespace="north"/></launch>',
}


def test_an_action_that_only_a_launched_system_has_is_found(tmp_path: Path) -> None:
    """No node that is started alone has the namespace in its names."""
    for path, text in FILES.items():
        file = tmp_path / "yard" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    store = EmbeddedStore.create(tmp_path / ".kg")
    build([str(tmp_path / "yard")], store, settings())
    found = asked(store, "/north/turn")
    assert (found["kind"], found["about"]) == ("action", ["nav2_msgs/Spin"])
    assert [one["what"] for one in found["effects"]] == ["/north/gate offers it"]
