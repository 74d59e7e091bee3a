"""Pages of documentation as blocks: headings, paragraphs, list items and rows of tables, with their lines.

One reader takes Markdown (CommonMark's blocks as far as prose needs them), reStructuredText and plain text, and
Doxygen's pages after their commands became headings. It goes over the lines once and keeps no tree, so nothing nests.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_BEGIN: Final = re.compile(r"#!\s*clearsilver\s+CS/(?:Node|Nodelet)?API", re.IGNORECASE)
_END: Final = re.compile(r"^\s*\}\}\}|^\s*```")
_OPEN: Final = re.compile(r"^([\w.\-]+)\s*\{\s*(.*)$")
_ASSIGN: Final = re.compile(r"^([\w.\-]+)\s*:?=\s*(.*)$")
_LONG: Final = re.compile(r"^([\w.\-]+)\s*<<\s*(\w+)\s*$")
_DEEPEST: Final = 12
"""Blocks within blocks; `node.0 { param { group.0 { 1 {` are four."""
_MOST_LINES: Final = 20_000
_NODE: Final = re.compile(r"^(node(?:let)?s?\.\d+)\.(.+)$")
_ENTRY: Final = re.compile(r"^(\w+)((?:\.group\.\d+)?\.\d+)\.(\w+)$")
_KINDS: Final = {
    "pub": "publishes",
    "sub": "subscribes",
    "srv": "services",
    "srv_called": "clients",
    "goal": "action_servers",
    "act": "action_servers",
    "act_called": "action_clients",
    "param": "parameters",
    "req_tf": "required_transforms",
    "prov_tf": "provided_transforms",
}


@dataclass(frozen=True, slots=True)
class WikiEntry:
    """An entry of a node on a wiki page: a topic, service, action, parameter or transform.

    `kind` is a role as in `kg nodes --json` (`publishes`, `services`, ...), `parameters`, or `required_transforms`
    and `provided_transforms`, whose `name` is `from -> to`. `type` is as written, None where it is missing.
    """

    kind: str
    name: str
    type: str | None
    description: str | None
    line: int
    default: str | None = None


@dataclass(frozen=True, slots=True)
class WikiNode:
    """A node as a wiki page documents it; `line` is that of its name, or the first of its block."""

    name: str | None
    description: str | None
    line: int
    entries: tuple[WikiEntry, ...] = ()


@dataclass(frozen=True, slots=True)
class _Value:
    """A value and the line that it begins at."""

    text: str
    line: int


def is_wiki(text: str) -> bool:
    """Return whether a text is a page of the ROS wiki."""
    return _BEGIN.search(text) is not None or "<<PackageHeader(" in text or "<<StackHeader(" in text


def wiki_nodes(text: str) -> tuple[WikiNode, ...]:
    """Return the nodes that the blocks of a page document, in their order; malformed lines are passed over."""
    lines = text.split("\n", _MOST_LINES)[:_MOST_LINES]
    nodes: list[WikiNode] = []
    for number, line in enumerate(lines):
        if _BEGIN.search(line):
            nodes.extend(_nodes(_values(lines, number + 1), number + 1))
    return tuple(nodes)


def _values(lines: list[str], start: int) -> dict[str, _Value]:
    """Return the values of a block by their whole keys."""
    values: dict[str, _Value] = {}
    scope: list[str] = []
    at = start
    while at < len(lines) and not _END.match(lines[at]) and not _BEGIN.search(lines[at]):
        line, number = lines[at].strip(), at + 1
        at += 1
        long = _LONG.match(line)
        if long:
            end = next((n for n in range(at, len(lines)) if lines[n].strip() == long[2]), len(lines))
            values.setdefault(_key(scope, long[1]), _Value(" ".join(lines[at:end]).strip(), number))
            at = end + 1
        else:
            _take_wiki(line, number, scope, values)
    return values


def _take_wiki(line: str, number: int, scope: list[str], values: dict[str, _Value]) -> None:
    """Take a line: several blocks may open or close on it, and a value runs to its end."""
    while line and not line.startswith("#"):
        opened, assigned = _OPEN.match(line), _ASSIGN.match(line)
        if opened:
            if len(scope) < _DEEPEST:
                scope.append(opened[1])
            line = opened[2]
        elif line.startswith("}"):
            if scope:
                scope.pop()
            line = line[1:].lstrip()
        else:
            if assigned and assigned[2]:
                closes = assigned[2].endswith("}") and "{" not in assigned[2] and bool(scope)
                value = assigned[2].removesuffix("}") if closes else assigned[2]
                values.setdefault(_key(scope, assigned[1]), _Value(value.strip(), number))
                if closes:
                    scope.pop()
            return


def _key(scope: list[str], key: str) -> str:
    return ".".join([*scope, key])


def _nodes(values: dict[str, _Value], line: int) -> Iterator[WikiNode]:
    """Yield the nodes of a block; values outside of `node.0` are of one node."""
    grouped: dict[str, dict[str, _Value]] = {}
    for key, value in values.items():
        inside = _NODE.match(key)
        grouped.setdefault(inside[1] if inside else "", {})[inside[2] if inside else key] = value
    for own in grouped.values():
        name, description = own.get("name"), own.get("desc")
        entries = tuple(_entries(own))
        if name or description or entries:
            first = name or description or _Value("", line)
            yield WikiNode(name.text if name else None, description.text if description else None, first.line, entries)


def _entries(values: dict[str, _Value]) -> Iterator[WikiEntry]:
    grouped: dict[tuple[str, str], dict[str, _Value]] = {}
    for key, value in values.items():
        match = _ENTRY.match(key)
        if match and match[1] in _KINDS:
            grouped.setdefault((match[1], match[2]), {})[match[3]] = value
    for (kind, _), fields in grouped.items():
        name, source, target = (fields.get(key) for key in ("name", "from", "to"))
        if name is None and source and target:
            name = _Value(f"{source.text} -> {target.text}", source.line)
        if name:
            text = {key: fields[key].text for key in ("type", "desc", "default") if key in fields}
            yield WikiEntry(_KINDS[kind], name.text, text.get("type"), text.get("desc"), name.line, text.get("default"))


_HEADING: Final = re.compile(r"^\s*(={1,5})\s+(.{1,300}?)\s+\1\s*$")
_INLINE: Final = re.compile(r"\{\{\{([^{}]{1,200})\}\}\}")
_MACRO: Final = re.compile(r"<<(\w+)\(([^()<>]{0,300})\)>>")
_ATTACHED: Final = re.compile(r"\{\{[^{}]{1,300}\}\}")
_LINK: Final = re.compile(r"\[\[([^\[\]|]{1,300})(?:\|([^\[\]|]{1,300}))?[^\[\]]{0,100}\]\]")
_LITERAL_MACROS: Final = frozenset({"MsgLink", "SrvLink", "NodeLink", "ActionLink"})


def moin_markdown(text: str) -> str:
    """Return a page of MoinMoin (moinmo.in/HelpOnMoinWikiSyntax) as Markdown with the same lines."""
    return "\n".join(_moin_lines(text.split("\n")))


def _moin_lines(lines: Iterable[str]) -> Iterator[str]:
    fenced = False
    for line in lines:
        if fenced:
            fenced = "}}}" not in line
            yield "" if fenced else "```"
        elif line.lstrip().startswith("{{{") and "}}}" not in line:
            fenced = True
            yield "```"
        else:
            heading = _HEADING.match(line)
            yield f"{'#' * len(heading[1])} {heading[2]}" if heading else _inline(line)


def _inline(line: str) -> str:
    line = _INLINE.sub(r"`\1`", line)
    line = _LINK.sub(lambda match: match[2] or match[1], line)
    line = _MACRO.sub(lambda match: match[2] if match[1] in _LITERAL_MACROS else "", line)
    return _ATTACHED.sub("", line).replace("'''", "**").replace("''", "*").replace("||", "|")


MOST_LINES: Final = 5000
"""Lines of a page that are looked at."""
LONGEST_LINE: Final = 4000
"""Characters of a line that are looked at: paragraphs without line breaks have about 2,000."""


class BlockKind(StrEnum):
    """The kind of a block of a page."""

    HEADING = "heading"
    PARAGRAPH = "paragraph"
    ITEM = "item"
    CONTINUED = "continued"
    """A paragraph that goes on with the item above it, of which it can say anything."""
    ROW = "row"


@dataclass(frozen=True, slots=True)
class Block:
    """A block as it is written, without the signs that make it one: cells of a row are parted by tabs.

    `level` is the depth of a heading (1 for the title), or that of a list item.
    """

    kind: BlockKind
    text: str
    line: int
    level: int = 0


_FENCE: Final = re.compile(r"^\s{0,12}(`{3,}|~{3,})")
_ATX: Final = re.compile(r"^ {0,3}(#{1,6})(?:[ \t]+|(?=\w))(.*?)[ \t#]*$")
_UNDERLINE: Final = re.compile(r"^([=\-~^\"'`#*+.:_])\1{2,}\s*$")
_ITEM: Final = re.compile(r"^(\s*)(?:[-*+•]|\d{1,3}[.)]|#\.)\s+(.*)$")
_RULE: Final = re.compile(r"^\s*(?:(?:\*\s*){3,}|(?:-\s*){3,}|(?:_\s*){3,})$")
_DELIMITERS: Final = re.compile(r"^\s*\|?\s*:?-{2,}:?\s*(?:\|\s*:?-*:?\s*)*$")
_DIRECTIVE: Final = re.compile(r"^(\s*)\.\.(?:\s|$)")
_DEFINITION: Final = re.compile(r"^\s{0,3}\[[^\]]{1,200}\]:\s")
_HTML_HEADING: Final = re.compile(r"<h([1-6])\b[^>]{0,200}>(.{0,400}?)</h\1>", re.IGNORECASE)
_COMMENT: Final = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_GRID: Final = re.compile(r"^\s*\+[-=+]+\+\s*$")
_SIMPLE_TABLE: Final = re.compile(r"^\s*=+(?:\s+=+)+\s*$")


@dataclass(slots=True)
class _Page:
    """The state of the pass over the lines."""

    rst: bool
    blocks: list[Block] = field(default_factory=list)
    gathered: list[str] = field(default_factory=list)
    first: int = 0
    kind: BlockKind = BlockKind.PARAGRAPH
    level: int = 0
    fence: str = ""
    literal: int = -1
    """The indentation above which lines belong to a literal block or directive, -1 outside of one."""
    adornments: list[str] = field(default_factory=list)
    blank: bool = True

    def end(self) -> None:
        """Finish the block that lines were gathered for."""
        if self.gathered:
            self.blocks.append(Block(self.kind, " ".join(self.gathered), self.first, self.level))
        self.gathered, self.kind, self.level = [], BlockKind.PARAGRAPH, 0

    def gather(self, line: int, text: str) -> None:
        """Add a line to the block."""
        if not self.gathered:
            self.first = line
        self.gathered.append(text.strip())

    def begin(self, kind: BlockKind, line: int, text: str, level: int = 0) -> None:
        """Begin a block with its first line."""
        self.end()
        self.kind, self.level = kind, level
        self.gather(line, text)

    def heading(self, line: int, text: str, level: int) -> None:
        """Add a heading."""
        self.end()
        self.blocks.append(Block(BlockKind.HEADING, text.strip(), line, level))

    def level_of(self, adornment: str) -> int:
        """Return the level of an underlined heading: of reStructuredText by the order in which signs appear."""
        if not self.rst:
            return 1 if adornment == "=" else 2
        if adornment not in self.adornments:
            self.adornments.append(adornment)
        return self.adornments.index(adornment) + 1


def read_page(text: str, *, rst: bool = False) -> tuple[Block, ...]:
    """Return the blocks of a page; code blocks, comments, directives and definitions of links are left out."""
    page = _Page(rst)
    without = _COMMENT.sub(lambda match: "\n" * match[0].count("\n"), text) if "<!--" in text else text
    for number, written in enumerate(without.split("\n", MOST_LINES)[:MOST_LINES], 1):
        line = written[:LONGEST_LINE].rstrip().expandtabs(4)
        if not _skipped(page, line):
            _take(page, number, line)
        page.blank = not line
    page.end()
    return tuple(page.blocks)


def _skipped(page: _Page, line: str) -> bool:
    """Return whether a line belongs to code, a directive or a definition, and keep in mind where these end."""
    start = line.lstrip()[:1]
    fence = _FENCE.match(line) if start in "`~" else None
    if page.fence:
        if fence and fence[1].startswith(page.fence):
            page.fence = ""
        return True
    if fence:
        page.end()
        page.fence = fence[1]
        return True
    indentation = len(line) - len(line.lstrip())
    if page.literal >= 0 and line:
        if indentation > page.literal:
            return True
        page.literal = -1
    directive = _DIRECTIVE.match(line) if page.rst else None
    if directive:
        page.end()
        page.literal = len(directive[1])
        return True
    indented = indentation >= 4 and page.blank and page.kind is not BlockKind.ITEM and not _ITEM.match(line)  # noqa: PLR2004 - CommonMark 4.4
    return (indented and not page.gathered and not page.rst) or (start == "[" and _DEFINITION.match(line) is not None)


def _take(page: _Page, number: int, line: str) -> None:
    if not line:
        page.end()
        return
    if line.lstrip()[0].isalpha() and "|" not in line:
        _gather(page, number, line)
        return
    underline = _UNDERLINE.match(line)
    if underline:
        _underlined(page, underline[1])
        return
    atx = None
    if not page.rst:
        atx = _ATX.match(line) or (_HTML_HEADING.search(line) if "<h" in line.lower() else None)
    item = _ITEM.match(line)
    if atx:
        page.heading(number, atx[2], len(atx[1]) if atx[1].startswith("#") else int(atx[1]))
    elif _RULE.match(line) or _DELIMITERS.match(line) or _GRID.match(line) or _SIMPLE_TABLE.match(line):
        page.end()
    elif line.lstrip().startswith("|") or (" | " in line and not item):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        page.begin(BlockKind.ROW, number, "\t".join(cells))
        page.end()
    elif item:
        page.begin(BlockKind.ITEM, number, item[2], len(item[1]))
    else:
        _gather(page, number, line)


def _gather(page: _Page, number: int, line: str) -> None:
    if not page.gathered and line.startswith("  ") and page.blocks:
        inside = page.blocks[-1].kind in {BlockKind.ITEM, BlockKind.CONTINUED}
        page.kind = BlockKind.CONTINUED if inside else BlockKind.PARAGRAPH
    if not (page.rst and line.endswith("::")):
        page.gather(number, line.lstrip("> "))
        return
    page.gather(number, line.removesuffix("::") + ":")
    page.end()
    page.literal = len(line) - len(line.lstrip())


def _underlined(page: _Page, sign: str) -> None:
    """Take a line of equal signs: it underlines one line of text, else it is a rule or the line above a title."""
    if len(page.gathered) == 1 and page.kind is BlockKind.PARAGRAPH and (page.rst or sign in "=-"):
        text = page.gathered.pop()
        page.heading(page.first, text, page.level_of(sign))
    else:
        page.end()
