"""Tests of builds after edits: the store equals that of a clean build, and only changes are processed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st
from patience import examples
from pyoxigraph import RdfFormat

from kg.graph.reading.nodes import node_records
from kg.launch.wiring.systems import wire as wire_system
from kg.pipeline import cache, wiring
from kg.pipeline.build import build
from kg.pipeline.state import load as load_state
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.transaction import EmbeddedTransaction

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyoxigraph import NamedNode

    from kg.facts import LaunchConfiguration, System
    from kg.launch.wiring.types import NodeTypes
    from kg.pipeline.report import BuildReport

MANIFEST: Final = """<package format="3"><name>{name}</name><version>1.0.0</version><description>A test.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license><depend>rclcpp</depend>
<export><build_type>ament_cmake</build_type>{export}</export></package>"""
CMAKE: Final = "find_package(ament_cmake REQUIRED)\n{rest}ament_package()\n"
NODE: Final = """{comment}#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <pluginlib/class_loader.hpp>
#include <steps/step.hpp>
class {node} : public rclcpp::Node {{
public:
  {node}() : Node("{name}"), loader_("steps", "steps::Step") {{
    rate_ = declare_parameter<double>("rate", {rate});
    step_ = loader_.createSharedInstance(declare_parameter<std::string>("plugin", "steps::Wait"));
    publisher_ = create_publisher<std_msgs::msg::String>("{topic}", 1);
    {second}
  }}
}};
int main(int argc, char** argv) {{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<{node}>());
}}
"""
STEP: Final = """{comment}#include <steps/step.hpp>
namespace steps {{
class {name} : public Step {{
  void begin(rclcpp::Node::SharedPtr node) override {{
    heard_ = node->create_subscription<std_msgs::msg::String>("{topic}", 1, heard);
  }}
}};
}}
PLUGINLIB_EXPORT_CLASS(steps::{name}, steps::Step)
"""
LAUNCH: Final = """<launch>{comment}
  <arg name="space" default="{space}"/>
  <node pkg="nodes" exec="{name}" name="one" namespace="$(var space)"><remap from="talk" to="told"/>
    <param name="rate" value="2.0"/><param name="plugin" value="steps::Turn"/></node>
  <node pkg="others" exec="talker" name="two"/>
</launch>
"""
FIELDS: Final[dict[str, list[Any]]] = {
    "comment": ["", "// a comment\n", "/* two\n lines */\n"],
    "topic": ["talk", "told"],
    "second": [None, "heard"],
    "rate": ["1.0", "5.0"],
    "name": ["talker", "speaker"],
    "step": [None, "Turn", "Wait"],
    "others": [False, True],
    "space": ["left", "right"],
    "launch_comment": ["", "<!-- a\n comment -->"],
}


@dataclass(frozen=True, slots=True)
class Sources:
    """A workspace of packages with nodes, a plugin and a launch file, with parameters for edits."""

    comment: str = ""
    topic: str = "talk"
    second: str | None = None
    rate: str = "1.0"
    name: str = "talker"
    step: str | None = "Turn"
    others: bool = True
    space: str = "left"
    launch_comment: str = ""

    def files(self) -> Iterator[tuple[str, str]]:
        """Yield all existing files with their content."""
        for package in ("nodes", *(["others"] if self.others else [])):
            name = self.name if package == "nodes" else "talker"
            yield f"{package}/package.xml", MANIFEST.format(name=package, export="")
            yield f"{package}/CMakeLists.txt", CMAKE.format(rest=f"add_executable({name} src/node.cpp)\n")
            listen = f'heard_ = create_subscription<std_msgs::msg::String>("{self.second}", 1, heard);'
            second = listen if self.second is not None else ""
            fields = {"topic": self.topic, "rate": self.rate, "second": second, "comment": self.comment}
            yield f"{package}/src/node.cpp", NODE.format(node="Talker", name=name, **fields)
        if self.step is not None:
            yield "steps/package.xml", MANIFEST.format(name="steps", export='<steps plugin="${prefix}/plugins.xml"/>')
            yield "steps/CMakeLists.txt", CMAKE.format(rest="add_library(steps src/step.cpp)\n")
            kind = f'<class type="steps::{self.step}" base_class_type="steps::Step"/>'
            yield "steps/plugins.xml", f'<library path="steps">{kind}</library>'
            step = {"comment": self.comment, "name": self.step, "topic": self.topic}
            yield "steps/src/step.cpp", STEP.format(**step)
        for package in ("starts", "steady"):
            yield f"{package}/package.xml", MANIFEST.format(name=package, export="")
            yield f"{package}/CMakeLists.txt", CMAKE.format(rest="")
        started = LAUNCH.format(space=self.space, name=self.name, comment=self.launch_comment)
        yield "starts/launch/start.launch.xml", started
        yield "steady/launch/steady.launch.xml", '<launch><node pkg="steady" exec="none" name="none"/></launch>\n'


@dataclass(frozen=True, slots=True)
class Site:
    """A folder of sources and a store."""

    folder: Path

    def build(self, sources: Sources, store: str = "store", *, rules: bool = False) -> BuildReport:
        """Write the sources that differ, and build them into a store."""
        wanted = {self.folder / "src" / path: text for path, text in sources.files()}
        for path in [one for one in (self.folder / "src").rglob("*") if one.is_file() and one not in wanted]:
            path.unlink()
        for path, text in wanted.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            if not path.exists() or path.read_text() != text:
                path.write_text(text)
        named = [str(self.folder / "src")]
        chosen = load({"jobs": 1}, environment={})
        return build(named, EmbeddedStore.create(self.folder / store), chosen, rules=rules)

    def content(self, store: str = "store") -> list[str]:
        """Return all quads of a store, except the record of its build time."""
        with EmbeddedStore.create(self.folder / store).read() as snapshot:
            lines = snapshot.dump(RdfFormat.N_QUADS).decode().splitlines()
        return sorted(line for line in lines if not line.endswith("/graph/builds> ."))


edit = st.sampled_from(sorted(FIELDS)).flatmap(lambda field: st.tuples(st.just(field), st.sampled_from(FIELDS[field])))


@settings(max_examples=examples(2, 4), deadline=None, derandomize=True, phases=[Phase.explicit, Phase.generate])
@given(edits=st.lists(edit, min_size=2, max_size=4))
@example(edits=[("launch_comment", "<!-- a\n comment -->"), ("others", False), ("space", "right")])
def test_after_random_edits_the_store_is_that_of_a_build_from_scratch(edits: list[tuple[str, Any]]) -> None:
    """Every quad is the same, whatever edits came before."""
    with TemporaryDirectory() as folder:
        site = Site(Path(folder))
        (site.folder / "src").mkdir()
        states = list(accumulate(edits, lambda now, change: replace(now, **dict([change])), initial=Sources()))
        for state in states:
            site.build(state, rules=True)
        site.build(states[-1], "fresh", rules=True)
        assert site.content() == site.content("fresh")


@pytest.fixture
def site(tmp_path: Path) -> Site:
    """Built sources."""
    made = Site(tmp_path)
    (tmp_path / "src").mkdir()
    made.build(Sources())
    return made


@pytest.fixture
def wired(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The launch files that are wired, in order."""
    found: list[str] = []

    def wire(configuration: LaunchConfiguration, types: NodeTypes) -> System:
        found.append(configuration.path)
        return original(configuration, types)

    original = wire_system
    monkeypatch.setattr(wiring, "wire", wire)
    return found


