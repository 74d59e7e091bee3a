"""ROS names: joining, private names and resolution.

Sources: wiki.ros.org/Names (ROS 1) and design.ros2.org/articles/topic_and_service_names.html (ROS 2).
Private names are written `~/name` throughout `kg`; code of ROS 1 uses `~name`, code of ROS 2 `~/name`.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

from kg.holes import fits, is_partial

__all__ = ["FRAMEWORK", "is_for_node", "join", "key", "normalise", "resolve"]

FRAMEWORK: Final = frozenset(
    {"/rosout", "/rosout_agg", "/tf", "/tf_static", "/clock", "/diagnostics", "/diagnostics_agg", "/parameter_events"}
)
"""Names that the framework gives to nearly every node."""

_PART: Final = re.compile(r"/\w+")
_MOST_NAME: Final = 1000
"""Largest number of characters in the name of a node; ROS allows 255."""


def key(name: str) -> str:
    """Return a name without case, underscores and hyphens, equal for `laser_scan`, `LaserScan` and `laser-scan`."""
    return name.lower().replace("_", "").replace("-", "")


def normalise(name: str) -> str:
    """Return `name` with single slashes, no trailing slash, and a private name as `~/name` (`~` alone is unchanged)."""
    private = name.startswith("~")
    body = "/".join(part for part in name.removeprefix("~").split("/") if part)
    if private:
        return f"~/{body}" if body else "~"
    return f"/{body}" if name.startswith("/") else body


def join(namespace: str, name: str) -> str:
    """Return `name` relative to a node handle's `namespace` (which may be empty, private or absolute).

    Absolute and private names are returned as they are, as in `ros::NodeHandle` for absolute ones.
    """
    if name.startswith(("/", "~")) or not namespace:
        return normalise(name)
    return normalise(f"{namespace}/{name}") if name else normalise(namespace)


def resolve(name: str, node: str, namespace: str = "/") -> str:
    """Return the absolute name of `name` for the node `node` in `namespace`, before any remapping."""
    written = normalise(name)
    if written.startswith("/"):
        return written
    if written.startswith("~"):
        return normalise(f"/{namespace}/{node}/{written[1:]}")
    return normalise(f"/{namespace}/{written}")


def is_for_node(key: str, full: str) -> bool | None:
    """Return whether a key of a ROS 2 parameter file applies to the node `full`; None if that depends on a hole.

    Source: `rclcpp::parameter_map_from`: `/*` matches one part of a name and `/**` any number of them.
    """
    absolute = "/" + key.strip("/")
    if not is_partial(full):
        return full == absolute or ("*" in absolute and _fits(absolute, full))
    if absolute == "/**":
        return True
    return None if "*" in absolute or fits(full, absolute, ".*") else False


@lru_cache(maxsize=4096)
def _fits(key: str, full: str) -> bool:
    """Return whether a key with wildcards matches a name, by following all possible positions at once.

    A regular expression takes far too long for a key with many wildcards.
    """
    if max(len(key), len(full)) > _MOST_NAME:
        return False
    places = {0}
    for piece in re.split(r"(/\*\*|/\*)", key):
        if piece == "/*":
            places = {end for place in places for end in _ends(full, place)}
        elif piece == "/**":
            waiting = list(places)
            while waiting:
                new = set(_ends(full, waiting.pop())) - places
                places |= new
                waiting += new
        else:
            places = {place + len(piece) for place in places if full.startswith(piece, place)}
    return len(full) in places


def _ends(name: str, place: int) -> range:
    """Return the possible ends of a part of a name that begins at a position."""
    part = _PART.match(name, place)
    return range(place + 2, part.end() + 1) if part else range(0)
