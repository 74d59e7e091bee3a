"""A workspace of small packages, created for each test."""

from __future__ import annotations

from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import pytest
from forks import EXTRACTING, fork_extractors
from pyoxigraph import RdfFormat
from workspaces import prepare_builds

from kg.pipeline import inferring, seed
from kg.pipeline.build import build
from kg.pipeline.calls import call_files, read_calls
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from forks import Forked
    from pyoxigraph import QuerySolutions

    from kg.pipeline.report import BuildReport
    from kg.settings import Settings

MANIFEST = """<package format="2"><name>{name}</name><version>1.0.0</version><description>A test.</description>
<maintainer email="a@example.org">A</maintainer><license>MIT</license><depend>roscpp</depend></package>"""
NODE = """#include <ros/ros.h>
#include <std_msgs/String.h>
#include "shared/topics.hpp"
int main(int argc, char** argv) {{
  ros::init(argc, argv, "{name}");
  ros::NodeHandle handle;
  ros::Publisher publisher = handle.advertise<std_msgs::String>(SHARED_TOPIC, 1);
  ros::Publisher own = handle.advertise<std_msgs::String>("{topic}", 1);
}}
"""
CMAKE = "project({name})\nfind_package(catkin REQUIRED roscpp)\nadd_executable({name}_node src/node.cpp)\n"

_ONTOLOGY = b'<urn:x:a> <http://www.w3.org/2000/01/rdf-schema#label> "a" .\n'


@contextmanager
def few_ontologies() -> Iterator[None]:
    """Let builds write nearly empty ontologies, for tests of what rules do not read."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(seed, "load", lambda _: None)
        patch.setattr(inferring, "_in_force", lambda *_: _ONTOLOGY)
        yield


@pytest.fixture(scope="module")
def extractors() -> Iterator[list[Forked]]:
    """The extractor processes that workers in this process start: they are forked."""
    started: list[Forked] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(f"{EXTRACTING}.subprocess", fork_extractors(started))
        yield started


@dataclass(frozen=True, slots=True)
class Bench:
    """A workspace, a store, and actions of tests."""

    source: Path
    store: EmbeddedStore

    def package(self, name: str, topic: str = "chatter") -> None:
        """Write a package with one node that publishes the shared topic and one of its own."""
        folder = self.source / name
        (folder / "src").mkdir(parents=True, exist_ok=True)
        (folder / "package.xml").write_text(MANIFEST.format(name=name))
        (folder / "CMakeLists.txt").write_text(CMAKE.format(name=name))
        (folder / "src" / "node.cpp").write_text(NODE.format(name=name, topic=topic))

    def header(self, package: str, topic: str) -> None:
        """Write the header with the shared topic's name into a package."""
        folder = self.source / package / "include" / "shared"
        folder.mkdir(parents=True, exist_ok=True)
        (self.source / package / "package.xml").write_text(MANIFEST.format(name=package))
        (folder / "topics.hpp").write_text(f'#pragma once\n#define SHARED_TOPIC "{topic}"\n')

    def build(self, *named: str, jobs: int = 2, rules: bool = False) -> BuildReport:
        """Build the sources named, by default the workspace.

        Without rules, the ontologies are nearly empty as well: together they take most of the time. Each such build
        writes a generation.
        """
        with nullcontext() if rules else few_ontologies():
            return build(named or [str(self.source)], self.store, load({"jobs": jobs}, environment={}), rules=rules)

    def content(self) -> list[str]:
        """Return all quads of sources and of their shared graph, sorted."""
        with self.store.read() as snapshot:
            lines = snapshot.dump(RdfFormat.N_QUADS).decode().splitlines()
        return sorted(line for line in lines if "/graph/s" in line.rpartition(" <")[2])

    def topics(self) -> set[str]:
        """Return the names of all topics in the store."""
        return set(self._topics())

    def answers(self, topic: str) -> int:
        """Return how often a query for all topics returns one of them."""
        return self._topics().count(topic)

    def _topics(self) -> list[str]:
        with self.store.read() as snapshot:
            text = "SELECT ?n { ?t a ros:Topic ; rdfs:label ?n }"
            prefixes = {
                "ros": "http://data.mksmart.org/onto-ros/class#",
                "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
            }
            answer = snapshot.query(text, prefixes=prefixes)
            return [row["n"].value for row in cast("QuerySolutions", answer)]

    def sibling(self, name: str) -> Bench:
        """Return the same workspace with another, empty store."""
        return Bench(self.source, EmbeddedStore.create(self.store.layout.root.with_name(name)))


def _settings_only(settings: Settings, _folder: Path | None = None) -> str:
    """Return a version from the settings only, without code and libraries, which do not change."""
    return (
        f"{settings.base} {settings.max_file_bytes} {settings.nlp_model} {[*read_calls(call_files(settings)).values()]}"
    )


@pytest.fixture(scope="session", autouse=True)
def _prepared() -> None:
    """Load the modules needed by the processes of builds, once."""
    prepare_builds()


@pytest.fixture(autouse=True)
def _one_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make results depend on the settings only, so editing `kg` while tests run does not disturb them."""
    for module in ("build", "estimating"):
        monkeypatch.setattr(f"kg.pipeline.{module}.version", _settings_only)


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    """A workspace with a package for the header and two with nodes."""
    made = Bench(tmp_path / "src", EmbeddedStore.create(tmp_path / ".kg"))
    made.header("shared", "/first")
    made.package("one")
    made.package("two", "talk")
    return made
