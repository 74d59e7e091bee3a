"""Tests of systems inside builds: after any edit they equal those of a clean build."""

from __future__ import annotations

import os
import shutil
import signal
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, RdfFormat

from kg.launch.wiring.systems import wire
from kg.pipeline import systems, wiring
from kg.pipeline.build import build
from kg.pipeline.forgetting import forget
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kg.facts import LaunchConfiguration, System
    from kg.graph.iris import Iris
    from kg.launch.wiring.types import NodeTypes
    from kg.pipeline.catalogue import Catalogue
    from kg.pipeline.report import BuildReport
    from kg.pipeline.wiring import Wired
    from kg.settings import Settings

MANIFEST = """<package format="2"><name>{name}</name><version>1.0.0</version><description>A test.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license><depend>roscpp</depend></package>"""
CMAKE = "project({name})\nfind_package(catkin REQUIRED roscpp)\nadd_executable(talker src/talker.cpp)\n"
NODE = """#include <ros/ros.h>
#include <std_msgs/String.h>
int main(int argc, char** argv) {{
  ros::init(argc, argv, "talker");
  ros::NodeHandle handle, own("~");
  std::string topic;
  own.param<std::string>("topic", topic, "{topic}");
  ros::Publisher publisher = handle.advertise<std_msgs::String>(topic, 1);
  ros::Subscriber subscriber = handle.subscribe("{heard}", 1, heard);
}}
"""
LAUNCH = """<launch>
  <node pkg="nodes" type="talker" name="{name}" ns="{name}"><rosparam file="$(find config)/config/p.yaml"/></node>
  <include file="$(find other)/launch/inner.launch"/>
  <include file="$(find config)/launch/missing.launch"/>
</launch>
"""
INNER = '<launch><node pkg="nodes" type="talker" name="{name}"><remap from="{heard}" to="scan"/></node></launch>\n'


def settings(jobs: int = 1) -> Settings:
    """Return settings of one process, or of several."""
    return load({"jobs": jobs}, environment={})


@dataclass(frozen=True, slots=True)
class Site:
    """Two sources, `one` and `two`, in a folder, and a store."""

    folder: Path
    store: EmbeddedStore

    def write(self, path: str, text: str) -> None:
        """Write a file in the folder."""
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(text)

    def package(self, path: str, *, topic: str | None = None, heard: str = "talk") -> None:
        """Write a package, with a node if it has a topic."""
        name = path.rpartition("/")[2]
        self.write(f"{path}/package.xml", MANIFEST.format(name=name))
        self.write(f"{path}/CMakeLists.txt", CMAKE.format(name=name) if topic else f"project({name})\n")
        if topic:
            self.write(f"{path}/src/talker.cpp", NODE.format(topic=topic, heard=heard))

    def fill(self) -> None:
        """Write the initial files of both sources."""
        self.package("one/nodes", topic="talk")
        self.package("one/starts")
        self.write("one/starts/launch/a.launch", LAUNCH.format(name="a"))
        self.write("one/starts/launch/b.launch", LAUNCH.format(name="b"))
        self.package("two/config")
        self.write("two/config/config/p.yaml", "topic: talk\n")
        self.package("two/other")
        self.write("two/other/launch/inner.launch", INNER.format(name="inner", heard="talk"))

    def sources(self) -> list[str]:
        """Return the existing sources."""
        return [str(self.folder / name) for name in ("one", "two") if (self.folder / name).is_dir()]

    def build(self, store: EmbeddedStore | None = None, *, rules: bool = False, jobs: int = 1) -> BuildReport:
        """Build all sources into the store or another one."""
        return build(self.sources(), store or self.store, settings(jobs), rules=rules)

    def content(self, store: EmbeddedStore | None = None) -> dict[str, list[str]]:
        """Return the triples of the graphs of launch files, and the inferred ones."""
        with (store or self.store).read() as snapshot:
            graphs = [graph for graph in snapshot.graphs() if "/graph/launch/" in str(graph)]
            return {
                graph.value: sorted(snapshot.dump(RdfFormat.N_TRIPLES, graph=graph).decode().splitlines())
                for graph in (*graphs, NamedNode("https://w3id.org/rnkg/graph/inferred"))
            }

    def anew(self) -> dict[str, list[str]]:
        """Return the result of a clean build by two processes."""
        shutil.rmtree(self.folder / "fresh", ignore_errors=True)
        store = EmbeddedStore.create(self.folder / "fresh")
        self.build(store, rules=True, jobs=2)
        return self.content(store)

    def launches(self) -> str:
        """Return all output about launch files."""
        return "\n".join(line for lines in self.content().values() for line in lines)


