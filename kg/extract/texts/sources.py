"""Comments and docstrings of the sources of nodes: which of them are about which node.

A node has a file that it begins in, other sources, and files in which it makes interfaces. The header of a file is
about each node that begins there or whose source it is, unless these are many; the comment of a class is about the
node that is loaded as that class, or about the program that uses it.
"""

from __future__ import annotations

import posixpath
import re
from collections import Counter
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import last_part
from kg.extract.texts.paragraphs import Paragraph, joined, prose
from kg.facts import Description, DescriptionKind, FileKind, Location, NodeType
from kg.names import key

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel

_TOKENS: Final = re.compile(
    r"""//[^\n]*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'""",
    re.DOTALL,
)
_GAP: Final = re.compile(r"[ \t]*\n(?:[ \t]*\n)?[ \t]*")
_CLASS: Final = re.compile(
    r"(?:template\s*<[^{};]{0,200}>\s*)?(class|struct)\s+(?:\[\[[^\]]{0,60}\]\]\s*)?"
    r"(?:[A-Z][A-Z0-9_]+(?:\([^()]{0,60}\))?\s+)?(?:\w+::)*(\w+)(?:\s+final)?\s*(?=[:{])"
)
_SIGNS: Final = re.compile(r"^\s*(?:/\*+[!<]?|//[/!]*<?|\*+(?!\w*\*)/?)?[ \t]?")
"""The comment signs at the begin of a line."""
_MAIN: Final = re.compile(r"(?:int|void)\s+main\s*\(")
_NAMED: Final = re.compile(r"[@\\](?:class|struct)\s+(?:\w+::)*(\w+)")
_FILE: Final = re.compile(r"[@\\]file\b")
_BEFORE_CODE: Final = re.compile(r"(?:\s+|#\s*(?:ifndef|define|pragma|ifdef|if|endif)\b[^\n]*\n)*")
_LOOK_AHEAD: Final = 400
_DEEPEST_INDENTATION: Final = 300
_LONGEST_HEADER: Final = 40
"""Paragraphs of a header after which no more are looked for."""
_MOST_COMMENTS: Final = 4000
"""Comments of a file that are looked at, more than files of people have."""


@dataclass(frozen=True, slots=True)
class _Block:
    """A comment, or lines of `//` in a row: where it begins and ends in the text."""

    start: int
    end: int
    line: int


class Comments:
    """The comments of a file that are worth reading: its header, those of classes, and that of `main`."""

    def __init__(self, text: str) -> None:
        self._text = text
        self.header: list[Paragraph] = []
        self.classes: dict[str, list[Paragraph]] = {}
        self.structs: set[str] = set()
        self.main: list[Paragraph] = []
        at, top = 0, True
        for block in self._blocks():
            between = _BEFORE_CODE.match(text, at)
            top = top and between is not None and between.end() >= block.start
            at = block.end
            self._place(block, top=top)

    def _place(self, block: _Block, *, top: bool) -> None:
        text = self._text
        gap = _GAP.match(text, block.end)
        following = gap.end() if gap else block.end
        ahead = text[following : following + _LOOK_AHEAD]
        named = _NAMED.search(text, block.start, min(block.end, block.start + 4000))
        above = _CLASS.match(ahead)
        name = above[2] if above else named[1] if named else None
        if name is not None:
            if above and above[1] == "struct":
                self.structs.add(name)
            self.classes.setdefault(name, []).extend(self._paragraphs(block))
        elif _MAIN.match(ahead):
            self.main.extend(self._paragraphs(block))
        elif len(self.header) < _LONGEST_HEADER and (
            top or _FILE.search(text, block.start, min(block.end, block.start + 1000))
        ):
            self.header.extend(self._paragraphs(block))

    def _blocks(self) -> list[_Block]:
        """Return the comments that are alone on their lines; neighbouring line comments are one."""
        text = self._text
        blocks: list[_Block] = []
        line, counted = 1, 0
        for match in _TOKENS.finditer(text):
            start, end = match.span()
            if text[start] != "/" or not _begins_line(text, start):
                continue
            last = blocks[-1] if blocks else None
            lines = text.startswith("//", start)
            if lines and last and text.startswith("//", last.start) and _adjacent(text, last.end, start):
                blocks[-1] = _Block(last.start, end, last.line)
            elif len(blocks) >= _MOST_COMMENTS:
                break
            else:
                line += text.count("\n", counted, start)
                counted = start
                blocks.append(_Block(start, end, line))
        return blocks

    def _paragraphs(self, block: _Block) -> list[Paragraph]:
        lines = self._text[block.start : block.end].split("\n")
        bare = (_SIGNS.sub("", line.rstrip().removesuffix("*/"), count=1) for line in lines)
        return list(prose(joined(enumerate(bare, block.line))))


