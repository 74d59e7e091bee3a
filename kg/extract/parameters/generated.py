"""Parameters of `generate_parameter_library`: a YAML file from which a library is made that declares them.

The form is that of the tool's own documentation (PickNikRobotics/generate_parameter_library): one top key that names
the C++ namespace, below it a tree whose leaves are mappings with a `type`. A key `__map_x` stands for one level of
names that are the values of the parameter `x` at run time; it becomes the hole `{x}` in the name.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import yaml

from kg.facts import Access, Location, Parameter, Resolution
from kg.holes import escape, hole_of, is_partial
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.reading import Reader

__all__ = ["GeneratedLibrary", "parse_generated", "read_generated"]

_LOADER: Final = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_MOST_DEPTH: Final = 50
"""Levels of nesting; far beyond what people write, below what an interpreter's stack holds."""
_MOST_VISITS: Final = 50_000
"""Nodes looked at in one file: aliases that repeat each other could mean billions."""
_MOST_CHARACTERS: Final = 4_000_000
"""Of all defaults of one file together, as written: aliases can repeat a long text, too."""
_MAP: Final = "__map_"
_TEXT: Final = "tag:yaml.org,2002:str"
_NOT_DECLARED: Final = "none"
"""The type of a parameter that the file only documents: the node reads it in another way."""


class _TooMuchError(Exception):
    """The file is nested too deep, or its aliases mean too much."""


@dataclass(frozen=True, slots=True)
class GeneratedLibrary:
    """The parameters of a YAML file, in its order, and the namespace of the class that declares them.

    `namespace` is empty if the file has not exactly one top key. `error` tells what stopped the reading of the file:
    a message and a line, which can be unknown.
    """

    namespace: str
    parameters: tuple[Parameter, ...]
    error: tuple[str, int | None] | None = None


def parse_generated(content: bytes, path: str) -> GeneratedLibrary:
    """Return what the YAML file at `path` declares; where it is malformed, what comes before the mistake."""
    found: list[Parameter] = []
    keys: list[str] = []
    error: tuple[str, int | None] | None = None
    try:
        root = compose_yaml(content.decode(), _LOADER)
        keys += [str(key.value) for key, _ in root.value] if isinstance(root, yaml.MappingNode) else []
        found.extend(_Walk(path).parameters_of(root))
    except yaml.YAMLError as malformed:
        mark = getattr(malformed, "problem_mark", None)
        message = str(getattr(malformed, "problem", None) or malformed).partition("\n")[0]
        error = (f"no YAML: {message}", mark.line + 1 if mark else None)
    except (_TooMuchError, RecursionError) as large:
        message = str(large) or "the file is nested too deep"
        error = (f"{message}; the parameters before that were read", None)
    return GeneratedLibrary(keys[0] if len(keys) == 1 else "", tuple(found), error)


def read_generated(reader: Reader, path: str) -> tuple[Parameter, ...]:
    """Return the parameters of the YAML file at `path`; one that cannot be used is a problem KG119 of the `reader`."""
    content = reader.read(path)
    if content is None:
        return ()
    library = parse_generated(content, path)
    if library.error is not None:
        message, line = library.error
        reader.problem("KG119", message, path, line)
    return library.parameters


class _Walk:
    """One walk over a composed document, which bounds what aliases can make of it."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._visits = 0
        self._characters = 0

    def parameters_of(self, root: yaml.Node | None) -> Iterator[Parameter]:
        """Yield the parameters of a document: below its top key, which names a namespace of C++ and no parameter."""
        for _, value in self._pairs(root):
            yield from self._below(value, (), 1)

    def _below(self, node: yaml.Node, names: tuple[str, ...], depth: int) -> Iterator[Parameter]:
        if depth > _MOST_DEPTH:
            raise _TooMuchError(f"the file is nested deeper than {_MOST_DEPTH} levels")
        for key, value in self._pairs(node):
            name = hole_of(key.value.removeprefix(_MAP)) if key.value.startswith(_MAP) else escape(key.value)
            leaf = {inner.value: content for inner, content in self._pairs(value)}
            if isinstance(leaf.get("type"), yaml.ScalarNode):
                yield self._parameter(".".join((*names, name)), leaf, key.start_mark.line + 1)
            else:
                yield from self._below(value, (*names, name), depth + 1)

    def _pairs(self, node: yaml.Node | None) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            self._count()
            if isinstance(key, yaml.ScalarNode):
                yield key, value

    def _count(self) -> None:
        self._visits += 1
        if self._visits > _MOST_VISITS or self._characters > _MOST_CHARACTERS:
            raise _TooMuchError(f"the file means more than {_MOST_VISITS} values or is expanded endlessly")

    def _parameter(self, name: str, leaf: dict[str, yaml.Node], line: int) -> Parameter:
        description = leaf.get("description")
        documented_only = leaf["type"].value == _NOT_DECLARED
        return Parameter(
            name=name,
            type=None if documented_only else leaf["type"].value.partition("_fixed_")[0],
            default=self._written(leaf["default_value"], 0) if "default_value" in leaf else None,
            access=Access.READ if documented_only else Access.DECLARE,
            location=Location(self._path, line),
            resolution=Resolution.PARTIAL if is_partial(name) else Resolution.LITERAL,
            reason="it has the values of another parameter in it" if is_partial(name) else None,
            description=description.value.strip() or None if isinstance(description, yaml.ScalarNode) else None,
        )

    def _written(self, node: yaml.Node, depth: int) -> str:
        """Return a value as YAML on one line."""
        if depth > _MOST_DEPTH:
            raise _TooMuchError(f"the file is nested deeper than {_MOST_DEPTH} levels")
        self._count()
        if isinstance(node, yaml.SequenceNode):
            return f"[{', '.join(self._written(item, depth + 1) for item in node.value)}]"
        if isinstance(node, yaml.MappingNode):
            pairs = (f"{self._written(key, depth + 1)}: {self._written(value, depth + 1)}" for key, value in node.value)
            return f"{{{', '.join(pairs)}}}"
        self._characters += len(node.value)
        quoted = isinstance(node, yaml.ScalarNode) and node.tag == _TEXT and bool(node.style)
        return json.dumps(node.value, ensure_ascii=False) if quoted else str(node.value)