def different(found: dict[str, list[str]], wanted: dict[str, list[str]]) -> list[str]:
    """Return the differences between two contents: unexpected and missing triples."""
    lines = {
        content: {f"{graph} {line}" for graph, held in content_.items() for line in held}
        for content, content_ in (("+", found), ("-", wanted))
    }
    return sorted(f"+ {line}" for line in lines["+"] - lines["-"]) + sorted(
        f"- {line}" for line in lines["-"] - lines["+"]
    )


@pytest.fixture
def site(tmp_path: Path) -> Site:
    """Two sources that are built."""
    made = Site(tmp_path, EmbeddedStore.create(tmp_path / ".kg"))
    made.fill()
    made.build()
    return made


def _gone(path: str) -> Callable[[Site], None]:
    def edit(site: Site) -> None:
        target = site.folder / path
        if target.is_dir():
            shutil.rmtree(target)
        else:
            target.unlink(missing_ok=True)

    return edit


def _nodes(topic: str, heard: str) -> Callable[[Site], None]:
    return lambda site: site.package("one/nodes", topic=topic, heard=heard)


def _text(path: str, text: str) -> Callable[[Site], None]:
    return lambda site: site.write(path, text)


def _package(path: str, topic: str | None = None) -> Callable[[Site], None]:
    return lambda site: site.package(path, topic=topic)


EDITS: dict[str, Callable[[Site], None]] = {
    "topic renamed": _nodes("talks", "talk"),
    "heard renamed": _nodes("talk", "scam"),
    "parameter misspelt": _text("two/config/config/p.yaml", "topik: /else\n"),
    "parameter file gone": _gone("two/config/config/p.yaml"),
    "included file changed": _text("two/other/launch/inner.launch", INNER.format(name="changed", heard="scam")),
    "included file gone": _gone("two/other/launch/inner.launch"),
    "missing file appears": _text("two/config/launch/missing.launch", INNER.format(name="found", heard="talk")),
    "launch file gone": _gone("one/starts/launch/b.launch"),
    "nodes gone": _gone("one/nodes"),
    "second package of the name": _package("two/nodes", "second"),
    "package of included files gone": _gone("two/other"),
    "package of included files again": _package("two/other"),
}


WALKS = (
    ("topic renamed", "missing file appears", "included file changed", "parameter misspelt"),
    ("second package of the name", "included file gone", "launch file gone", "nodes gone"),
    ("package of included files gone", "parameter file gone", "package of included files again", "heard renamed"),
)


@pytest.mark.parametrize("walk", WALKS)
def test_after_edits_systems_are_those_of_a_build_from_scratch(site: Site, walk: tuple[str, ...]) -> None:
    """The graphs of launch files, and the inferences, are the same to the byte, whatever edits came before."""
    for name in walk:
        EDITS[name](site)
        site.build(rules=True)
    assert not different(site.content(), site.anew())


def test_a_forgotten_source_leaves_instances_without_type(site: Site) -> None:
    """After removing the source of node types, instances of other sources have no type."""
    assert "other/launch/inner.launch#instance/inner/publisher/scan" in site.launches()
    forget(site.store, settings(), ["local/one"])
    assert "other/launch/inner.launch#instance/inner" in site.launches()
    assert "inner.launch#instance/inner/publisher/scan" not in site.launches()
    assert "/starts/launch/" not in site.launches()