def _begins_line(text: str, start: int) -> bool:
    """Return whether only white space is before a place in its line, of which so much is looked at."""
    nearest = max(0, start - _DEEPEST_INDENTATION)
    before = text.rfind("\n", nearest, start)
    return (before >= 0 or nearest == 0) and not text[before + 1 : start].strip()


def _adjacent(text: str, end: int, start: int) -> bool:
    between = text[end:start]
    return between.count("\n") == 1 and not between.strip()


_DOCSTRING: Final = re.compile(r'[rRuU]?("""|\'\'\'|"(?!")|\'(?!\'))(.*?)(?<!\\)\1', re.DOTALL)
_HEAD: Final = re.compile(r"(?:[ \t]*(?:#[^\n]*)?\n|from __future__ import[^\n]*\n)*")
_DEFINED: Final = re.compile(r"^[ \t]*(class|def)[ \t]+(\w+)[^\n]{0,400}", re.MULTILINE)
_BODY: Final = re.compile(r"(?:[^\n:]|:(?![ \t]*(?:#[^\n]*)?\n))*:[ \t]*(?:#[^\n]*)?\n(?:[ \t]*(?:#[^\n]*)?\n)*[ \t]*")
_LONGEST_HEAD: Final = 1500
"""Characters that the line of a class or function may take up to its body."""
_LONGEST_DOCSTRING: Final = 40_000
_MOST_DEFINED: Final = 1000
"""Classes and functions of a file that are looked at, more than files of people have."""


class Docstrings:
    """Documentation in a Python file: comments (`header`), and docstrings by the names that they document."""

    def __init__(self, text: str) -> None:
        self._text = text
        head = _HEAD.match(text)
        self._end = head.end() if head else 0
        self.header = list(prose(joined(self._comments(0, self._end))))
        self.module = self._docstring(self._end)
        self.classes: dict[str, list[Paragraph]] = {}
        self.functions: dict[str, list[Paragraph]] = {}
        for match in islice(_DEFINED.finditer(text), _MOST_DEFINED):
            self._defined(match)

    def _defined(self, match: re.Match[str]) -> None:
        inside = match[0][0] in " \t"
        if match[1] == "def" and inside:
            return
        body = _BODY.match(self._text, match.start(), match.start() + _LONGEST_HEAD)
        paragraphs = self._docstring(body.end()) if body else []
        above = self._above(match.start())
        definitions = self.classes if match[1] == "class" else self.functions
        definitions.setdefault(match[2], []).extend([*above, *paragraphs])

    def _above(self, start: int) -> list[Paragraph]:
        """Return the paragraphs of the comment lines directly above a place, unless they are the file's header."""
        first = start
        while first > self._end:
            before = self._text.rfind("\n", 0, first - 1) + 1
            if not self._text[before:first].lstrip().startswith("#"):
                break
            first = before
        return list(prose(joined(self._comments(first, start)))) if first < start and first > self._end else []

    def _comments(self, start: int, end: int) -> Iterator[tuple[int, str]]:
        line = self._text.count("\n", 0, start) + 1
        for number, written in enumerate(self._text[start:end].split("\n"), line):
            text = written.strip()
            yield number, "" if text.startswith("#!") or not text.startswith("#") else text.lstrip("#")

    def _docstring(self, start: int) -> list[Paragraph]:
        match = _DOCSTRING.match(self._text, start, start + _LONGEST_DOCSTRING)
        if not match or (len(match[1]) == 1 and "\n" in match[2]):
            return []
        line = self._text.count("\n", 0, match.start(2)) + 1
        return list(prose(joined(enumerate(match[2].split("\n"), line))))


