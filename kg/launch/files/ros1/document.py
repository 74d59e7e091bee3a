"""The XML of launch files of ROS 1: its elements, and the one that is `<launch>`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from kg.launch.files.markup import Document, Markup

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


def _text(parent: Element, text: str, line: int) -> None:
    if parent.tag.lower() == _WITH_TEXT:
        parent.pieces.append((line, text))


_MARKUP: Final = Markup(Element, _text, cached=1024)


def read_document(text: bytes) -> Document[Element]:
    """Return the `<launch>` element of UTF-8 `text`; the part before an error in it is kept."""
    whole = _MARKUP.read(text)
    roots = [element for element in whole.root.below() if element.tag == "launch"] if whole.root else []
    if len(roots) == 1:
        return Document(roots[0], whole.problem)
    return Document(None, whole.problem or (f"the file has {'more than one' if roots else 'no'} <launch> element", 1))
