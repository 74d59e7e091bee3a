"""ROS names: joining, private names and resolution.

Sources: wiki.ros.org/Names (ROS 1) and design.ros2.org/articles/topic_and_service_names.html (ROS 2).
Private names are written `~/name` throughout `kg`; ROS 1 code says `~name`, ROS 2 code `~/name`.
"""

from __future__ import annotations

__all__ = ["join", "normalise", "resolve"]


def normalise(name: str) -> str:
    """Return `name` with single slashes, none at its end, and a private name as `~/name` (`~` alone stays)."""
    private = name.startswith("~")
    body = "/".join(part for part in name.removeprefix("~").split("/") if part)
    if private:
        return f"~/{body}" if body else "~"
    return f"/{body}" if name.startswith("/") else body


def join(namespace: str, name: str) -> str:
    """Return `name` as seen from the root of a node handle's `namespace` (which may be empty, private or absolute).

    A name that is absolute or private itself keeps its own root, as `ros::NodeHandle` has it for absolute ones.
    """
    if name.startswith(("/", "~")) or not namespace:
        return normalise(name)
    return normalise(f"{namespace}/{name}") if name else normalise(namespace)


def resolve(name: str, node: str, namespace: str = "/") -> str:
    """Return the absolute name of `name` for a node called `node` in `namespace`, before any remapping."""
    written = normalise(name)
    if written.startswith("/"):
        return written
    if written.startswith("~"):
        return normalise(f"/{namespace}/{node}/{written[1:]}")
    return normalise(f"/{namespace}/{written}")