_MOST_NODES: Final = 3
"""A file that is a source of more nodes than these is about none of them."""
_MOST_FILES: Final = 12
"""Files of a node that are looked at: beginning, sources, and where its interfaces stand."""
_ROLE: Final = re.compile(r"_?(?:nodelet|node|component|class|impl|ros|main|core|app|plugin)$")
_HELPER: Final = re.compile(
    r"(?:Error|Exception|Enum|Test|TestCase|Struct|Params?|Config|Data|State|Traits|Options|Results?|Visitor|Thread)$"
)
"""Ends of the names of classes that are part of a program and never the program."""


@dataclass(slots=True)
class _Sources:
    """The comments of the files of a package, each read on first use."""

    reader: Reader
    package: PackageFolder
    classes: dict[str, str]
    """The C++ class of each plugin."""
    uses: Counter[str] = field(default_factory=Counter)
    """Of how many nodes a file is a source."""
    makers: Counter[str] = field(default_factory=Counter)
    """Of how many nodes interfaces are made in a file."""
    _cpp: dict[str, Comments | None] = field(default_factory=dict)
    _python: dict[str, Docstrings | None] = field(default_factory=dict)
    _texts: dict[str, str | None] = field(default_factory=dict)
    _stems: dict[str, list[str]] = field(default_factory=dict)

    def text(self, path: str) -> str | None:
        """Return the text of a file of the build, None where it cannot be read."""
        if path not in self._texts:
            exists = self.reader.workspace.entry(self.reader.file(path)) is not None
            data = self.reader.read(path) if exists else None
            self._texts[path] = data.decode() if data is not None else None
        return self._texts[path]

    def cpp(self, path: str) -> Comments | None:
        """Return the comments of a C++ file."""
        if path not in self._cpp:
            text = self.text(path)
            self._cpp[path] = Comments(text) if text else None
        return self._cpp[path]

    def python(self, path: str) -> Docstrings | None:
        """Return the docstrings and comments of a Python file."""
        if path not in self._python:
            text = self.text(path)
            self._python[path] = Docstrings(text) if text else None
        return self._python[path]

    def headers(self, path: str) -> list[str]:
        """Return the other C++ files of the package that have the name of a file, without its ending."""
        if not self._stems:
            for entry in self.package.files:
                if entry.kind is FileKind.CPP:
                    self._stems.setdefault(_stem(entry.path), []).append(entry.path)
        return [one for one in self._stems.get(_stem(path), ()) if one != path]


def of_sources(
    reader: Reader, package: PackageFolder, build: BuildModel, nodes: tuple[NodeType, ...]
) -> Iterator[Description]:
    """Yield descriptions of nodes from the comments and docstrings in their sources."""
    sources = _Sources(reader, package, {plugin.name: last_part(plugin.type) for plugin in build.plugins})
    for node in nodes:
        sources.uses.update({node.location.path, *node.sources})
        sources.makers.update(set(_interface_files(node)) - {node.location.path, *node.sources})
    functions = {entry.name: entry.function for entry in build.entry_points}
    for node in nodes:
        if node.location.repository is not None:
            continue
        if node.language == "python":
            yield from _python(sources, node, functions.get(node.executable or ""))
        else:
            yield from _cpp(sources, node)


