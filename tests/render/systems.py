"""Systems made of facts, for tests of their drawings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.facts import (
    InstanceInterface,
    Interface,
    LaunchConfiguration,
    LaunchDialect,
    Location,
    NodeInstance,
    NodeReference,
    Resolution,
    Role,
    StartedNode,
    StartKind,
    System,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["CAMERA", "end", "instance", "system"]

PLACE = Location("bringup/launch/robot.launch", 7)


def end(role: Role, name: str | None, kind: str = "std_msgs/Empty", *, implicit: bool = False) -> InstanceInterface:
    """Return an end with the resolved name `name`."""
    declared = Interface(
        role, name, kind, Resolution.LITERAL, Location("src/a.cpp", 3), written="topic_", implicit=implicit
    )
    return InstanceInterface(declared, NodeReference("r", "p", "n"), name, Resolution.LITERAL)


def instance(
    name: str,
    *ends: InstanceInterface,
    kind: StartKind = StartKind.NODE,
    host: str | None = None,
    condition: str | None = None,
    reason: str | None = None,
) -> NodeInstance:
    """Return a started node of the type `pkg/LAST NAME`."""
    namespace, _, last = name.rpartition("/")
    started = StartedNode(
        last, namespace or "/", kind, PLACE, package="pkg", executable=last, host=host, condition=condition
    )
    return NodeInstance(name, namespace or "/", started, reason=reason, host=host, interfaces=ends)


def system(instances: Iterable[NodeInstance]) -> System:
    """Return a system started by one launch file."""
    launch = LaunchConfiguration("r", "bringup", PLACE.path, 1, LaunchDialect.ROSLAUNCH)
    return System(launch, tuple(instances))


CAMERA = (
    instance("/manager", kind=StartKind.NODELET_MANAGER),
    instance("/driver", end(Role.PUBLISHES, "/raw"), kind=StartKind.NODELET, host="/manager"),
    instance(
        "/rectify",
        end(Role.SUBSCRIBES, "/raw"),
        end(Role.PUBLISHES, "/rect"),
        end(Role.PUBLISHES, "/rect/info"),
        kind=StartKind.NODELET,
        host="/manager",
    ),
    instance(
        "/detector",
        end(Role.SUBSCRIBES, "/rect"),
        end(Role.SUBSCRIBES, "/rect/info"),
        end(Role.PUBLISHES, None),
        end(Role.PUBLISHES, "/rosout", implicit=True),
        end(Role.SUBSCRIBES, "/mode"),
        end(Role.CLIENTS, "/clear"),
        end(Role.ACTION_CLIENTS, "/dock"),
        condition='$(arg "use" & more)',
    ),
    instance("/base", end(Role.SERVICES, "/clear"), end(Role.ACTION_SERVERS, "/dock"), reason="no package"),
)
"""A camera of nodelets, a viewer of its images, and a base with a service and an action."""
