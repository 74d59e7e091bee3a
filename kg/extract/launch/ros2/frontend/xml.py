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
    deep: list[int] = []
    root = _element(result.root, 0, deep)
    if deep:
        message = f"elements are nested deeper than {_MOST_DEPTH} levels"
        problems.append(LaunchProblem(LaunchProblemKind.LIMIT, message, place(files, file, deep[0]), subject=file.path))
    return build(root, lambda line: place(files, file, line), problems)


def _element(node: _Element, depth: int, deep: list[int]) -> Element:
    """Return an element with all below; `deep` collects the lines of those that are nested too deep to be read."""
    written = {str(name): str(value) for name, value in node.attrib.items()}
    attributes: dict[str, Attribute] = {name: value for name, value in written.items() if not name.endswith(_SEPARATOR)}
    for name, separator in written.items():
        whole = name.removesuffix(_SEPARATOR)
        if name.endswith(_SEPARATOR) and whole in written and separator:
            attributes[whole] = written[whole].split(separator)
    children = list(node.iterchildren("*"))
    if depth >= _MOST_DEPTH:
        deep.extend(line_of(child) for child in children)
        children = []
    below = tuple(_element(child, depth + 1, deep) for child in children)
    return Element(str(node.tag), line_of(node), attributes, children=below)