def _cpp(sources: _Sources, node: NodeType) -> Iterator[Description]:
    files = _files(node)
    files = list(dict.fromkeys(path for file in files for path in (file, *sources.headers(file))))[:_MOST_FILES]
    main = sources.text(node.location.path) or ""
    # The classes that a program may be are where it begins, and where few programs make interfaces.
    own = (path for path in _interface_files(node) if sources.uses[path] + sources.makers[path] <= _MOST_NODES)
    used = {_stem(path) for path in (node.location.path, *own)}
    for path in files:
        comments = sources.cpp(path)
        if comments is None:
            continue
        if _is_own(sources, node, path):
            yield from _descriptions(node, path, comments.header)
        if path == node.location.path:
            yield from _descriptions(node, path, comments.main)
        near = _stem(path) in used
        for name, paragraphs in comments.classes.items():
            if _is_class_of(sources, node, name, main if near and name not in comments.structs else ""):
                yield from _descriptions(node, path, paragraphs)


def _files(node: NodeType) -> list[str]:
    """Return the files of a node: where it begins, its sources, and where it makes interfaces itself."""
    return list(dict.fromkeys([node.location.path, *node.sources, *_interface_files(node)]))[:_MOST_FILES]


def _interface_files(node: NodeType) -> list[str]:
    """Return the files of the source in which a node makes interfaces itself."""
    locations = (one.location for one in node.interfaces if not one.implicit)
    return list(dict.fromkeys(place.path for place in locations if place.repository is None))


def _is_own(sources: _Sources, node: NodeType, path: str) -> bool:
    """Return whether the header of a file is about a node: it begins there, or the file has its name."""
    if sources.uses[path] > _MOST_NODES:
        return False
    methods = node.plugin is not None and path in node.sources
    return path == node.location.path or methods or _alike(_stem(path), node)


def _is_class_of(sources: _Sources, node: NodeType, name: str, main: str) -> bool:
    if node.plugin is not None:
        return name == (sources.classes.get(node.plugin) or last_part(node.plugin))
    if node.executable is None and node.language != "python":
        return name == node.name
    if _alike(name, node):
        return True
    return bool(main) and not _HELPER.search(name) and re.search(rf"\b{re.escape(name)}\b", main) is not None


def _alike(name: str, node: NodeType) -> bool:
    """Return whether a class or file has the name of a node, but for words as `node` and `ros`."""
    names = {one for one in (node.name, node.executable, node.node_name, last_part(node.plugin or "")) if one}
    return _core(name) in {_core(one.removesuffix(".py")) for one in names}


def _core(name: str) -> str:
    short = key(name)
    for _ in range(2):
        short = _ROLE.sub("", short) or short
    return short


def _python(sources: _Sources, node: NodeType, function: str | None) -> Iterator[Description]:
    for path in _files(node):
        texts = sources.python(path)
        if texts is None:
            continue
        if _is_own(sources, node, path):
            yield from _descriptions(node, path, texts.header)
            yield from _descriptions(node, path, texts.module, DescriptionKind.DOCSTRING)
        if path == node.location.path:
            for name in dict.fromkeys((function or "main", "main")):
                yield from _descriptions(node, path, texts.functions.get(name, ()), DescriptionKind.DOCSTRING)
        text = (sources.text(path) or "") if path == node.location.path else ""
        for name, paragraphs in texts.classes.items():
            if _is_class_of(sources, node, name, text):
                yield from _descriptions(node, path, paragraphs, DescriptionKind.DOCSTRING)


def _descriptions(
    node: NodeType, path: str, paragraphs: Iterable[Paragraph], kind: DescriptionKind = DescriptionKind.COMMENT
) -> Iterator[Description]:
    return (Description(one.text, kind, Location(path, one.line), node.name) for one in paragraphs)


def _stem(path: str) -> str:
    return posixpath.basename(path).partition(".")[0]
