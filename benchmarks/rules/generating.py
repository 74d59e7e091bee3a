"""A graph of the kind that `kg build` makes, of any size: the same size always gives the same bytes.

Workspaces of packages stand on earlier packages of their workspace; robots run nodes, which are chained by topics of
the robot and meet on a few that are busy; message types evoke capabilities, which form a tree.
"""

from __future__ import annotations

import random
from itertools import count, islice
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["BASE", "RNKG", "ROS", "TYPE", "schema", "triples", "write"]

BASE: Final = "https://w3id.org/rnkg/"
ROS: Final = "http://data.mksmart.org/onto-ros/class#"
RNKG: Final = "https://w3id.org/rnkg/ns#"
TYPE: Final = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"

_SENSORS: Final = ("camera", "lidar", "imu", "gps")
_OTHERS: Final = ("planner", "controller", "filter", "mapper", "tracker", "bridge", "monitor", "teleop")
_NODES_OF_ROBOT: Final = 18
_PACKAGES_OF_WORKSPACE: Final = 30
_NODES_OF_PACKAGE: Final = 3
_RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
_OWL: Final = "http://www.w3.org/2002/07/owl#"
_AXIOMS: Final = (
    (f"{ROS}Publisher", f"{_RDFS}subClassOf", f"{ROS}CommunicationComponent"),
    (f"{ROS}Subscriber", f"{_RDFS}subClassOf", f"{ROS}CommunicationComponent"),
    (f"{ROS}CommunicationComponent", f"{_RDFS}subClassOf", f"{RNKG}Part"),
    (f"{ROS}Node", f"{_RDFS}subClassOf", f"{RNKG}Software"),
    (f"{ROS}Package", f"{_RDFS}subClassOf", f"{RNKG}Software"),
    (f"{ROS}hasComponent", f"{_RDFS}subPropertyOf", f"{RNKG}hasPart"),
    (f"{RNKG}contains", f"{_RDFS}subPropertyOf", f"{RNKG}hasPart"),
    (f"{RNKG}runs", f"{_RDFS}subPropertyOf", f"{RNKG}uses"),
    (f"{RNKG}hasPart", f"{_RDFS}domain", f"{RNKG}Whole"),
    (f"{RNKG}hasPart", f"{_RDFS}range", f"{RNKG}Part"),
    (f"{RNKG}connectsTo", f"{_RDFS}range", f"{ROS}Topic"),
    (f"{ROS}hasComponent", f"{_OWL}inverseOf", f"{RNKG}componentOf"),
    (f"{RNKG}dependsOn", TYPE.strip("<>"), f"{_OWL}TransitiveProperty"),
    (f"{RNKG}broader", TYPE.strip("<>"), f"{_OWL}TransitiveProperty"),
)


def write(path: Path, size: int) -> None:
    """Write a graph of `size` triples as N-Triples."""
    with path.open("w", encoding="utf-8") as file:
        file.writelines(triples(size))


def triples(size: int) -> Iterator[str]:
    """Yield the lines of a graph of `size` triples, no line twice."""
    return islice(_Graph(size).lines(), size)


def schema() -> Iterator[str]:
    """Yield an ontology of the graph's terms, for the rules of OWL 2 RL."""
    for term, relation, other in _AXIOMS:
        yield f"<{term}> <{relation}> <{other}> .\n"


def _line(subject: str, predicate: str, target: str) -> str:
    return f"<{BASE}{subject}> {predicate} {target} .\n"


def _ros(name: str) -> str:
    return f"<{ROS}{name}>"


def _rnkg(name: str) -> str:
    return f"<{RNKG}{name}>"


def _thing(name: str) -> str:
    return f"<{BASE}{name}>"


