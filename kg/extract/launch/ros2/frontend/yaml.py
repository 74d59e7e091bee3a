"""Launch files of ROS 2 in YAML.

Source: `launch_yaml`. An action is a mapping of its name to its attributes, or to the list of its actions; a list of
mappings below an attribute are elements of that name (`param`, `remap`, `arg`), and below `children` actions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.launch.ros2.context import place
from kg.extract.launch.ros2.frontend.build import build
from kg.extract.launch.ros2.frontend.element import Element, Malformed
from kg.extract.launch.ros2.values import LOADER, of_yaml
from kg.facts import LaunchProblem, LaunchProblemKind
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.frontend.element import Attribute

__all__ = ["read_yaml"]

_CHILDREN: Final = "children"
_TEXT: Final = "tag:yaml.org,2002:str"
_MOST_DEPTH: Final = 100
_MOST_ELEMENTS: Final = 50_000


def read_yaml(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a file; what is malformed in it is among the `problems`, with its line."""
    try:
        root = _root(text)
    except Malformed as error:
        where = place(files, file, error.line)
        problems.append(LaunchProblem(LaunchProblemKind.MALFORMED, error.message, where, subject=file.path))
        return ()
    return build(root, lambda line: place(files, file, line), problems)


def _root(text: bytes) -> Element:
    try:
        document = compose_yaml(text.decode(), LOADER)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "cannot be parsed"
        raise Malformed(f"the file is no YAML: {problem}", mark.line + 1 if mark else 1) from error
    except RecursionError as error:
        raise Malformed("the file is nested too deep", 1) from error
    if document is None:
        raise Malformed("the file is empty", 1)
    return _Walk().action(document, 0)


class _Walk:
    """One walk over a document, which bounds what its aliases can make of it."""

    def __init__(self) -> None:
        self._count = 0

    def action(self, node: yaml.Node, depth: int) -> Element:
        """Return the action that a mapping of one key means."""
        pairs = list(self._pairs(node, depth))
        if len(pairs) != 1:
            raise Malformed("an action has to be a mapping with its name as the only key", _line(node))
        key, value = pairs[0]
        return self._element(key.value, value, _line(key), depth + 1)

    def _element(self, tag: str, node: yaml.Node, line: int, depth: int) -> Element:
        if isinstance(node, yaml.SequenceNode):
            return Element(tag, line, children=tuple(self.action(child, depth + 1) for child in node.value))
        if isinstance(node, yaml.ScalarNode) and node.value:
            raise Malformed(f"`{tag}` has to be a mapping or a list", line)
        attributes: dict[str, Attribute] = {}
        typed = set()
        children: list[Element] = []
        for key, value in self._pairs(node, depth):
            if _is_elements(value):
                children += self._below(key.value, value, depth)
            else:
                attributes[key.value] = _attribute(value, _line(key))
                if isinstance(value, yaml.ScalarNode) and value.tag != _TEXT:
                    typed.add(key.value)
        return Element(tag, line, attributes, frozenset(typed), tuple(children))

    def _below(self, name: str, node: yaml.Node, depth: int) -> Iterator[Element]:
        for child in node.value:
            if name == _CHILDREN:
                yield self.action(child, depth + 1)
            else:
                yield self._element(name, child, _line(child), depth + 1)

    def _pairs(self, node: yaml.Node, depth: int) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        if depth > _MOST_DEPTH:
            raise Malformed(f"the file is nested deeper than {_MOST_DEPTH} levels", _line(node))
        for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
            self._count += 1
            if self._count > _MOST_ELEMENTS:
                raise Malformed(f"the file means more than {_MOST_ELEMENTS} values", _line(key))
            if isinstance(key, yaml.ScalarNode):
                yield key, value


def _is_elements(node: yaml.Node) -> bool:
    return isinstance(node, yaml.SequenceNode) and any(isinstance(item, yaml.MappingNode) for item in node.value)


def _attribute(node: yaml.Node, line: int) -> Attribute:
    if isinstance(node, yaml.ScalarNode):
        return str(node.value)
    try:
        whole = of_yaml(node)[0]
    except ValueError as error:
        raise Malformed(f"a value is {error}", line) from error
    if not isinstance(node, yaml.SequenceNode):
        return whole
    return [item.value if isinstance(item, yaml.ScalarNode) else of_yaml(item)[0] for item in node.value]


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1
