"""XML of launch files and robot descriptions as elements that know their lines.

The parser is expat, as it is that of roslaunch and xacro: they take the same texts for well-formed, and its line is
that of the `<` of a start tag, also when the tag spans lines or stands behind line 65535. Entities that a file defines
are refused.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final, Generic, TypeVar
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Markup", "Problem", "kept_if_small"]

_MOST_DEPTH: Final = 60
"""Levels of elements; each may be a group or a macro, whose evaluation takes frames of the interpreter's stack."""
_LARGE_BYTES: Final = 1 << 20

_Element = TypeVar("_Element")
_Read = TypeVar("_Read")
Problem = tuple[str, int]
"""What is wrong with a file: a message, and its line."""


class Markup(Generic[_Element]):
    """A language written in XML: how its elements are made of tag, attributes and line, and what is put in them.

    `text` is given a piece of text and its line; with `whole_texts` all that stands between two tags is one piece.
    """

    def __init__(
        self,
        make: Callable[[str, dict[str, str], int], _Element],
        child: Callable[[_Element, _Element], None],
        text: Callable[[_Element, str, int], None],
        *,
        whole_texts: bool,
    ) -> None:
        self.make = make
        self.child = child
        self.text = text
        self.whole_texts = whole_texts

    def read(self, text: bytes) -> tuple[_Element | None, Problem | None]:
        """Return the root element of UTF-8 `text`, as far as it stands before an error, and what is wrong."""
        builder = _Builder(self)
        problem = builder.read(text)
        return builder.root, problem


def kept_if_small(parse: Callable[[bytes], _Read], most: int) -> Callable[[bytes], _Read]:
    """Return `parse` with its last `most` results kept, but those of large files, so that the cache stays small."""
    kept = lru_cache(maxsize=most)(parse)
    return lambda text: parse(text) if len(text) > _LARGE_BYTES else kept(text)


class _RefusedError(Exception):
    """The text is well-formed so far, but is not read on."""


class _Builder(Generic[_Element]):
    """Makes elements of what the parser reports."""

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

    def read(self, text: bytes) -> Problem | None:
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
        element = self._markup.make(tag, attributes, self._parser.CurrentLineNumber)
        if self._open:
            self._markup.child(self._open[-1], element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        self._markup.text(self._open[-1], text, self._parser.CurrentLineNumber)

    def _entity(self, name: str, *_: object) -> None:
        raise _RefusedError(f"the file defines the entity '{name}'; entities are refused")
