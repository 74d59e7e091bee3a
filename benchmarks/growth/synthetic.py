"""Workspaces of facts of any size: the same number of packages always has the same facts.

A repository has ten packages, each with a launch file that starts nodes of its own and of those before. A few topics
and services have the same name everywhere, others are shared by the packages of a repository, most have a name of
their own.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Final

from kg.facts import (
    Access,
    Dependency,
    Description,
    DescriptionKind,
    Field,
    FileKind,
    Interface,
    InterfaceDefinition,
    LaunchConfiguration,
    LaunchDialect,
    LaunchParameter,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Person,
    Remap,
    Repository,
    Resolution,
    Role,
    SourceFile,
    StartedNode,
    StartKind,
)
from kg.facts.texts import Phrase

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["repositories"]

_PACKAGES: Final = 10
_NODES: Final = 4
_STARTED: Final = 2
"""How many nodes of each package a launch file starts."""
_EVERYWHERE: Final = {
    "topic": (
        ("scan", "sensor_msgs/msg/LaserScan"),
        ("cmd_vel", "geometry_msgs/msg/Twist"),
        ("odom", "nav_msgs/msg/Odometry"),
        ("image_raw", "sensor_msgs/msg/Image"),
        ("imu/data", "sensor_msgs/msg/Imu"),
        ("joint_states", "sensor_msgs/msg/JointState"),
    ),
    "service": (("reset", "std_srvs/srv/Trigger"), ("enable", "std_srvs/srv/SetBool")),
    "action": (("navigate", "nav2_msgs/action/NavigateToPose"),),
}
_KINDS: Final = {"topic": "msg", "service": "srv", "action": "action"}
_ROLES: Final = (Role.PUBLISHES,) * 4 + (Role.SUBSCRIBES,) * 4 + (Role.SERVICES, Role.CLIENTS, Role.ACTION_SERVERS)
_OWN: Final = ("describe_parameters", "get_parameters", "list_parameters", "set_parameters")
"""Services that each node of ROS 2 has."""
_WORDS: Final = (
    "camera",
    "driver",
    "filter",
    "lidar",
    "map",
    "motor",
    "path",
    "plan",
    "point",
    "pose",
    "robot",
    "track",
)
_TYPES: Final = (("double", "0.5"), ("bool", "true"), ("string", "base_link"), ("int", "10"))


def repositories() -> Iterator[tuple[Repository, list[PackageFacts]]]:
    """Yield repositories with their packages, as many as are taken."""
    chance = random.Random(1)  # noqa: S311 - a sample, no secret
    number = 0
    while True:
        repository = Repository(f"example.org/made/robot_{number}", f"/made/robot_{number}", f"{number:040x}")
        names = [f"robot_{number}_part_{at}" for at in range(_PACKAGES)]
        packages = [_package(repository.name, names, at, chance) for at in range(_PACKAGES)]
        yield repository, packages
        number += 1


def _package(repository: str, names: list[str], at: int, chance: random.Random) -> PackageFacts:
    name = names[at]
    nodes = tuple(_node(names, at, number, chance) for number in range(_NODES))
    files = [
        SourceFile(f"{name}/src/{one.name}.cpp", FileKind.CPP, chance.randrange(40_000), "0" * 32) for one in nodes
    ]
    files += [SourceFile(f"{name}/include/{one.name}.hpp", FileKind.CPP, 900, "0" * 32) for one in nodes]
    return PackageFacts(
        repository,
        Package(
            name,
            name,
            2,
            Location(f"{name}/package.xml", 1),
            "1.0.0",
            f"Part {at} of a robot.",
            3,
            "ament_cmake",
            ("Apache-2.0",),
            (Person(f"Maintainer of {names[0]}", f"{names[0]}@example.org"),),
            dependencies=tuple(
                Dependency(other, "depend", 10 + line) for line, other in enumerate(["rclcpp", *names[:at][-4:]])
            ),
        ),
        nodes,
        tuple(_definition(name, number) for number in range(2)),
        tuple(files),
        descriptions=tuple(text for one in nodes for text in _descriptions(one, chance)),
        launches=(_launch(repository, names[: at + 1]),),
    )


def _node(names: list[str], at: int, number: int, chance: random.Random) -> NodeType:
    package = names[at]
    name = f"{package}_node_{number}"
    source = f"{package}/src/{name}.cpp"
    interfaces = [_interface(names, name, source, 30 + line, chance) for line in range(9)]
    interfaces += [
        Interface(
            Role.SERVICES,
            f"~/{service}",
            f"rcl_interfaces/srv/{service.title().replace('_', '')}",
            Resolution.LITERAL,
            Location(source, 20),
            f"/{name}/{service}",
            implicit=True,
            origin="ros2.node",
        )
        for service in _OWN
    ]
    kinds = [(line, *chance.choice(_TYPES)) for line in range(12)]
    parameters = tuple(
        Parameter(f"~/{chance.choice(_WORDS)}_{line}", kind, default, Access.DECLARE, Location(source, 60 + line))
        for line, kind, default in kinds
    )
    return NodeType(
        name,
        NodeKind.EXECUTABLE,
        "cpp",
        2,
        Location(source, 20),
        name,
        node_name=name,
        sources=(source,),
        interfaces=tuple(dict.fromkeys(interfaces)),
        parameters=parameters,
    )


def _interface(names: list[str], node: str, source: str, line: int, chance: random.Random) -> Interface:
    role, luck = chance.choice(_ROLES), chance.random()
    if luck < 0.03:  # noqa: PLR2004 - a share of all names
        name, kind = chance.choice(_EVERYWHERE[role.channel])
    else:
        owner = chance.choice(names)
        name = f"{owner}/{chance.choice(_WORDS)}" if luck < 0.5 else f"{node}/{chance.choice(_WORDS)}_{line}"  # noqa: PLR2004 - the same
        kind = f"{owner}/{_KINDS[role.channel]}/Made0"
    return Interface(role, name, kind, Resolution.LITERAL, Location(source, line), f"/{name}", f'"{name}"')


def _definition(package: str, number: int) -> InterfaceDefinition:
    fields = tuple(Field("message", f"{word}_{number}", "float64", line) for line, word in enumerate(_WORDS[:6], 1))
    return InterfaceDefinition("msg", package, f"Made{number}", fields, Location(f"{package}/msg/Made{number}.msg", 0))


def _descriptions(node: NodeType, chance: random.Random) -> Iterator[Description]:
    for line in (1, 12):
        words = chance.sample(_WORDS, 6)
        text = f"Takes what {' '.join(words)} give and hands it to the rest of {node.name}."
        phrases = (Phrase(f"{words[0]} {words[1]}", "compound"),)
        yield Description(
            text,
            DescriptionKind.COMMENT,
            Location(node.location.path, line),
            node.name,
            words=tuple(sorted(words)),
            phrases=phrases,
        )


def _launch(repository: str, names: list[str]) -> LaunchConfiguration:
    own = names[-1]
    path = f"{own}/launch/robot.launch.py"
    nodes = [
        StartedNode(
            f"{package}_{number}",
            "/",
            StartKind.NODE,
            Location(path, 10 * at + number + 1),
            package=package,
            executable=f"{package}_node_{number}",
            remaps=(Remap("image_raw", f"/{own}/image_raw", Location(path, 10 * at + number + 1)),),
            parameters=tuple(
                LaunchParameter(f"{word}_{number}", "1.5", Location(path, 10 * at + number + 1), type="double")
                for number, word in enumerate(_WORDS[:3])
            ),
        )
        for at, package in enumerate(names)
        for number in range(_STARTED)
    ]
    return LaunchConfiguration(
        repository,
        own,
        path,
        2,
        LaunchDialect.ROS2_PYTHON,
        nodes=tuple(nodes),
        files=((repository, path),),
        folder=own,
    )