class _Graph:
    """One graph in the making; what comes first (types, capabilities) depends on the size, the rest goes on."""

    def __init__(self, size: int) -> None:
        self._random = random.Random(size)  # noqa: S311 - to be the same each time, not to be secret
        self._capabilities = [f"capability/{number}" for number in range(min(60, max(12, size // 400)))]
        self._messages = [f"message/library_{number % 7}/Type{number}" for number in range(min(400, size // 100))]
        self._nodes = 0

    def lines(self) -> Iterator[str]:
        """Yield lines without an end."""
        yield from self._taxonomy()
        packages: list[str] = []
        for robot in count():
            nodes = [f"node/github.com/org{robot % 97}/repo{robot}/node_{number}" for number in range(_NODES_OF_ROBOT)]
            for begin in range(0, _NODES_OF_ROBOT, _NODES_OF_PACKAGE):
                yield from self._package(robot, packages, nodes[begin : begin + _NODES_OF_PACKAGE])
            yield from self._robot(robot, nodes)

    def _taxonomy(self) -> Iterator[str]:
        for number, capability in enumerate(self._capabilities):
            yield _line(capability, TYPE, _ros("Capability"))
            if number:
                yield _line(capability, _rnkg("broader"), _thing(self._capabilities[(number - 1) // 2]))
        for number, message in enumerate(self._messages):
            yield _line(message, TYPE, _ros("Message"))
            if number % 3:
                yield _line(message, _ros("evokes"), _thing(self._random.choice(self._capabilities)))

    def _package(self, robot: int, packages: list[str], nodes: list[str]) -> Iterator[str]:
        number = len(packages)
        package = f"package/github.com/org{robot % 97}/repo{robot}/package_{number}"
        yield _line(package, TYPE, _ros("Package"))
        yield _line(package, _rnkg("name"), f'"package_{number}"')
        earlier = packages[number - number % _PACKAGES_OF_WORKSPACE :]
        for needed in sorted(self._random.sample(earlier, min(len(earlier), 2))):
            yield _line(package, _rnkg("dependsOn"), _thing(needed))
        packages.append(package)
        for node in nodes:
            yield _line(package, _rnkg("contains"), _thing(node))

    def _robot(self, number: int, nodes: list[str]) -> Iterator[str]:
        robot = f"robot/{number}"
        yield _line(robot, TYPE, _rnkg("Robot"))
        for capability in sorted(self._random.sample(self._capabilities, 3)):
            yield _line(robot, _rnkg("requires"), _thing(capability))
        topics = [f"topic/robot_{number}/topic_{place}" for place in range(_NODES_OF_ROBOT + 2)]
        for topic in topics:
            yield _line(topic, TYPE, _ros("Topic"))
        for place, node in enumerate(nodes):
            yield _line(robot, _rnkg("runs"), _thing(node))
            yield from self._node(robot, node, place)
            yield from self._components(node, topics, place)

    def _node(self, robot: str, node: str, place: int) -> Iterator[str]:
        self._nodes += 1
        kind = self._random.choice(_SENSORS if place % 4 == 0 else _OTHERS)
        yield _line(node, TYPE, _ros("Node"))
        yield _line(node, _rnkg("name"), f'"{kind}_{"driver" if place % 2 else "node"}_{self._nodes}"')
        if place % 4 == 0:
            yield _line(node, _rnkg("drives"), _thing(f"hardware/{robot.rpartition('/')[2]}/{kind}"))

    def _components(self, node: str, topics: list[str], place: int) -> Iterator[str]:
        """A node listens to topics before its own, publishes its own, and at times a busy one."""
        heard = {topics[max(0, place - self._random.choice((1, 1, 1, 2, 3)))], topics[-2]} if place else {topics[-2]}
        told = {topics[place]} | ({topics[-1]} if place % 5 == 0 else set())
        for kind, connected in (("Subscriber", heard), ("Publisher", told)):
            for topic in sorted(connected):
                component = f"{node}#{kind.lower()}/{topic.rpartition('/')[2]}"
                yield _line(node, _ros("hasComponent"), _thing(component))
                yield _line(component, TYPE, _ros(kind))
                yield _line(component, _rnkg("connectsTo"), _thing(topic))
                yield _line(component, _ros("hasMessage"), _thing(self._random.choice(self._messages)))
