"""The descriptions of a package and its nodes, from all texts that the package and its repository have about them."""

from __future__ import annotations

import html
import re
from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.extract.texts.documents import of_documents
from kg.extract.texts.paragraphs import joined, plain, prose
from kg.extract.texts.prose import is_prose, shortened
from kg.extract.texts.sources import of_sources
from kg.facts import Description, DescriptionKind, FileKind, Location, NodeType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel

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
    starts = _starts(nodes)
    for entry in package.files if starts else ():
        data = reader.read(entry.path) if entry.kind is FileKind.LAUNCH else None
        if data is None or package.name.encode() not in data:
            continue
        text = data.decode()
        commented = _in_code if entry.path.endswith((".py", ".yaml", ".yml")) else _in_xml
        for comment, start, given in commented(text):
            node = _node(given, package.name, starts)
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
    """Return the nodes by their starting names: executables with and without `.py`, and plugins."""
    starts: dict[str, str] = {}
    for node in nodes:
        for name in (node.executable, (node.executable or "").removesuffix(".py"), node.plugin):
            if name:
                starts.setdefault(name, node.name)
    return starts


def _node(given: str, package: str, starts: dict[str, str]) -> str | None:
    arguments: dict[str, str] = {}
    for match in _ARGUMENT.finditer(given):
        arguments.setdefault(match[1], match[2].strip())
    home = arguments.get("pkg") or arguments.get("package")
    if home == "nodelet":
        loaded = (starts.get(word) for word in arguments.get("args", "").split())
        return next((node for node in loaded if node is not None), None)
    words = (arguments.get(key, "") for key in ("type", "exec", "executable", "plugin"))
    return next((starts[word] for word in words if word in starts), None) if home == package else None


def _descriptions(comment: str, first: int, path: str, node: str) -> Iterator[Description]:
    lines = ((first + n, line.strip().lstrip("#")) for n, line in enumerate(comment.split("\n")))
    for one in prose(joined(lines)):
        if not _AMISS.search(one.text) and one.text.count(" ") >= _FEWEST_SPACES:
            yield Description(one.text, DescriptionKind.LAUNCH, Location(path, one.line), node)


_DESCRIPTION: Final = re.compile(r"<description\b(?:[^>/]|/(?!>)){0,200}>(.*?)(?:</description\s*>|\Z)", re.DOTALL)
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
    # Comments become as many line breaks as they have, so that lines keep their numbers.
    text = _COMMENT.sub(lambda match: "\n" * match[0].count("\n"), data.decode()) if data else ""
    found = _DESCRIPTION.search(text)
    for line, paragraph in _paragraphs(text, *found.span(1)) if found else ():
        if _is_description(paragraph):
            yield Description(shortened(paragraph), DescriptionKind.MANIFEST, Location(package.manifest or "", line))


def _is_description(text: str) -> bool:
    """Return whether a manifest has a description; two words suffice in a field meant for descriptions."""
    return not _EMPTY.search(text) and is_prose(f"It gives you {text}")


def _paragraphs(text: str, start: int, end: int) -> Iterator[tuple[int, str]]:
    """Yield the paragraphs between two places of a file with the lines that they begin at; XHTML becomes text."""
    end = min(end, start + _LONGEST)
    for gap in _BREAK.finditer(text, start, end):
        piece = text[start : gap.start()]
        paragraph = html.unescape(plain(_CDATA.sub(" ", piece)))
        if paragraph:
            begin = start + len(piece) - len(piece.lstrip())
            yield text.count("\n", 0, begin) + 1, paragraph
        start = gap.end()


def of_plugins(build: BuildModel, nodes: tuple[NodeType, ...]) -> Iterator[Description]:
    """Yield descriptions of the nodes loaded as plugins, from plugin descriptions."""
    described = {plugin.name: plugin for plugin in build.plugins if plugin.description}
    for node in nodes:
        plugin = described.get(node.plugin or "")
        description = plain((plugin.description if plugin else None) or "")
        if plugin and _is_description(description):
            yield Description(shortened(description), DescriptionKind.PLUGIN, plugin.location, node.name)


def _setup(reader: Reader, package: PackageFolder) -> Iterator[Description]:
    path = package.join("setup.py")
    data = reader.read(path) if reader.workspace.owner(reader.file(path)) else None
    text = data.decode() if data else ""
    match = _SETUP.search(text)
    if match and _is_description(match[2]):
        line = text.count("\n", 0, match.start(2)) + 1
        yield Description(shortened(plain(match[2])), DescriptionKind.MANIFEST, Location(path, line))


MOST_OF_ONE: Final = 24
"""Paragraphs that are kept of one node, of the package, and of its usage: what it does is told in the first of them."""


def read_descriptions(
    reader: Reader, package: PackageFolder, build: BuildModel, nodes: tuple[NodeType, ...]
) -> tuple[Description, ...]:
    """Return the descriptions of a package and its nodes, in the order of the places; repeated ones once.

    Texts are read as `reader` reads them, so that each is an input of the result. Nothing in them makes it raise.
    """
    descriptions = [
        *of_manifest(reader, package),
        *of_plugins(build, nodes),
        *of_sources(reader, package, build, nodes),
        *of_documents(reader, package, nodes),
        *of_launch_files(reader, package, nodes),
    ]
    return tuple(
        sorted(_bounded(descriptions), key=lambda one: (one.location.path, one.location.line, one.node or "", one.text))
    )


def _bounded(descriptions: Iterable[Description]) -> Iterator[Description]:
    seen: set[tuple[str | None, str]] = set()
    counts: Counter[tuple[str | None, bool]] = Counter()
    for one in descriptions:
        key = (one.node, one.text.casefold())
        kind = (one.node, one.kind is DescriptionKind.USAGE)
        if key not in seen and counts[kind] < MOST_OF_ONE:
            seen.add(key)
            counts[kind] += 1
            yield one
