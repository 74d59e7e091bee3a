"""Nodes described in one line each, stores of them, and a check that a launch file connects a chain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from graph.samples import source_triples
from pyoxigraph import NamedNode

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.facts import (
    Access,
    Interface,
    Location,
    NodeKind,
    NodeReference,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Repository,
    Resolution,
    Role,
)
from kg.graph.iris import Iris
from kg.launch.files import read_configuration
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes
from kg.search.compose import Question, compose
from kg.search.compose.launching import launch_text
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from kg.facts import System
    from kg.search.compose import Answer
    from kg.search.compose.results import Composed

__all__ = ["answer_of", "interface", "node", "read_back", "store_of", "unconnected"]

HERE: Final = "local/here"
_MANIFEST: Final = """<package format="3">
  <name>chains</name><version>1.0.0</version><description>Chains.</description>
  <maintainer email="m@example.org">M</maintainer><license>MIT</license>
</package>
"""


def interface(  # noqa: PLR0913 - the parts of a fact
    role: Role,
    name: str | None,
    type_name: str,
    *,
    line: int = 1,
    path: str = "src/x.cpp",
    parameter: str | None = None,
    implicit: bool = False,
    switches: tuple[str, ...] = (),
) -> Interface:
    """Return an end; one without a name is named by its parameter, if given."""
    resolution = Resolution.LITERAL if name is not None else Resolution.UNRESOLVED
    written = parameter.replace("/", "_") if name is None and parameter else None
    return Interface(
        role, name, type_name, resolution, Location(path, line), parameter=parameter, implicit=implicit,
        switches=switches, written=written,
    )  # fmt: skip


def node(  # noqa: PLR0913 - what tests tell nodes apart by
    name: str,
    takes: Mapping[str, str],
    gives: Mapping[str, str],
    *,
    ros: int = 1,
    kind: str = "executable",
    path: str = "src/x.cpp",
    parameters: Sequence[Parameter] = (),
    more: Iterable[Interface] = (),
) -> NodeType:
    """Return a node that subscribes to and publishes topics, each with its type."""
    ends = [
        interface(Role.SUBSCRIBES, topic, kind_of, line=10 + at, path=path)
        for at, (topic, kind_of) in enumerate(takes.items())
    ]
    ends += [
        interface(Role.PUBLISHES, topic, kind_of, line=20 + at, path=path)
        for at, (topic, kind_of) in enumerate(gives.items())
    ]
    loaded = kind in {"nodelet", "component"}
    return NodeType(
        name=name,
        kind=NodeKind(kind),
        language="cpp",
        ros=ros,
        location=Location(path, 1),
        executable=None if loaded or kind in {"plugin", "class"} else name,
        plugin=f"robots/{name}" if loaded and ros == 1 else f"robots::{name}" if loaded else None,
        interfaces=(*ends, *more),
        parameters=tuple(parameters),
    )


def read(name: str, default: str | None = None, line: int = 30) -> Parameter:
    """Return a parameter that a node reads."""
    return Parameter(name, "string", default, Access.READ, Location("src/x.cpp", line))


def store_of(root: Path, *nodes: NodeType, package: str = "robots", **others: Sequence[NodeType]) -> EmbeddedStore:
    """Return a store with the nodes in one package; `others` are packages of another source."""
    iris = Iris()
    sources = {Repository(HERE, "/nowhere"): {package: nodes}}
    if others:
        sources[Repository("local/there", "/elsewhere")] = {name: tuple(found) for name, found in others.items()}
    store = EmbeddedStore.create(root)
    with store.write("test") as transaction:
        graphs = {}
        for source, packages in sources.items():
            facts = [
                PackageFacts(
                    source.name, Package(name, name, found[0].ros, Location(f"{name}/package.xml", 1)), tuple(found)
                )
                for name, found in packages.items()
                if found
            ]
            graphs[NamedNode(iris.source_graph(source.name))] = [source_triples(source, facts, iris)]
        transaction.replace_graphs(graphs)
    return store


def answer_of(store: EmbeddedStore, source: str, target: str, **more: object) -> Answer:
    """Return the chains from one type to another; `more` contains fields of the question."""
    with store.read() as snapshot:
        question = Question((source,), (target,), **more)  # type: ignore[arg-type]  # fields of several types
        return compose(snapshot, question, store.layout.cache)


def read_back(chain: Composed, types: Iterable[tuple[NodeReference, NodeType]], folder: Path) -> System:
    """Return the system of a chain's launch file, as kg reads it from a separate package."""
    path = f"launch/chain.launch{'' if chain.wiring.ros == 1 else '.py'}"
    (folder / "launch").mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(_MANIFEST)
    (folder / path).write_text(launch_text(chain))
    source = scan(folder, Repository("local/chains", str(folder)))
    reader = Reader(Workspace([source], []), source, source.packages[0])
    configuration = read_configuration(reader, path, chain.wiring.ros)
    assert configuration is not None
    assert not configuration.problems
    return wire(configuration, NodeTypes(types))


def unconnected(chain: Composed, system: System) -> list[str]:
    """Return the ends of a chain that are not on the topics before and after their node."""
    instances = {instance.name: instance for instance in system.instances}
    missing = []
    for place, one in enumerate(chain.nodes):
        found = instances[f"/{one.start.name}"]
        assert found.type is not None, found.reason
        ends = {(end.declared.role, end.resolved, end.declared.type) for end in found.interfaces}
        for role, link in (
            (Role.SUBSCRIBES, chain.wiring.links[place]),
            (Role.PUBLISHES, chain.wiring.links[place + 1]),
        ):
            if (role, link.topic, link.type) not in ends:
                missing.append(f"{found.name} {role} {link.topic}")
    return missing
