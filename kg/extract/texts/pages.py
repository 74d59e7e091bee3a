"""Pages of documentation as blocks: headings, paragraphs, list items and rows of tables, with their lines.

One reader takes Markdown (CommonMark's blocks as far as prose needs them), reStructuredText and plain text, and
Doxygen's pages after their commands became headings. It goes over the lines once and keeps no tree, so nothing nests.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final

__all__ = ["Block", "BlockKind", "read_page"]

MOST_LINES: Final = 5000
"""Lines of a page that are looked at."""
LONGEST_LINE: Final = 4000
"""Characters of a line that are looked at: paragraphs without line breaks have about 2,000."""


class BlockKind(StrEnum):
    """What a block of a page is."""

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
    """Tell whether a line belongs to code, a directive or a definition, and keep in mind where these end."""
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
    atx = None if page.rst else _ATX.match(line) or _html_heading(line)
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


def _html_heading(line: str) -> re.Match[str] | None:
    return _HTML_HEADING.search(line) if "<h" in line.lower() else None


def _underlined(page: _Page, sign: str) -> None:
    """Take a line of equal signs: it underlines one line of text, else it is a rule or the line above a title."""
    if len(page.gathered) == 1 and page.kind is BlockKind.PARAGRAPH and (page.rst or sign in "=-"):
        text = page.gathered.pop()
        page.heading(page.first, text, page.level_of(sign))
    else:
        page.end()
