"""The XML of launch files as elements that know their lines.

The parser is expat, as it is roslaunch's: both take the same texts for well-formed, and its line is that of the `<` of
a start tag, also when the tag spans lines or stands behind line 65535. Entities that a file defines are refused.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Final
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Document", "Element", "read_document"]

_MOST_DEPTH: Final = 60
"""Levels of elements; each may be a group, and the evaluation of a group takes frames of the interpreter's stack."""
_LARGE_BYTES: Final = 1 << 20
"""Files above this are parsed each time, so that the cache stays small."""
_WITH_TEXT: Final = "rosparam"


@dataclass(slots=True)
class Element:
    """An element; `line` is that of its start tag. Text is kept for `<rosparam>` only, as pieces with their lines."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    pieces: list[tuple[int, str]] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text directly in the element, without comments."""
        return "".join(piece for _, piece in self.pieces)

    def text_lines(self) -> list[int]:
        """Return the line in the file of each line of `text`."""
        lines: list[int] = [self.pieces[0][0] if self.pieces else self.line]
        for first, piece in self.pieces:
            if not lines[-1]:
                lines[-1] = first
            for line in range(first + 1, first + piece.count("\n") + 1):
                lines.append(line)  # noqa: PERF402 - the loop sets the last entry, too
        return lines

    def below(self) -> Iterator[Element]:
        """Yield the element and all in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))


@dataclass(frozen=True, slots=True)
class Document:
    """The `<launch>` element as far as it could be read, and what is wrong with the file as message and line."""

    launch: Element | None
    problem: tuple[str, int] | None = None


class _RefusedError(Exception):
    """The text is well-formed so far, but is not read on."""


def read_document(text: bytes) -> Document:
    """Return the document of UTF-8 `text`; what stands before an error in it is kept."""
    return _parse(text) if len(text) > _LARGE_BYTES else _cached(text)


class _Builder:
    """Makes elements of what the parser reports."""

    def __init__(self) -> None:
        self.root: Element | None = None
        self._open: list[Element] = []
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.EntityDeclHandler = self._entity

    def read(self, text: bytes) -> tuple[str, int] | None:
        """Parse the text; return what is wrong with it."""
        try:
            self._parser.Parse(text, True)
        except expat.ExpatError as error:
            return f"the file is no well-formed XML: {expat.ErrorString(error.code)}", error.lineno
        except _RefusedError as error:
            return str(error), self._parser.CurrentLineNumber
        return None

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= _MOST_DEPTH:
            raise _RefusedError(f"elements are nested deeper than {_MOST_DEPTH} levels; the file is not read on")
        element = Element(tag, attributes, self._parser.CurrentLineNumber)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        if self._open[-1].tag.lower() == _WITH_TEXT:
            self._open[-1].pieces.append((self._parser.CurrentLineNumber, text))

    def _entity(self, name: str, *_: object) -> None:
        raise _RefusedError(f"the file defines the entity '{name}'; entities are refused")


def _parse(text: bytes) -> Document:
    builder = _Builder()
    problem = builder.read(text)
    found = [element for element in builder.root.below() if element.tag == "launch"] if builder.root else []
    if len(found) != 1 and problem is None:
        problem = (
            "the file has no <launch> element" if not found else "the file has more than one <launch> element",
            1,
        )
    return Document(found[0] if found else None, problem)


@lru_cache(maxsize=1024)
def _cached(text: bytes) -> Document:
    return _parse(text)
