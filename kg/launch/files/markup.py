"""XML of launch files and robot descriptions as elements that know their lines.

The parser is expat, as it is that of roslaunch and xacro: they take the same texts for well-formed, and its line is
that of the `<` of a start tag, also when the tag spans lines or is behind line 65535. Entities that a file defines
are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final, Generic, Protocol, TypeAlias, TypeVar
from xml.parsers import expat

_MOST_DEPTH: Final = 60
"""Levels of elements; each may be a group or a macro, whose evaluation takes frames of the interpreter's stack."""
_LARGE_BYTES: Final = 1 << 20


class _HasChildren(Protocol):
    children: list[Any]


_Element = TypeVar("_Element", bound=_HasChildren)
_Problem: TypeAlias = tuple[str, int]


@dataclass(frozen=True, slots=True)
class Document(Generic[_Element]):
    """The root element as far as it could be read, and the problems of the file as message and line."""

    root: _Element | None
    problem: _Problem | None = None


class Markup(Generic[_Element]):
    """A language written in XML: how elements are made of tag, attributes and line, and how texts are replaced.

    `text` is given an element, a piece of the text in it and its line; with `whole_texts` all that is between two
    tags is one piece. The last `cached` documents that are not large are kept.
    """

    def __init__(
        self,
        make: Callable[[str, dict[str, str], int], _Element],
        text: Callable[[_Element, str, int], None],
        *,
        cached: int,
        whole_texts: bool = False,
    ) -> None:
        self.make = make
        self.text = text
        self.whole_texts = whole_texts
        self._cached = lru_cache(maxsize=cached)(self._parsed)

    def read(self, text: bytes) -> Document[_Element]:
        """Return the document of UTF-8 `text`; the part before an error in it is kept."""
        return self._parsed(text) if len(text) > _LARGE_BYTES else self._cached(text)

    def _parsed(self, text: bytes) -> Document[_Element]:
        builder = _Builder(self)
        problem = builder.read(text)
        return Document(builder.root, problem)


class _RefusedError(Exception):
    """The text is well-formed so far, but is not read on."""


class _Builder(Generic[_Element]):
    """Builds elements from the events of the parser."""

    def __init__(self, markup: Markup[_Element]) -> None:
        self.root: _Element | None = None
        self._markup = markup
        self._open: list[_Element] = []
        self._parser = expat.ParserCreate("utf-8")
        self._parser.buffer_text = markup.whole_texts
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.EntityDeclHandler = self._entity

    def read(self, text: bytes) -> _Problem | None:
        """Parse the text; return the problems of it."""
        try:
            self._parser.Parse(text, True)
        except expat.ExpatError as error:
            return f"the file is not well-formed XML: {expat.ErrorString(error.code)}", error.lineno
        except _RefusedError as error:
            return str(error), self._parser.CurrentLineNumber
        return None

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= _MOST_DEPTH:
            raise _RefusedError(f"elements are nested deeper than {_MOST_DEPTH} levels; the file is not read on")
        element = self._markup.make(tag, attributes, self._parser.CurrentLineNumber)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        self._markup.text(self._open[-1], text, self._parser.CurrentLineNumber)

    def _entity(self, name: str, *_: object) -> None:
        raise _RefusedError(f"the file defines the entity '{name}'; entities are refused")
