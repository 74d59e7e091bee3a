"""What code for rclpy needs, without ROS 2: modules that publish to lists, and messages that are as strict as ROS 2's.

The setters that `rosidl_generator_py` makes assert that a float is a float and a whole number an int; so do these.
"""

from __future__ import annotations

import time
from types import ModuleType, SimpleNamespace
from typing import Any

from kg.robot.messages import Types

__all__ = ["Node", "message", "modules"]

TYPES = Types(2)


def message(name: str) -> type:
    """Return a class for a message type of ROS 2."""
    fields = {one.name: one for one in TYPES.fields(name)}

    def begin(self: Any) -> None:
        for field in fields.values():
            object.__setattr__(self, field.name, message(field.type)() if field.is_message else None)

    def put(_: Any, attribute: str, value: object) -> None:
        kind = fields[attribute].type
        wanted = float if kind.startswith("float") else int if "int" in kind else object
        assert isinstance(value, wanted), f"The '{attribute}' field must be of type '{wanted.__name__}'"
        object.__setattr__(_, attribute, value)

    return type(name.rpartition("/")[2], (), {"__init__": begin, "__setattr__": put})


class Node:
    """A node whose publishers keep what they publish, by topic."""

    def __init__(self, name: str) -> None:
        """Publish nothing yet."""
        self.name = name
        self.published: dict[str, list[Any]] = {}

    def create_publisher(self, _: type, topic: str, __: int) -> SimpleNamespace:
        """Return a publisher that somebody listens to."""
        kept = self.published.setdefault(topic, [])
        return SimpleNamespace(publish=kept.append, get_subscription_count=lambda: 1)

    def get_clock(self) -> SimpleNamespace:
        """Return a clock."""
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=time.monotonic_ns()))


def modules(*messages: str) -> dict[str, ModuleType]:
    """Return the modules that code imports, with messages of these names."""
    found: dict[str, dict[str, object]] = {
        "rclpy": {"ok": lambda: True},
        "rclpy.executors": {"MultiThreadedExecutor": object},
        "rclpy.node": {"Node": Node},
        "rclpy.signals": {"SignalHandlerOptions": object},
    }
    for name in messages:
        package, _, kind = name.partition("/")
        found.setdefault(package, {})
        found.setdefault(f"{package}.msg", {})[kind] = message(name)
    made = {}
    for name, content in found.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(content)
    return made