def test_a_comment_wires_nothing(site: Site, wired: list[str]) -> None:
    """If only lines of nodes and plugins move, no system changes."""
    report = site.build(Sources(comment="// a comment\n"))
    assert report.read == 3
    assert wired == []


@pytest.mark.parametrize("changed", [{"topic": "told"}, {"rate": "5.0"}, {"step": "Wait"}, {"others": False}])
def test_only_what_starts_something_is_wired(site: Site, wired: list[str], changed: dict[str, Any]) -> None:
    """A change of a node or plugin rewires the launch files that start or load it, and no others."""
    site.build(Sources(**changed))
    assert wired == ["starts/launch/start.launch.xml"]


def test_a_launch_file_is_wired_alone(site: Site, wired: list[str]) -> None:
    """A change of a launch file rewires only that file."""
    site.build(Sources(space="right"))
    assert wired == ["starts/launch/start.launch.xml"]


@pytest.mark.parametrize("changed", [{"topic": "told"}, {"launch_comment": "<!-- a\n comment -->"}])
def test_what_other_nodes_are_started_with_is_not_read(
    site: Site, monkeypatch: pytest.MonkeyPatch, changed: dict[str, Any]
) -> None:
    """A build after an edit only queries the starts of changed systems."""
    graphs: list[str] = []

    def content(transaction: EmbeddedTransaction, graph: NamedNode) -> bytes:
        graphs.append(graph.value)
        return original(transaction, graph)

    original = EmbeddedTransaction.content
    monkeypatch.setattr(EmbeddedTransaction, "content", content)
    site.build(Sources(**changed))
    assert any("/graph/launch/" in graph for graph in graphs)
    assert not any(graph.endswith("/graph/starts") for graph in graphs)


def test_node_types_are_those_of_the_graph(site: Site) -> None:
    """Wiring gets the same node types from cached results as from the graph, with the same IRIs."""
    store = EmbeddedStore.create(site.folder / "store")
    sources = load_state(store.layout.cache).sources.values()
    results = [package.result for source in sources for package in source.packages.values()]
    found = {one.iri: one for result in results for one in cache.nodes(store.layout.cache, result)}
    with store.read() as snapshot:
        records = {one.iri: one for one in node_records(snapshot)}
    assert len(found) == 3
    assert found.keys() == records.keys()
    for iri, record in records.items():
        node = found[iri].node
        assert (node.name, node.plugin, node.executable) == (
            record.node.name,
            record.node.plugin,
            record.node.executable,
        )
        assert (node.interfaces, node.parameters) == (record.node.interfaces, record.node.parameters)
        assert dict(zip(node.interfaces, found[iri].ends, strict=True)) == record.ends
        assert dict(zip(node.parameters, found[iri].settable, strict=True)) == record.settable