def test_a_file_that_no_scan_lists(site: Site) -> None:
    """A parameter file with another suffix is read again when it changes."""
    site.write("one/starts/launch/a.launch", LAUNCH.format(name="a").replace("p.yaml", "p.settings"))
    site.write("two/config/config/p.settings", "topic: before\n")
    site.build()
    assert "/before>" in site.launches()
    site.write("two/config/config/p.settings", "topic: afterwards\n")
    site.build()
    assert "/afterwards>" in site.launches()


def test_launch_files_outside_of_packages_are_read(site: Site) -> None:
    """Build files next to them belong to no package: the programs that they name are not read again."""
    site.write("one/all.launch", INNER.format(name="outside", heard="talk"))
    site.write("one/CMakeLists.txt", "find_package(catkin)\nadd_executable(again nodes/src/talker.cpp)\n")
    site.write("one/setup.py", "setup(entry_points={'console_scripts': ['twice = nodes.talker:main']})\n")
    report = site.build()
    assert "all.launch#instance/outside/publisher/scan" in site.launches()
    assert [source.total("nodes") for source in report.sources] == [1, 0]


def test_what_others_wrote_meanwhile_does_not_stay(site: Site) -> None:
    """A graph of a launch file changed since the last build is written again; unknown ones are removed."""
    before = site.content()
    iri = "https://w3id.org/rnkg/graph/launch/local/one/-/"
    with site.store.write("test") as transaction:
        transaction.append(NamedNode(f"{iri}starts/launch/a.launch"), b"<urn:a> <urn:b> <urn:c> .\n")
        transaction.append(NamedNode(f"{iri}starts/launch/unknown.launch"), b"<urn:a> <urn:b> <urn:c> .\n")
    site.build()
    assert not different(site.content(), before)


def test_other_code_wires_again(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    """With another version of kg all systems are wired again, even if packages have the same results."""
    monkeypatch.setattr("kg.pipeline.build.version", lambda *_: "another")
    monkeypatch.setattr("kg.pipeline.wiring.system_triples", lambda *_: b"<urn:a> <urn:b> <urn:c> .\n")
    site.build()
    launches = {graph: lines for graph, lines in site.content().items() if "/graph/launch/" in graph}
    assert launches
    assert all(lines == ["<urn:a> <urn:b> <urn:c> ."] for lines in launches.values())


def test_a_launch_file_that_kg_trips_over_costs_the_others_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A defect in the wiring of one launch file is reported with it; the others are wired."""

    def fails(configuration: LaunchConfiguration, types: NodeTypes) -> System:
        if configuration.path.endswith("inner.launch"):
            raise KeyError("x")
        return wire(configuration, types)

    monkeypatch.setattr(wiring, "wire", fails)
    site = Site(tmp_path, EmbeddedStore.create(tmp_path / ".kg"))
    site.fill()
    report = site.build()
    assert report.systems is not None
    (failed,) = report.systems.failed
    assert "other/launch/inner.launch: its nodes could not be wired: KeyError: 'x' (test_systems.py:" in failed
    assert failed.partition(": ")[2] in site.launches()
    assert (report.systems.configurations, report.systems.instances) == (3, 4)


def test_a_worker_that_dies_while_it_wires_costs_nothing(
    site: Site, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its launch files are wired by the process that writes."""
    here, usual = os.getpid(), wiring.wired

    def dies(configuration: LaunchConfiguration, catalogue: Catalogue, iris: Iris) -> Wired:
        if os.getpid() != here and configuration.path.endswith("a.launch"):
            (tmp_path / "died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return usual(configuration, catalogue, iris)

    for module in (wiring, systems):
        monkeypatch.setattr(module, "wired", dies)
    store = EmbeddedStore.create(tmp_path / "again")
    site.build(store, jobs=2)
    assert (tmp_path / "died").exists()
    assert not different(site.content(store), site.content())
