"""YAML that may be hostile: the parser in C composes nested nodes on its own stack, which deep nesting overruns."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import yaml

if TYPE_CHECKING:
    from yaml import Node

__all__ = ["compose_yaml", "load_yaml"]

_MOST_DEPTH: Final = 200
_HARMLESS: Final = 2000
"""Levels that a text of so few opening marks cannot exceed; the stack overflows at some twenty thousand."""
_LEADING: Final = re.compile(r"^[ \t?-]*", re.MULTILINE)


def compose_yaml(text: str, loader: Any) -> Node | None:
    """Return the root node of the one document in `text`, None when there is none.

    Raises `yaml.YAMLError` for what is no YAML, also for what nests deeper than 200 levels.
    """
    _require_shallow(text, loader)
    return yaml.compose(text, Loader=loader)


def load_yaml(text: str, loader: Any) -> Any:
    """Return the value of the one document in `text`; `loader` is a safe one. Raises as `compose_yaml`."""
    _require_shallow(text, loader)
    return yaml.load(text, loader)  # noqa: S506 - callers give safe loaders


def _require_shallow(text: str, loader: Any) -> None:
    if text.count("[") + text.count("{") <= _HARMLESS >= max(map(len, _LEADING.findall(text))):
        return
    depth = 0
    for event in yaml.parse(text, Loader=loader):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _MOST_DEPTH:
            place: Any = event.start_mark  # of the parser in C, which is no subclass of the other
            raise yaml.MarkedYAMLError(problem=f"it nests deeper than {_MOST_DEPTH} levels", problem_mark=place)
