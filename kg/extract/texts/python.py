"""Comments and docstrings of Python: of the file, of its classes and functions, by one pass over the text."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.extract.texts.paragraphs import Paragraph, joined, prose

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Docstrings", "read_docstrings"]

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
    """What a Python file says of itself: comments (`header`), and docstrings by the names of what they document."""

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
        found = self.classes if match[1] == "class" else self.functions
        found.setdefault(match[2], []).extend([*above, *paragraphs])

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
        found = _DOCSTRING.match(self._text, start, start + _LONGEST_DOCSTRING)
        if not found or (len(found[1]) == 1 and "\n" in found[2]):
            return []
        line = self._text.count("\n", 0, found.start(2)) + 1
        return list(prose(joined(enumerate(found[2].split("\n"), line))))


def read_docstrings(text: str) -> Docstrings:
    """Return what a Python file says of itself, of its classes and of its functions."""
    return Docstrings(text)
