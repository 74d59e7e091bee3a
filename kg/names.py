"""ROS names: joining, private names and resolution.

Sources: wiki.ros.org/Names (ROS 1) and design.ros2.org/articles/topic_and_service_names.html (ROS 2).
Private names are written `~/name` throughout `kg`; ROS 1 code says `~name`, ROS 2 code `~/name`.
"""

from __future__ import annotations

import re
from functools import lru_cache

__all__ = ["is_for_node", "join", "normalise", "resolve"]


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


def is_for_node(key: str, full: str) -> bool | None:
    """Tell whether a key of a ROS 2 parameter file is for the node `full`; None where that hangs on a `{}` in its name.

    Source: `rclcpp::parameter_map_from`, where `/*` stands for one part of a name and `/**` for any number of them.
    """
    absolute = "/" + key.strip("/")
    if "{}" not in full:
        return full == absolute or ("*" in absolute and bool(_pattern(absolute).fullmatch(full)))
    if absolute == "/**":
        return True
    possible = re.compile(".*".join(re.escape(part) for part in full.split("{}")), re.DOTALL)
    return None if "*" in absolute or possible.fullmatch(absolute) else False


@lru_cache(maxsize=1024)
def _pattern(key: str) -> re.Pattern[str]:
    r"""Return the expression that a key with wildcards means; a part of a name is `\w+`."""
    meant = {"/**": r"(?:/\w+)*", "/*": r"/\w+"}
    return re.compile("".join(meant.get(piece) or re.escape(piece) for piece in re.split(r"(/\*\*|/\*)", key)))
