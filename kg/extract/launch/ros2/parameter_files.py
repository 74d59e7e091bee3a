"""Parameter files of ROS 2: YAML with names of nodes, `ros__parameters` below them, and parameters that may be nested.

Source: `rcl_yaml_param_parser`, and `nav2_common.launch.RewrittenYaml` for the rewriting.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.values import LOADER, of_text, of_yaml
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.extract.launch.ros2.actions import ParameterFile
    from kg.extract.launch.ros2.context import Context
    from kg.facts import Location

__all__ = ["Entry", "entries", "rewritten"]

_PARAMETERS: Final = "ros__parameters"
_MOST_DEPTH: Final = 60
_MOST_ENTRIES: Final = 50_000
_MOST_CHARACTERS: Final = 5_000_000


@dataclass(frozen=True, slots=True)
class Entry:
    """A parameter of a file: the name of the node it is for, its own name in parts, its value as YAML, and its line.

    `location` is that of what set the value, where that is not the file.
    """

    node: str
    names: tuple[str, ...]
    value: str
    type: str | None
    line: int
    location: Location | None = None


def entries(content: bytes, flat: str | None = None) -> tuple[Entry, ...]:
    """Return the parameters of a file in its order; `flat` is for whom a file is that names no nodes at all.

    Raises `ValueError` with what is wrong and the line.
    """
    return _entries(content, flat)


@lru_cache(maxsize=256)
def _entries(content: bytes, flat: str | None) -> tuple[Entry, ...]:
    try:
        root = compose_yaml(content.decode(), LOADER)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "cannot be parsed"
        raise ValueError(f"is no YAML: {problem}", mark.line + 1 if mark else 1) from error
    except RecursionError as error:
        raise ValueError("is nested too deep", 1) from error
    walk = _Walk()
    found = tuple(walk.nodes(root, (), 0))
    if found or flat is None:
        return found
    return tuple(walk.leaves(root, flat, (), 0))


class _Walk:
    """One walk over a document, which bounds what its aliases can make of it."""

    def __init__(self) -> None:
        self._count = 0
        self._characters = 0

    def nodes(self, node: yaml.Node | None, names: tuple[str, ...], depth: int) -> Iterator[Entry]:
        """Yield the parameters of all nodes below a mapping."""
        for key, value in self._pairs(node, depth):
            if key.value == _PARAMETERS:
                yield from self.leaves(value, _joined(names), (), depth + 1)
            elif isinstance(value, yaml.MappingNode):
                yield from self.nodes(value, (*names, key.value), depth + 1)

    def leaves(self, node: yaml.Node | None, owner: str, names: tuple[str, ...], depth: int) -> Iterator[Entry]:
        """Yield the parameters of a mapping of names, with the line of each."""
        for key, value in self._pairs(node, depth):
            below = (*names, key.value)
            if isinstance(value, yaml.MappingNode):
                yield from self.leaves(value, owner, below, depth + 1)
            else:
                written, kind = self._written(value, key.start_mark.line + 1)
                yield Entry(owner, below, written, kind, key.start_mark.line + 1)

    def _written(self, node: yaml.Node, line: int) -> tuple[str, str | None]:
        try:
            written, kind = of_yaml(node)
        except ValueError as error:
            raise ValueError(f"has a value {error}", line) from error
        self._characters += len(written)
        if self._characters > _MOST_CHARACTERS:
            raise ValueError(f"means more than {_MOST_CHARACTERS} characters", line)
        return written, kind

    def _pairs(self, node: yaml.Node | None, depth: int) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        if depth > _MOST_DEPTH:
            raise ValueError(f"is nested deeper than {_MOST_DEPTH} levels", node.start_mark.line + 1 if node else 1)
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            self._count += 1
            if self._count > _MOST_ENTRIES:
                raise ValueError(f"means more than {_MOST_ENTRIES} values", key.start_mark.line + 1)
            if isinstance(key, yaml.ScalarNode) and key.tag != "tag:yaml.org,2002:merge":
                yield key, value
            elif isinstance(key, yaml.ScalarNode):
                yield from self._merged(value, depth)

    def _merged(self, node: yaml.Node, depth: int) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        for part in node.value if isinstance(node, yaml.SequenceNode) else [node]:
            yield from self._pairs(part, depth + 1)


def _joined(names: Sequence[str]) -> str:
    """Return the name of a node from the keys above its parameters."""
    absolute = "/" if names and names[0].startswith("/") else ""
    return absolute + "/".join(part.strip("/") for part in names if part.strip("/"))


def rewritten(context: Context, listed: Sequence[Entry], source: ParameterFile) -> Sequence[Entry]:
    """Return the parameters of a file after keys and values were rewritten, and all put below a root.

    A value is named by its key alone, or by the whole path to it, which is added where the file does not have it.
    """
    keys = {context.perform(old): context.perform(new) for old, new in source.keys}
    values = {context.perform(name): context.perform(value) for name, value in source.rewrites}
    root = context.perform(source.root) if source.root is not None else ""
    known = {_path(entry) for entry in listed}
    fresh = [_added(path, source.location) for path in values if path not in known and f".{_PARAMETERS}." in path]
    return [_rewritten(entry, keys, values, root, source.location) for entry in (*listed, *fresh)]


def _path(entry: Entry) -> str:
    return ".".join((*entry.node.split("/"), _PARAMETERS, *entry.names))


def _added(path: str, location: Location) -> Entry:
    node, _, names = path.partition(f".{_PARAMETERS}.")
    return Entry(node.replace(".", "/"), tuple(names.split(".")), "", None, location.line)


def _rewritten(entry: Entry, keys: dict[str, str], values: dict[str, str], root: str, location: Location) -> Entry:
    path = _path(entry)
    wanted = values.get(path, values.get(path.lstrip("."), values.get(entry.names[-1])))
    names = tuple(keys.get(name, name) for name in entry.names)
    node = "/".join(keys.get(part, part) for part in entry.node.split("/"))
    entry = replace(entry, names=names, node=_joined((root, node)) if root.strip("/") else node)
    if wanted is None:
        return entry
    value, kind = _converted(wanted)
    return replace(entry, value=HOLE if value is None else value, type=kind, location=location)


def _converted(text: str) -> tuple[str | None, str | None]:
    """Return the value and type of a text put into a file: a number or a truth value, else a text."""
    value, kind = of_text(text)
    return (value, kind) if kind in ("int", "double", "bool") else of_text(text, "string")
