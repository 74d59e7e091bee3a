"""The XML of robot descriptions as elements that know their lines, read by expat; entities are refused."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Final
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Document", "Element", "read_document"]

_MOST_DEPTH: Final = 60
_LARGE_BYTES: Final = 1 << 20
"""Files above this are parsed each time, so that the cache stays small."""
_PREFIX: Final = "xacro:"
_OLD_STYLE: Final = {
    "property": {"name"},
    "macro": {"name"},
    "include": {"filename"},
    "insert_block": {"name"},
    "if": {"value"},
    "unless": {"value"},
}
"""Commands that may stand without prefix, with the attributes that tell them from elements of the description."""


@dataclass(slots=True)
class Element:
    """An element; `line` is that of its start tag, `children` are elements and pieces of text in their order."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element | str] = field(default_factory=list)

    @property
    def command(self) -> str | None:
        """The name of the command of xacro that it is, or of the macro that it calls; None for any other element."""
        if self.tag.startswith(_PREFIX):
            return self.tag.removeprefix(_PREFIX)
        needed = _OLD_STYLE.get(self.tag)
        return self.tag if needed is not None and needed <= self.attributes.keys() else None

    def elements(self) -> Iterator[Element]:
        """Yield the elements directly in it."""
        return (child for child in self.children if isinstance(child, Element))


@dataclass(frozen=True, slots=True)
class Document:
    """The root element as far as it could be read, and what is wrong with the file as message and line."""

    root: Element | None
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
        self._parser.buffer_text = True
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
        if not text.isspace():
            self._open[-1].children.append(text)

    def _entity(self, name: str, *_: object) -> None:
        raise _RefusedError(f"the file defines the entity '{name}'; entities are refused")


def _parse(text: bytes) -> Document:
    builder = _Builder()
    problem = builder.read(text)
    return Document(builder.root, problem)


@lru_cache(maxsize=512)
def _cached(text: bytes) -> Document:
    return _parse(text)
