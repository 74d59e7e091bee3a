"""The XML of robot descriptions: its elements, and which of them are commands of xacro."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.launch.markup import Markup, kept_if_small

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.launch.markup import Problem

__all__ = ["Document", "Element", "read_document"]

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
    problem: Problem | None = None


def _child(parent: Element, child: Element) -> None:
    parent.children.append(child)


def _text(parent: Element, text: str, _line: int) -> None:
    if not text.isspace():
        parent.children.append(text)


_MARKUP: Final = Markup(Element, _child, _text, whole_texts=True)


def _parse(text: bytes) -> Document:
    return Document(*_MARKUP.read(text))


_kept: Final = kept_if_small(_parse, 512)


def read_document(text: bytes) -> Document:
    """Return the document of UTF-8 `text`; what stands before an error in it is kept."""
    return _kept(text)
