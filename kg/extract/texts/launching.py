"""Comments in launch files that stand directly above what starts a node of the package."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.extract.texts.paragraphs import joined, prose
from kg.facts import Description, DescriptionKind, FileKind, Location

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import NodeType

__all__ = ["of_launch_files"]

_COMMENT: Final = re.compile(r"<!--(.*?)(?:-->|\Z)", re.DOTALL)
_ELEMENT: Final = re.compile(r"[ \t]*\r?\n(?:[ \t]*\r?\n)?[ \t]*<(?:node|composable_node)\s([^<>]{1,1500})>")
_CALL: Final = re.compile(
    r"^[ \t]*(?:- )?(?:[\w.]+(?:\.append\(|\.add_action\(|\s*=\s*|\())?\[?[ \t]*(?:[\w.]*Node\(|node:)", re.MULTILINE
)
_MOST_LINES: Final = 40
"""Lines of comments above a start in code that are looked at."""
_ARGUMENT: Final = re.compile(r"""\b(pkg|package|type|exec|executable|plugin|args)\s*[=:]\s*["']?([^"'\n,)]{1,300})""")
_AHEAD: Final = 800
"""Characters in which the arguments of a node stand."""
_AMISS: Final = re.compile(
    r"[<>]|launch-prefix|uncomment|comment (?:in|out)|remap|roslaunch|\btrue\b|\bfalse\b|default"
    r"|^\W*(?:e\.g|note|set|if|change|use|args|see|only)\b",
    re.IGNORECASE,
)
"""Comments that are about how something is started, or are markup that was commented out."""
_FEWEST_SPACES: Final = 3
"""Shorter comments repeat the name (`start the node`)."""


def of_launch_files(reader: Reader, package: PackageFolder, nodes: tuple[NodeType, ...]) -> Iterator[Description]:
    """Yield the comments above those starts in the package's launch files that start one of its nodes."""
    known = _starts(nodes)
    for entry in package.files if known else ():
        data = reader.read(entry.path) if entry.kind is FileKind.LAUNCH else None
        if data is None or package.name.encode() not in data:
            continue
        text = data.decode()
        commented = _in_code if entry.path.endswith((".py", ".yaml", ".yml")) else _in_xml
        for comment, start, given in commented(text):
            node = _node(given, package.name, known)
            if node is not None:
                line = text.count("\n", 0, start) + 1
                yield from _descriptions(comment, line, entry.path, node)


def _in_xml(text: str) -> Iterator[tuple[str, int, str]]:
    """Yield the comments above elements that start nodes: text, where it begins, and the element's attributes."""
    for match in _COMMENT.finditer(text):
        element = _ELEMENT.match(text, match.end())
        if element:
            yield match[1], match.start(1), element[1]


def _in_code(text: str) -> Iterator[tuple[str, int, str]]:
    """Yield the comments above starts in Python or YAML: text, where it begins, and what follows."""
    for match in _CALL.finditer(text):
        first = match.start()
        for _ in range(_MOST_LINES):
            before = text.rfind("\n", 0, max(0, first - 1)) + 1
            if first == 0 or not text[before:first].lstrip().startswith("#"):
                break
            first = before
        if first < match.start():
            yield text[first : match.start()], first, text[match.end() : match.end() + _AHEAD]


def _starts(nodes: tuple[NodeType, ...]) -> dict[str, str]:
    """Return the nodes by what starts them: executables with and without `.py`, and plugins."""
    found: dict[str, str] = {}
    for node in nodes:
        for name in (node.executable, (node.executable or "").removesuffix(".py"), node.plugin):
            if name:
                found.setdefault(name, node.name)
    return found


def _node(given: str, package: str, known: dict[str, str]) -> str | None:
    arguments: dict[str, str] = {}
    for match in _ARGUMENT.finditer(given):
        arguments.setdefault(match[1], match[2].strip())
    home = arguments.get("pkg") or arguments.get("package")
    if home == "nodelet":
        loaded = (known.get(word) for word in arguments.get("args", "").split())
        return next((node for node in loaded if node is not None), None)
    words = (arguments.get(key, "") for key in ("type", "exec", "executable", "plugin"))
    return next((known[word] for word in words if word in known), None) if home == package else None


def _descriptions(comment: str, first: int, path: str, node: str) -> Iterator[Description]:
    lines = ((first + n, line.strip().lstrip("#")) for n, line in enumerate(comment.split("\n")))
    for one in prose(joined(lines)):
        if not _AMISS.search(one.text) and one.text.count(" ") >= _FEWEST_SPACES:
            yield Description(one.text, DescriptionKind.LAUNCH, Location(path, one.line), node)
