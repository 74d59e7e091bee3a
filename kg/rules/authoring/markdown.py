"""The headings and fenced blocks of a Markdown page, with their lines: as much of CommonMark as examples need."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_FENCE: Final = re.compile(r" {0,3}(?P<fence>`{3,}|~{3,})\s*(?P<info>[^`]*)")
_HEADING: Final = re.compile(r" {0,3}(?P<level>#{1,6})\s+(?P<title>.*?)\s*#*\s*")


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading of a level from 1 to 6; lines count from one."""

    level: int
    title: str
    line: int


@dataclass(frozen=True, slots=True)
class Fence:
    """A fenced block: the words after the fence, and the content; `line` is that of the fence."""

    info: str
    text: str
    line: int
    closed: bool


def parts(text: str) -> Iterator[Heading | Fence]:
    """Yield the headings and fenced blocks of a page (CommonMark 0.31, sections 4.2 and 4.5)."""
    lines = text.splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        number += 1
        if fence := _FENCE.fullmatch(line):
            end = _end(lines, number, fence["fence"])
            inner = "".join(f"{each}\n" for each in lines[number:end])
            yield Fence(" ".join(fence["info"].split()), inner, number, closed=end < len(lines))
            number = end + 1
        elif heading := _HEADING.fullmatch(line):
            yield Heading(len(heading["level"]), heading["title"], number)


def _end(lines: list[str], start: int, fence: str) -> int:
    """Return the index of the line that closes a block, or the number of lines."""
    closing = re.compile(rf" {{0,3}}{re.escape(fence[0])}{{{len(fence)},}}\s*")
    return next((index for index in range(start, len(lines)) if closing.fullmatch(lines[index])), len(lines))
