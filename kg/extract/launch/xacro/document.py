"""The XML of robot descriptions: its elements, and which of them are commands of xacro."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.launch.markup import Markup

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["DESCRIPTION", "Element"]

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


def _text(parent: Element, text: str, _line: int) -> None:
    if not text.isspace():
        parent.children.append(text)


DESCRIPTION: Final = Markup(Element, _text, whole_texts=True, kept=512)
"""The language of robot descriptions."""
