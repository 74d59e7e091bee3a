"""Tests that the result of a package depends only on its files and look-ups, whatever its process has read before."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final, NamedTuple

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from pyoxigraph import RdfFormat

from kg.corpus.workspace import scan_tree
from kg.graph.vocabulary import PREFIXES
from kg.pipeline import inferring, pool, seed, writing
from kg.pipeline.build import build
from kg.pipeline.estimating import pending
from kg.pipeline.recording import RecordingWorkspace
from kg.pipeline.report import Report
from kg.pipeline.state import load as load_state
from kg.pipeline.work import Job, Outcome, work
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.pipeline.recording import Lookup
    from kg.pipeline.report import PackageResult
    from kg.settings import Settings

LIMIT: Final = 3_000
PACKAGES: Final = ("lib", "first", "second", "script", "plugins", "start")


def manifest(name: str, depends: Sequence[str] = ()) -> str:
    """Return the package.xml of a package."""
    needed = "".join(f"<depend>{one}</depend>" for one in ("rclcpp", *depends))
    return (
        f'<package format="3"><name>{name}</name><version>1.0.0</version><description>Drives the {name} robot arm.'
        f"</description><license>MIT</license>{needed}<export><build_type>ament_cmake</build_type></export></package>"
    )


def macro(source: str) -> str:
    """Return CMake code with a macro that adds a node for a source."""
    return f"macro(add_robot_node name)\n  add_executable(${{name}}_node {source})\nendmacro()\n"


def node(name: str, topic: str) -> str:
    """Return a C++ node that uses the header, the base class and the messages of another package."""
    return f"""#include <rclcpp/rclcpp.hpp>
#include <lib/topics.hpp>
#include <lib/base.hpp>
#include <lib/msg/state.hpp>
class {name} : public lib::Base {{
public:
  {name}() : Base("{name}") {{
    own_ = create_publisher<lib::msg::State>({topic}, 1);
    prepare();
    acme::make_publisher<lib::msg::State>(this, "described");
  }}
  rclcpp::Publisher<lib::msg::State>::SharedPtr own_;
}};
int main(int argc, char** argv) {{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<{name}>());
}}
"""


BASE: Final = """#pragma once
#include <rclcpp/rclcpp.hpp>
#include <lib/msg/state.hpp>
namespace lib {
class Base : public rclcpp::Node {
public:
  explicit Base(const std::string& name);
  void prepare();
  rclcpp::Publisher<lib::msg::State>::SharedPtr state_;
};
}
"""
PREPARE: Final = """#include <lib/base.hpp>
namespace lib {{
void Base::prepare() {{ state_ = create_publisher<lib::msg::State>("{topic}", 1); }}
}}
"""
SCRIPT: Final = """#!/usr/bin/env python3
import rclpy
from lib.names import TOPIC
from lib.msg import State
def main():
    rclpy.init()
    node = rclpy.create_node("script")
    node.create_publisher(State, TOPIC, 1)
    node.create_publisher(State, "{topic}", 1)
    rclpy.spin(node)
main()
"""
PLUGIN: Final = """#include <rclcpp/rclcpp.hpp>
#include <lib/topics.hpp>
namespace plugins {
class Filter : public rclcpp::Node {
public:
  explicit Filter(const rclcpp::NodeOptions& options) : Node("filter", options) {
    create_subscription<lib::msg::State>(TOPIC, 1, [](lib::msg::State::SharedPtr) {});
  }
};
}
#include <rclcpp_components/register_node_macro.hpp>
RCLCPP_COMPONENTS_REGISTER_NODE(plugins::Filter)
"""
PLUGINS: Final = (
    '<library path="filter"><class type="plugins::{name}" base_class_type="plugins::Base">'
    "<description>Filters the states of a robot.</description></class></library>"
)
LAUNCH: Final = """<launch>
  <node pkg="first" exec="first_node"><param from="$(find-pkg-share lib)/config/arm.params"/></node>
  <include file="$(find-pkg-share lib)/launch/part.launch.xml"/>
  <node pkg="{package}" exec="script.py"/>
</launch>
"""
PART: Final = '<launch><node pkg="second" exec="second_node"><remap from="state" to="{topic}"/></node></launch>'
PYTHON_LAUNCH: Final = """from launch import LaunchDescription
from launch_ros.actions import Node
from shared import NAME
def generate_launch_description():
    return LaunchDescription([Node(package="first", executable="first_node", name=NAME)])
