"""Comments of C++: found by one pass over the text that knows comments from literals, and what each stands above.

The trees of the reader of C++ are not kept after a program was read, and to parse again would double the time; where
a comment ends and whether a class follows needs no tree.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from kg.extract.texts.paragraphs import Paragraph, joined, prose

__all__ = ["Comments", "read_comments"]

_TOKENS: Final = re.compile(
    r"""//[^\n]*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'""",
    re.DOTALL,
)
_GAP: Final = re.compile(r"[ \t]*\n(?:[ \t]*\n)?[ \t]*")
_CLASS: Final = re.compile(
    r"(?:template\s*<[^{};]{0,200}>\s*)?(class|struct)\s+(?:\[\[[^\]]{0,60}\]\]\s*)?"
    r"(?:[A-Z][A-Z0-9_]+(?:\([^()]{0,60}\))?\s+)?(?:\w+::)*(\w+)(?:\s+final)?\s*(?=[:{])"
)
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
        self._read()

    def _read(self) -> None:
        text, top = self._text, True
        at = 0
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
        """Return the comments that stand alone on their lines; neighbouring line comments are one."""
        text = self._text
        found: list[_Block] = []
        line, counted = 1, 0
        for match in _TOKENS.finditer(text):
            start, end = match.span()
            if text[start] != "/" or not _begins_line(text, start):
                continue
            last = found[-1] if found else None
            lines = text.startswith("//", start)
            if lines and last and text.startswith("//", last.start) and _adjacent(text, last.end, start):
                found[-1] = _Block(last.start, end, last.line)
            elif len(found) >= _MOST_COMMENTS:
                break
            else:
                line += text.count("\n", counted, start)
                counted = start
                found.append(_Block(start, end, line))
        return found

    def _paragraphs(self, block: _Block) -> list[Paragraph]:
        lines = self._text[block.start : block.end].split("\n")
        return list(prose(joined((block.line + n, _bare(line)) for n, line in enumerate(lines))))


def read_comments(text: str) -> Comments:
    """Return the comments of a C++ file that can describe something."""
    return Comments(text)


def _begins_line(text: str, start: int) -> bool:
    """Tell whether only white space stands before a place in its line, of which so much is looked at."""
    nearest = max(0, start - _DEEPEST_INDENTATION)
    before = text.rfind("\n", nearest, start)
    return (before >= 0 or nearest == 0) and not text[before + 1 : start].strip()


def _adjacent(text: str, end: int, start: int) -> bool:
    between = text[end:start]
    return between.count("\n") == 1 and not between.strip()


_SIGNS: Final = re.compile(r"^\s*(?:/\*+[!<]?|//[/!]*<?|\*+(?!\w*\*)/?)?[ \t]?")


def _bare(line: str) -> str:
    """Return a line of a comment without comment signs."""
    return _SIGNS.sub("", line.rstrip().removesuffix("*/"), count=1)
