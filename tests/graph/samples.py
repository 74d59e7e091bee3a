"""Facts and graphs shared by tests of the graph."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import QuerySolutions, RdfFormat, Store

from kg.facts import (
    Access,
    Dependency,
    Description,
    DescriptionKind,
    Field,
    FileKind,
    Interface,
    InterfaceDefinition,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Person,
    Phrase,
    Problem,
    Qos,
    Repository,
    Resolution,
    Role,
    SourceFile,
)
from kg.graph.builds import BuildRecord, count
from kg.graph.iris import Iris
from kg.graph.packages import package_triples, repository_triples
from kg.graph.vocabulary import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable

IRIS: Final = Iris()
BASE: Final = IRIS.base
ROVER: Final = "github.com/acme/rover"
REPOSITORY: Final = Repository(
    ROVER, "/home/someone/rover", "0123456789abcdef", "https://github.com/acme/rover", "main"
)
MAIN: Final = Location("rover_base/src/main.cpp", 10)
MANIFEST: Final = Location("rover_base/package.xml", 1)


def source_triples(
    repository: Repository, packages: Iterable[PackageFacts], iris: Iris, problems: Iterable[Problem] = ()
) -> bytes:
    """Return the N-Triples of the whole graph of a source, the same bytes for the same facts in the same order."""
    return b"".join(
        (repository_triples(repository, iris, problems), *(package_triples(each, iris) for each in packages))
    )


def end(role: Role, name: str | None, kind: str | None = None, **more: Any) -> Interface:
    """Return an interface with a literal name, in the root namespace, unless specified otherwise."""
    known: dict[str, Any] = {"resolution": Resolution.LITERAL, "location": MAIN, "resolved": name and f"/{name}"}
    return Interface(role, name, kind, **(known | more))


DRIVER: Final = NodeType(
    "driver",
    NodeKind.EXECUTABLE,
    "cpp",
    1,
    MAIN,
    executable="driver",
    node_name="rover_driver",
    sources=("rover_base/src/main.cpp", "rover_base/src/wheel.cpp"),
    interfaces=(
        end(Role.SUBSCRIBES, "cmd_vel", "geometry_msgs/Twist", written='"cmd_vel"'),
        end(Role.PUBLISHES, "odom", "nav_msgs/Odometry", qos=Qos("reliable", None, "keep_last", 10)),
        end(Role.PUBLISHES, "tf", "tf2_msgs/TFMessage", implicit=True, origin="tf2"),
        end(Role.PUBLISHES, None, "std_msgs/Bool", resolution=Resolution.UNRESOLVED, reason="it is read from a file"),
        end(Role.PUBLISHES, "wheel/{}", "std_msgs/Int32", resolution=Resolution.PARTIAL),
        end(Role.SERVICES, "reset", "std_srvs/Empty"),
        end(Role.CLIENTS, "static_map", "nav_msgs/GetMap"),
        end(Role.ACTION_SERVERS, "dock", "rover_msgs/Dock"),
        end(Role.ACTION_CLIENTS, "move_base", "move_base_msgs/MoveBase"),
    ),
    parameters=(Parameter("~/port", "string", "/dev/ttyUSB0", Access.READ, MAIN, description="The serial port."),),
)
PACKAGE: Final = Package(
    "rover_base",
    "rover_base",
    1,
    MANIFEST,
    version="1.2.0",
    description='Drives the "rover".\nSlowly.',
    format=2,
    licenses=("BSD", "Apache 2.0"),
    people=(Person("Ada", "ada@example.org"), Person("Bo", None, "author")),
    urls=(("website", "http://example.org/rover base"),),
    dependencies=(Dependency("roscpp", "depend", 12), Dependency("roscpp", "test_depend", 13)),
)
DOCK: Final = InterfaceDefinition(
    "srv",
    "rover_msgs",
    "SetSpeed",
    (
        Field("request", "speed", "geometry_msgs/Twist", 1, comment="in the base frame"),
        Field("request", "MAX", "float32", 2, constant="2.5"),
        Field("response", "speed", "float32[]", 4),
    ),
    Location("rover_base/srv/SetSpeed.srv", 1),
)
FACTS: Final = PackageFacts(
    ROVER,
    PACKAGE,
    (DRIVER,),
    (DOCK,),
    (SourceFile("rover_base/src/main.cpp", FileKind.CPP, 1204, "ab12"),),
    (Problem("KG115", "a bracket is missing", "rover_base/src/wheel.cpp", 3),),
    descriptions=(
        Description(
            "Drives the wheels of the rover by its motor controllers.",
            DescriptionKind.COMMENT,
            MAIN,
            "driver",
            words=("controller", "drive", "motor", "rover", "wheel"),
            phrases=(Phrase("motor controller", "compound"),),
        ),
        Description("The base of a rover.", DescriptionKind.README, Location("README.md", 3), heading="Rover"),
    ),
)
BUILD: Final = BuildRecord(
    REPOSITORY,
    datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC),
    datetime(2026, 1, 2, 3, 4, 9, 500000, tzinfo=UTC),
    "0.1.0",
    count([FACTS], triples=321),
)


def loaded(*triples: bytes) -> Store:
    """Return a store loaded with N-Triples."""
    store = Store()
    for each in triples:
        store.load(each, format=RdfFormat.N_TRIPLES)
    return store


def sample() -> Store:
    """Return a store with the graph of the rover's source."""
    return loaded(source_triples(REPOSITORY, [FACTS], IRIS))


def rows(store: Store, query: str) -> list[tuple[str | None, ...]]:
    """Return the results of a SELECT query as text, IRIs without the base, in order."""
    found = store.query(query, prefixes=PREFIXES)
    assert isinstance(found, QuerySolutions)
    answers = [tuple(None if term is None else term.value.removeprefix(BASE) for term in row) for row in found]
    return sorted(answers, key=lambda row: tuple(term or "" for term in row))


def true(store: Store, pattern: str) -> bool:
    """Whether a graph pattern has a match."""
    return bool(store.query(f"ASK {{ {pattern} }}", prefixes=PREFIXES, base_iri=BASE))