"""
PARAMETERS: Final = "first:\n  ros__parameters:\n    rate: {rate}\n"
CALLS: Final = """ros = 2
[[call]]
in = ["acme"]
name = "make_publisher"
arguments = [2, 2]
node = 0
{role} = {{ name = 1, type = ["template"] }}
"""
CMAKE: Final = "project({name})\nfind_package(lib REQUIRED)\nadd_robot_node({name})\nadd_other_node({name})\n"

FILES: Final[dict[str, tuple[str | None, ...]]] = {
    "README.md": (None, "# Robots\n\n## plugins\n\nThe `second_node` drives the arm over rough ground.\n"),
    "lib/package.xml": (manifest("lib"),),
    "lib/CMakeLists.txt": ("project(lib)\nadd_library(lib src/base.cpp)\n",),
    "lib/cmake/lib.cmake": (None, macro("src/node.cpp"), macro("src/other.cpp")),
    "lib/cmake/more.cmake": (None, macro("src/node.cpp").replace("robot", "other")),
    "lib/include/lib/topics.hpp": (None, '#define TOPIC "one"\n', '#define TOPIC "two"\n'),
    "lib/include/lib/base.hpp": (BASE, None, BASE.replace("void prepare();", "void prepare() {}")),
    "lib/src/base.cpp": (PREPARE.format(topic="state"), None),
    "lib/src/more.cpp": (None, PREPARE.format(topic="more")),
    "lib/msg/State.msg": ("string name\n", None, "string name\nint32 number\n"),
    "lib/lib/__init__.py": ("", None),
    "lib/lib/names.py": ('TOPIC = "named"\n', None, 'TOPIC = "renamed"\n'),
    "lib/include/package.xml": (None, manifest("roscpp")),
    "lib/config/arm.params": (None, PARAMETERS.format(rate=1), PARAMETERS.format(rate=2)),
    "lib/launch/part.launch.xml": (PART.format(topic="a"), None, PART.format(topic="b")),
    "first/package.xml": (manifest("first", ["lib"]), manifest("first")),
    "first/CMakeLists.txt": (CMAKE.format(name="first"),),
    "first/src/node.cpp": (node("First", "TOPIC"), node("First", '"own"')),
    "first/src/other.cpp": (None, node("Other", '"other"')),
    "first/config/large.yaml": (None, "a" * (LIMIT + 1), "a" * (LIMIT + 2), "a: 1\n"),
    "second/package.xml": (manifest("second", ["lib"]),),
    "second/CMakeLists.txt": (CMAKE.format(name="second"),),
    "second/src/node.cpp": (node("Second", "TOPIC"), node("Second", '"two"')),
    "second/include/lib/topics.hpp": (None, '#define TOPIC "nearer"\n'),
    "second/README.md": (
        None,
        "# second\n\nThe second node drives an arm.\n\n## lib\n\nThe lib node is a robot.\n",
    ),
    "script/package.xml": (manifest("script", ["lib"]),),
    "script/CMakeLists.txt": ("project(script)\ninstall(PROGRAMS scripts/script.py DESTINATION lib/script)\n",),
    "script/scripts/script.py": (SCRIPT.format(topic="plain"), SCRIPT.format(topic="other")),
    "plugins/package.xml": (manifest("plugins", ["lib"]),),
    "plugins/CMakeLists.txt": ("project(plugins)\nadd_library(filter SHARED src/filter.cpp)\n",),
    "plugins/plugins.xml": (PLUGINS.format(name="Filter"), None, PLUGINS.format(name="Other")),
    "plugins/src/filter.cpp": (PLUGIN,),
    "start/package.xml": (manifest("start", ["lib", "first"]),),
    "start/launch/all.launch.xml": (LAUNCH.format(package="script"), LAUNCH.format(package="none")),
    "start/launch/one.launch.py": (PYTHON_LAUNCH, None),
    "start/launch/shared.py": (None, 'NAME = "a"\n', 'NAME = "b"\n'),
    "../calls/acme.toml": (None, CALLS.format(role="publishes"), CALLS.format(role="subscribes")),
}
"""Each file of the workspace with its possible contents; the first is the usual one."""


@dataclass(frozen=True)
class Site:
    """A workspace in a folder."""

    folder: Path

    @property
    def sources(self) -> Path:
        """The folder of the packages."""
        return self.folder / "src"

    def write(self, contents: Mapping[str, str | None], absent: frozenset[str]) -> None:
        """Write these contents to the files; packages in `absent` do not exist."""
        for path, content in contents.items():
            file = self.sources / path
            wanted = None if path.partition("/")[0] in absent else content
            if wanted is None:
                file.unlink(missing_ok=True)
            elif not file.exists() or file.read_text() != wanted:
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(wanted)
        for package in absent:
            shutil.rmtree(self.sources / package, ignore_errors=True)

    def build(self, store: EmbeddedStore, jobs: int, report: Report | None = None) -> None:
        """Build the workspace."""
        build([str(self.sources)], store, self.settings(jobs), report, rules=False)

    def settings(self, jobs: int) -> Settings:
        """Return the settings of a build with this number of workers."""
        calls = self.folder / "calls"
        calls.mkdir(exist_ok=True)
        installed = [str(self.folder / "installed")]
        options = {"jobs": jobs, "max_file_bytes": LIMIT, "installed": installed, "calls": [str(calls)]}
        return load(options, environment={}, folder=self.folder)


def results(store: EmbeddedStore) -> dict[str, object]:
    """Return for each package in a store its inputs, its look-ups outside of the build, the digest of its result.

    The digest covers look-ups, triples, descriptions and launch configurations.
    """
    (source,) = load_state(store.layout.cache).sources.values()
    return {path: (one.inputs, one.outside, one.result, one.problems) for path, one in source.packages.items()}


def exported(store: EmbeddedStore) -> dict[str, bytes]:
    """Return the graphs of sources, of their shared content and of launch files as in `kg export`."""
    with store.read() as snapshot:
        graphs = [one for one in snapshot.graphs() if "/graph/s" in one.value or "/graph/launch/" in one.value]
        return {one.value: snapshot.dump(RdfFormat.N_QUADS, graph=one, prefixes=PREFIXES) for one in graphs}


class Killing(Report):
    """Stops a build after the first package."""

    def done(self, result: PackageResult) -> None:  # noqa: ARG002 - the report of a build
        """Stop the build."""
        raise KeyboardInterrupt


class Step(NamedTuple):
    """Edits of files, absent packages, and the manner of the next build."""

    edits: Mapping[str, int] = {}
    absent: frozenset[str] = frozenset()
    jobs: int = 2
    killed: str = ""


def contents(variants: Mapping[str, int]) -> dict[str, str | None]:
    """Return the contents of all files: those chosen, else the usual ones."""
    return {path: FILES[path][variants.get(path, 0)] for path in FILES}


@pytest.fixture(autouse=True)
def _no_ontology(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the ontologies, which are not compared and take most of the time."""
    monkeypatch.setattr(seed, "load", lambda _: None)
    monkeypatch.setattr(inferring, "_in_force", lambda *_: b"")


