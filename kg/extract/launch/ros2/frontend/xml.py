"""Launch files of ROS 2 in XML.

Source: `launch_xml`. An attribute `NAME-sep` splits the attribute `NAME` into a list.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.corpus.xml import line_of, parse_xml
from kg.extract.launch.ros2.context import place
from kg.extract.launch.ros2.frontend.build import build
from kg.extract.launch.ros2.frontend.element import Element
from kg.facts import LaunchProblem, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lxml.etree import _Element

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.frontend.element import Attribute

__all__ = ["read_xml"]

_SEPARATOR: Final = "-sep"
_MOST_DEPTH: Final = 100


def read_xml(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a file; what is malformed in it is among the `problems`, with its line."""
    result = parse_xml(text)
    if result.problem is not None:
        _, message, line = result.problem
        where = place(files, file, line or 1)
        problems.append(LaunchProblem(LaunchProblemKind.MALFORMED, f"the file {message}", where, subject=file.path))
        problems = []  # what is wrong behind that comes of it
    if result.root is None:
        return ()
    return build(_element(result.root, 0), lambda line: place(files, file, line), problems)


def _element(node: _Element, depth: int) -> Element:
    attributes: dict[str, Attribute] = {str(name): str(value) for name, value in node.attrib.items()}
    for name in [name for name in attributes if name.endswith(_SEPARATOR)]:
        separator = attributes.pop(name)
        whole = attributes.get(name.removesuffix(_SEPARATOR))
        if isinstance(whole, str) and isinstance(separator, str) and separator:
            attributes[name.removesuffix(_SEPARATOR)] = whole.split(separator)
    children = [child for child in node if isinstance(child.tag, str)] if depth < _MOST_DEPTH else []
    return Element(
        str(node.tag), line_of(node), attributes, children=tuple(_element(child, depth + 1) for child in children)
    )
