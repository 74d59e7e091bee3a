"""Macros and properties that are used before they are defined, as xacro allowed before its release for ROS Jade.

It read all includes, then all macros and properties, and evaluated after that; the last definition counted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.xacro.document import DESCRIPTION, Element
from kg.extract.launch.xacro.macros import grab_macro
from kg.extract.launch.xacro.table import Block, Table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.xacro.loading import Loading
    from kg.extract.launch.xacro.texts import Texts

__all__ = ["collect"]

_MOST_FILES: Final = 500
_MOST_ELEMENTS: Final = 100_000


def collect(file: FilePath, files: Files, loading: Loading, texts: Texts) -> Table:
    """Return a scope with every macro and property of a file and what it includes."""
    table = Table(texts.value)
    waiting, seen, count = [file], {file}, 0
    while waiting:
        current = waiting.pop(0)
        data = loading.data(current)
        root = DESCRIPTION.read(data).root if data is not None else None
        for element in _commands(root) if root is not None else ():
            count += 1
            if count > _MOST_ELEMENTS:
                return table
            found = _define(table, element, current)
            if found is None:
                continue
            included = loading.find(texts.text(found, table), files.folder(current)).file
            if included is not None and included not in seen and len(seen) < _MOST_FILES:
                seen.add(included)
                waiting.append(included)
    return table


def _define(table: Table, element: Element, file: FilePath) -> str | None:
    """Keep a macro or property; return what an include names."""
    attributes = element.attributes
    if element.command == "macro":
        macro = grab_macro(element, file)
        table.macros[macro.name] = macro
    elif element.command == "property" and "value" in attributes:
        table.set(attributes.get("name", ""), attributes["value"], lazy=True)
    elif element.command == "property":
        table.blocks[attributes.get("name", "")] = Block(tuple(element.children), None, file)
    elif element.command == "include" and "ns" not in attributes:
        return attributes.get("filename")
    return None


def _commands(root: Element) -> Iterator[Element]:
    """Yield the elements that are not part of a macro, in the order of the file."""
    waiting = [root]
    while waiting:
        element = waiting.pop()
        yield element
        if element.command != "macro":
            waiting.extend(reversed(list(element.elements())))