def _dying(job: Job, source: str, path: str, earlier: str = "") -> Outcome:
    """Kill the process that reads one package."""
    if path == os.environ["KG_TEST_KILLED"]:
        os.kill(os.getpid(), signal.SIGKILL)
    return work(job, source, path, earlier)


def _variants() -> st.SearchStrategy[dict[str, int]]:
    numbers = {path: st.integers(0, len(known) - 1) for path, known in FILES.items() if len(known) > 1}
    return st.fixed_dictionaries({}, optional=numbers)


NODES: Final = {"lib/cmake/lib.cmake": 1}
"""Edits that result in C++ nodes."""
ABSENT: Final = st.sets(st.sampled_from(PACKAGES), max_size=2).map(frozenset)
KILLED: Final = st.sampled_from(["", "", "the build", *PACKAGES])
STEPS: Final = st.lists(st.builds(Step, _variants(), ABSENT, st.integers(1, 3), KILLED), min_size=2, max_size=3)


@settings(max_examples=4, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(steps=STEPS)
def test_a_build_after_edits_is_a_clean_one(steps: list[Step]) -> None:
    """After any edits, additions, removals and kills, with any number of workers, the bytes are the same."""
    variants: dict[str, int] = {}
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        site, store = Site(Path(folder)), EmbeddedStore.create(Path(folder, "kept"))
        patch.setattr(pool, "work", _dying)
        patch.setattr(writing, "_SMALL", 1)  # to patch graphs of small workspaces too
        for step in steps:
            variants |= step.edits
            site.write(contents(variants), step.absent)
            patch.setenv("KG_TEST_KILLED", step.killed)
            with suppress(KeyboardInterrupt):
                site.build(store, step.jobs, Killing() if step.killed == "the build" else None)
        patch.setenv("KG_TEST_KILLED", "")
        site.build(store, 2)
        clean = EmbeddedStore.create(Path(folder, "clean"))
        site.build(clean, 1)
        assert results(store) == results(clean)
        assert exported(store) == exported(clean)


@pytest.mark.parametrize(
    ("package", "before", "after"),
    [
        ("first", Step(NODES, frozenset({"lib"})), Step()),
        ("second", Step(NODES), Step({"lib/cmake/more.cmake": 1})),
        ("first", Step({**NODES, "lib/src/base.cpp": 1}), Step({"lib/src/more.cpp": 1})),
        ("plugins", Step({"lib/include/lib/topics.hpp": 1}), Step({"lib/include/package.xml": 1})),
        ("first", Step({"first/config/large.yaml": 2}), Step({"first/config/large.yaml": 3})),
        ("first", Step({"first/config/large.yaml": 1}), Step({"first/config/large.yaml": 2})),
        ("start", Step({"lib/config/arm.params": 0}), Step({"lib/config/arm.params": 1})),
        ("start", Step({"start/launch/shared.py": 0}), Step({"start/launch/shared.py": 1})),
        ("script", Step({"lib/lib/names.py": 1}), Step({"lib/lib/names.py": 2})),
        ("plugins", Step({"lib/include/lib/topics.hpp": 0}), Step({"lib/include/lib/topics.hpp": 1})),
        ("second", Step({**NODES, "README.md": 1}, frozenset({"plugins"})), Step()),
        ("second", Step(NODES), Step({"../calls/acme.toml": 1})),
        ("second", Step({**NODES, "../calls/acme.toml": 1}), Step({"../calls/acme.toml": 2})),
    ],
    ids=[
        "package with a macro",
        "file with a macro",
        "implementation",
        "owner",
        "file no longer too large",
        "size of a file too large",
        "file that no scan lists",
        "module of a launch file",
        "module",
        "header",
        "neighbour",
        "description of calls",
        "changed description of calls",
    ],
)
def test_what_appears_is_noticed(tmp_path: Path, package: str, before: Step, after: Step) -> None:
    """A package with a failed look-up is read again when it would succeed, wherever the file is."""
    site, store, clean = Site(tmp_path), EmbeddedStore.create(tmp_path / "kept"), EmbeddedStore.create(tmp_path / "new")
    site.write(contents(before.edits), before.absent)
    site.build(store, 1)
    first = results(store)
    site.write(contents({**before.edits, **after.edits}), after.absent)
    site.build(store, 1)
    site.build(clean, 1)
    assert results(store) == results(clean)
    assert exported(store) == exported(clean)
    assert results(store)[package] != first[package]


def test_an_installed_package_is_noticed(tmp_path: Path) -> None:
    """A launch file that names a package is read again when it is installed."""
    site, store = Site(tmp_path), EmbeddedStore.create(tmp_path / "kept")
    site.write(contents({}), frozenset({"lib"}))
    site.build(store, 1)
    first = results(store)
    (tmp_path / "installed" / "lib" / "launch").mkdir(parents=True)
    (tmp_path / "installed" / "lib" / "package.xml").write_text(manifest("lib"))
    (tmp_path / "installed" / "lib" / "launch" / "part.launch.xml").write_text(PART.format(topic="installed"))
    assert list(pending(store.layout, site.settings(1)).values()) == [("start",)]
    site.build(store, 1)
    assert {path for path, one in results(store).items() if one != first[path]} == {"start"}
    assert list(pending(store.layout, site.settings(1)).values()) == [()]


class Read(NamedTuple):
    """The compared parts of a package that was read."""

    packed: bytes
    inputs: dict[str, str]
    outside: dict[Lookup, str]


def _read(job: Job, path: str) -> Read:
    outcome = work(job, "local/src", path)
    return Read(outcome.packed, outcome.inputs, outcome.outside)


def _read_alone(job: Job, path: str) -> Read:
    """Return the result of a new process, which has read nothing else in this workspace."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=lambda: there.send(_read(job, path)))
    process.start()
    found: Read = here.recv()
    process.join()
    return found


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    """A workspace with all its files."""
    made = Site(tmp_path_factory.mktemp("purity"))
    made.write(contents({path: 1 for path, known in FILES.items() if known[0] is None}), frozenset())
    return made


@pytest.fixture(scope="module")
def alone(site: Site) -> dict[str, Read]:
    """The result of each package in a process that reads nothing else."""
    job = _job(site)
    return {path: _read_alone(job, path) for path in PACKAGES}


def _job(site: Site) -> Job:
    return Job(RecordingWorkspace(scan_tree(site.sources)), "https://example.org/", LIMIT)


@given(orders=st.lists(st.permutations(PACKAGES), min_size=1, max_size=3))
@settings(max_examples=10)
def test_packages_can_be_read_in_any_order(site: Site, alone: dict[str, Read], orders: list[list[str]]) -> None:
    """Facts, look-ups and inputs of a package do not depend on what its process has read before."""
    job = _job(site)
    for path in (path for order in orders for path in order):
        assert _read(job, path) == alone[path]
