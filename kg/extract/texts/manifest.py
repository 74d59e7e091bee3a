"""Descriptions in package.xml, in plugin descriptions and, where the manifest says nothing, in setup.py."""

from __future__ import annotations

import html
import re
from typing import TYPE_CHECKING, Final

from kg.extract.texts.paragraphs import plain
from kg.extract.texts.prose import is_prose, shortened
from kg.facts import Description, DescriptionKind, Location

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel
    from kg.facts import NodeType

__all__ = ["of_manifest", "of_plugins"]

_COMMENT: Final = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_ELEMENT: Final = re.compile(r"<description\b(?:[^>/]|/(?!>)){0,200}>(.*?)(?:</description\s*>|\Z)", re.DOTALL)
_BREAK: Final = re.compile(r"\n[ \t\r]*\n|</?(?:p|li|ul|ol|br|div|h\d|pre|table|tr)\b[^<>]{0,200}>|\Z", re.IGNORECASE)
_CDATA: Final = re.compile(r"<!\[CDATA\[|\]\]>")
_SETUP: Final = re.compile(r"""^\s*description\s*=\s*\(?\s*(['"])((?:(?!\1)[^\\\n]){5,600})\1""", re.MULTILINE)
_EMPTY: Final = re.compile(r"^\s*$|\bTODO\b|^The \S+ package\.?$|^\S+$|package description", re.IGNORECASE)
_LONGEST: Final = 40_000
"""Characters of a description that are looked at."""


def of_manifest(reader: Reader, package: PackageFolder) -> Iterator[Description]:
    """Yield the paragraphs of the description of the package, from setup.py where the manifest has none."""
    yield from list(_manifest(reader, package)) or _setup(reader, package)


def _manifest(reader: Reader, package: PackageFolder) -> Iterator[Description]:
    data = reader.read(package.manifest) if package.manifest else None
    text = _COMMENT.sub(_blank, data.decode()) if data else ""
    found = _ELEMENT.search(text)
    for line, said in _paragraphs(text, *found.span(1)) if found else ():
        if _is_description(said):
            yield Description(shortened(said), DescriptionKind.MANIFEST, Location(package.manifest or "", line))


def _blank(match: re.Match[str]) -> str:
    """Return as many line breaks as a comment has, so that lines keep their numbers."""
    return "\n" * match[0].count("\n")


def _is_description(text: str) -> bool:
    """Tell whether a manifest says something; two words do, for they stand where a description is asked for."""
    return not _EMPTY.search(text) and is_prose(f"It gives you {text}")


def _paragraphs(text: str, start: int, end: int) -> Iterator[tuple[int, str]]:
    """Yield the paragraphs between two places of a file with the lines that they begin at; XHTML becomes text."""
    end = min(end, start + _LONGEST)
    for gap in _BREAK.finditer(text, start, end):
        piece = text[start : gap.start()]
        said = html.unescape(plain(_CDATA.sub(" ", piece)))
        if said:
            begin = start + len(piece) - len(piece.lstrip())
            yield text.count("\n", 0, begin) + 1, said
        start = gap.end()


def of_plugins(build: BuildModel, nodes: tuple[NodeType, ...]) -> Iterator[Description]:
    """Yield what plugin descriptions say of the nodes that are loaded as plugins."""
    described = {plugin.name: plugin for plugin in build.plugins if plugin.description}
    for node in nodes:
        plugin = described.get(node.plugin or "")
        said = plain((plugin.description if plugin else None) or "")
        if plugin and _is_description(said):
            yield Description(shortened(said), DescriptionKind.PLUGIN, plugin.location, node.name)


def _setup(reader: Reader, package: PackageFolder) -> Iterator[Description]:
    path = package.join("setup.py")
    data = reader.read(path) if reader.workspace.entry(reader.file(path)) else None
    text = data.decode() if data else ""
    found = _SETUP.search(text)
    if found and _is_description(found[2]):
        line = text.count("\n", 0, found.start(2)) + 1
        yield Description(shortened(plain(found[2])), DescriptionKind.MANIFEST, Location(path, line))
