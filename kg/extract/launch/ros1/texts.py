"""Texts with parts that are not known, and names built from texts, as roslaunch builds them."""

from __future__ import annotations

from typing import Final

from kg.extract.launch.expressions import HOLE
from kg.holes import ANONYMOUS

__all__ = ["HOLE", "MOST_CHARACTERS", "canonical", "global_namespace", "join", "shown"]

MOST_CHARACTERS: Final = 1 << 16
"""Of one text after substitution; arguments that repeat each other double with each line."""

_ROSLAUNCH: Final = "/roslaunch/"
"""The node that sets parameters; a private name that reaches the server is private to it."""


def shown(text: str) -> str:
    """Return the text as facts have it, with `{}` for what is not known."""
    return text.replace(HOLE, ANONYMOUS)


def join(namespace: str, name: str) -> str:
    """Return `name` in a namespace (with or without a slash at its end); private and global names keep their own."""
    if name.startswith(("~", "/")) or not namespace:
        return name
    return f"~{name}" if namespace == "~" else f"{namespace.rstrip('/')}/{name}"


def canonical(name: str) -> str:
    """Return an absolute name with single slashes and none at its end, as the parameter server has it."""
    rooted = f"{_ROSLAUNCH}{name[1:]}" if name.startswith("~") else name
    return "/" + "/".join(part for part in rooted.split("/") if part)


def global_namespace(name: str) -> str:
    """Return a namespace as an absolute one with a slash at its end."""
    inner = canonical(name)
    return inner if inner == "/" else f"{inner}/"
