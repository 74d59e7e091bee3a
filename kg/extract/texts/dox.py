"""Doxygen's pages (`mainpage.dox`) become Markdown, line by line, so that the reader of pages reads them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["markdown"]

_SIGNS: Final = re.compile(r"^\s*(?:/\*\*?!?|///?|\*/|\*+(?=\s|$))?")
_COMMAND: Final = re.compile(r"^\s*[@\\](\w+)\s*(.*)$")
_LEVELS: Final = {"mainpage": 1, "page": 1, "section": 2, "subsection": 3, "subsubsection": 4, "par": 5}
_LABELLED: Final = frozenset({"page", "section", "subsection", "subsubsection"})
_FENCES: Final = frozenset({"verbatim", "endverbatim", "code", "endcode", "dot", "enddot"})
_SAID: Final = frozenset({"brief", "details", "b", "c", "e", "p", "a", "em", "ref", "note", "li", "i"})


def markdown(text: str) -> str:
    """Return a page of Doxygen as Markdown with the same lines; commands that say nothing leave empty lines."""
    return "\n".join(_lines(text))


def _lines(text: str) -> Iterator[str]:
    for written in text.split("\n"):
        line = _SIGNS.sub("", written.rstrip().removesuffix("*/"), count=1)
        found = _COMMAND.match(line)
        if found is None:
            yield line.strip() if not line.lstrip().startswith(("-", "*")) else line
            continue
        word, rest = found[1].lower(), found[2].strip()
        if word in _LEVELS:
            title = rest.partition(" ")[2] or rest if word in _LABELLED else rest
            yield f"{'#' * _LEVELS[word]} {title}" if title and not title.startswith(("\\", "@")) else ""
        elif word in _FENCES:
            closed = any(f"{sign}end{word}" in rest for sign in "\\@")
            yield "" if closed else "```"
        else:
            yield line.strip() if word in _SAID else ""
