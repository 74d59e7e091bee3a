"""Descriptions of nodes in the pages of documentation of a package and of the folders around it."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, Final

from kg.extract.texts.naming import Names
from kg.extract.texts.pages import is_wiki, moin_markdown, read_page, wiki_nodes
from kg.extract.texts.paragraphs import plain
from kg.extract.texts.prose import is_prose, shortened
from kg.extract.texts.readme import About, find, usage
from kg.facts import Description, DescriptionKind, Location, NodeType
from kg.names import key

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import FilePath, PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.texts.readme import Passage

_SIGNS: Final = re.compile(r"^\s*(?:/\*\*?!?|///?|\*/|\*+(?=\s|$))?")
_COMMAND: Final = re.compile(r"^\s*[@\\](\w+)\s*(.*)$")
_LEVELS: Final = {"mainpage": 1, "page": 1, "section": 2, "subsection": 3, "subsubsection": 4, "par": 5}
_LABELLED: Final = frozenset({"page", "section", "subsection", "subsubsection"})
_FENCES: Final = frozenset({"verbatim", "endverbatim", "code", "endcode", "dot", "enddot"})
_TEXT_COMMANDS: Final = frozenset({"brief", "details", "b", "c", "e", "p", "a", "em", "ref", "note", "li", "i"})


def markdown(text: str) -> str:
    """Return a page of Doxygen as Markdown with the same lines; commands without text leave empty lines."""
    return "\n".join(_lines(text))


def _lines(text: str) -> Iterator[str]:
    for written in text.split("\n"):
        line = _SIGNS.sub("", written.rstrip().removesuffix("*/"), count=1)
        match = _COMMAND.match(line)
        if match is None:
            yield line.strip() if not line.lstrip().startswith(("-", "*")) else line
            continue
        word, rest = match[1].lower(), match[2].strip()
        if word in _LEVELS:
            title = rest.partition(" ")[2] or rest if word in _LABELLED else rest
            yield f"{'#' * _LEVELS[word]} {title}" if title and not title.startswith(("\\", "@")) else ""
        elif word in _FENCES:
            closed = any(f"{sign}end{word}" in rest for sign in "\\@")
            yield "" if closed else "```"
        else:
            yield line.strip() if word in _TEXT_COMMANDS else ""


_MOST_PAGES: Final = 300
"""Pages that are read for one package, the nearest first; no repository known has more around one."""
_LARGEST_PAGE: Final = 300_000
"""Bytes of a page that somebody wrote to be read; a larger one is a log or a table."""
_MAIN: Final = re.compile(r"readme|wiki|index\b|mainpage|about\b|overview", re.IGNORECASE)
_FOLDERS: Final = frozenset({"doc", "docs", "documentation", "doxygen"})


def of_documents(reader: Reader, package: PackageFolder, nodes: tuple[NodeType, ...]) -> Iterator[Description]:
    """Yield the paragraphs of pages that describe the package or one of its nodes."""
    own_key = key(package.name)
    own_keys = {own_key, key(posixpath.basename(reader.repository))}

    def is_neighbour(name: str) -> bool:
        return name != own_key and reader.workspace.is_package(reader.repository, name)

    names = Names(nodes, lambda name: name in own_keys or is_neighbour(name))
    for file in reader.workspace.documents(reader.repository, package.path)[:_MOST_PAGES]:
        own = reader.workspace.owner(file) == reader.place or reader.workspace.is_alone(reader.place)
        data = reader.read(file)
        if data is None or len(data) > _LARGEST_PAGE:
            continue
        if not (own or package.name.encode() in data or names.mentioned(data)):
            continue
        text = data.decode()
        about = About(names, package.name, is_neighbour, own=own and _is_main(file, package))
        yield from _of_page(file, text, about)


def _of_page(file: FilePath, text: str, about: About) -> Iterator[Description]:
    rst = file.path.endswith((".rst", ".txt"))
    if is_wiki(text):
        rst = False
        yield from _of_wiki(file, text, about)
        text = moin_markdown(text)
    elif file.path.endswith(".dox"):
        text = markdown(text)
    blocks = list(read_page(text, rst=rst))
    passages = list(find(blocks, about))
    yield from (_description(file, one, DescriptionKind.README) for one in passages)
    if about.own:
        remaining = usage(blocks, {one.line for one in passages})
        yield from (_description(file, one, DescriptionKind.USAGE) for one in remaining)


def _description(file: FilePath, passage: Passage, kind: DescriptionKind) -> Description:
    return Description(passage.text, kind, Location(file.path, passage.line), passage.node, passage.heading)


def _of_wiki(file: FilePath, text: str, about: About) -> Iterator[Description]:
    """Yield the wiki's descriptions of the nodes of the package."""
    for documented in wiki_nodes(text):
        description = plain(documented.description or "")
        if is_prose(description):
            for node in about.names.of_lead(documented.name or ""):
                place = Location(file.path, documented.line)
                yield Description(shortened(description), DescriptionKind.WIKI, place, node)


def _is_main(file: FilePath, package: PackageFolder) -> bool:
    """Return whether a page is the README of its package, or the first page of its documentation."""
    folder = posixpath.dirname(file.path)
    near = folder in {"", package.path} or posixpath.basename(folder).lower() in _FOLDERS
    return near and _MAIN.match(posixpath.basename(file.path)) is not None
