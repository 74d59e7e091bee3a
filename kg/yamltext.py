"""Parser for untrusted YAML. The C parser composes nested nodes on its own stack, which deep nesting overflows."""

from __future__ import annotations

import re
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

import yaml

if TYPE_CHECKING:
    from collections.abc import Iterator

    from yaml import Node

__all__ = ["LOADER", "Walk", "YamlFault", "compose_documents", "compose_yaml", "fault_of", "load_yaml"]

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_MOST_DEPTH: Final = 200
_MOST_LEVELS: Final = 60
"""Depth limit for the traversal of a document: far beyond real files, within the stack of the interpreter."""
_MOST_VISITS: Final = 50_000
_MOST_CHARACTERS: Final = 5_000_000
_HARMLESS: Final = 2000
"""A text with no more opening marks cannot exceed this depth; the stack overflows at some twenty thousand."""
_LEADING: Final = re.compile(r"^[ \t?-]*", re.MULTILINE)


class YamlFault(ValueError):  # noqa: N818 - a finding about the user's file, not an error of the program
    """Problem of a text, as a predicate (`is not YAML: ...`), and the line, counted from 1.

    `is_large` is whether a limit was exceeded, rather than the syntax violated.
    """

    def __init__(self, message: str, line: int | None = None, *, is_large: bool = False) -> None:
        super().__init__(message)
        self.message = message
        self.line = line
        self.is_large = is_large


def compose_yaml(text: str, loader: Any = LOADER) -> Node | None:
    """Return the root node of the single document in `text`, None if it is empty.

    Raises `YamlFault` for invalid YAML, or nesting deeper than 200 levels.
    """
    with _faults():
        _require_shallow(text, loader)
        return yaml.compose(text, Loader=loader)


def compose_documents(text: str) -> list[Node]:
    """Return the root nodes of all documents in `text`; raises as `compose_yaml`."""
    with _faults():
        _require_shallow(text, LOADER)
        return [*yaml.compose_all(text, Loader=LOADER)]


@contextmanager
def _faults() -> Iterator[None]:
    """Raise errors of the parser as `YamlFault`."""
    try:
        yield
    except yaml.YAMLError as error:
        raise fault_of(error) from error
    except RecursionError as error:
        raise YamlFault("is nested too deep", is_large=True) from error


def fault_of(error: yaml.YAMLError) -> YamlFault:
    """Return an error of the parser, or of a constructor of values, as a `YamlFault`."""
    mark = getattr(error, "problem_mark", None)
    problem = str(getattr(error, "problem", None) or error).partition("\n")[0]
    if problem.startswith("but ") and (context := getattr(error, "context", None)):
        problem = f"{context}, {problem}"  # the beginning of the sentence
    return YamlFault(f"is not YAML: {problem}", mark.line + 1 if mark else None)


class Walk:
    """Traversal of a composed document, which limits the expansion of its aliases."""

    def __init__(self) -> None:
        self._visits = 0
        self._characters = 0

    def visit(self, node: Node, depth: int) -> None:
        """Count a node; raises `YamlFault` if it exceeds the depth or the number of nodes."""
        self._visits += 1
        self._characters += len(node.value) if isinstance(node, yaml.ScalarNode) else 0
        line = node.start_mark.line + 1
        if depth > _MOST_LEVELS:
            raise YamlFault(f"is nested deeper than {_MOST_LEVELS} levels", line, is_large=True)
        if self._visits > _MOST_VISITS or self._characters > _MOST_CHARACTERS:
            message = f"means more than {_MOST_VISITS} values or is expanded endlessly"
            raise YamlFault(message, line, is_large=True)

    def pairs(self, node: Node | None, depth: int) -> Iterator[tuple[yaml.ScalarNode, Node]]:
        """Yield the entries of a mapping whose keys are scalars; nothing for other nodes."""
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            self.visit(key, depth)
            if isinstance(key, yaml.ScalarNode):
                yield key, value


def load_yaml(text: str, loader: Any = LOADER) -> Any:
    """Return the value of the single document in `text`; `loader` must be safe. Raises `yaml.YAMLError`."""
    _require_shallow(text, loader)
    return yaml.load(text, loader)  # noqa: S506 - callers pass safe loaders


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
            place: Any = event.start_mark  # of the C parser, which is not a subclass of the other
            raise yaml.MarkedYAMLError(problem=f"it nests deeper than {_MOST_DEPTH} levels", problem_mark=place)
