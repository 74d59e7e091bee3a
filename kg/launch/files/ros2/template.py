r"""Texts of launch files with substitutions in them: `$(find-pkg-share p)/x/$(var y)`.

Source: the grammar of `launch.frontend`. Operands are between spaces, or in quotes of either kind; in quotes a nested
substitution may stand too, with operands that have no such quote. A backslash makes the character after it plain.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import Final

from kg.launch.files.ros2.actions import Part, Substitution, Text

_MOST_DEPTH: Final = 40
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_QUOTES: Final = "'\""


class TemplateError(Exception):
    """A text breaks the grammar of substitutions."""


@lru_cache(maxsize=64)
def parse_template(text: str) -> Text:
    """Return the parts of a text; raises `TemplateError`."""
    if "$(" not in text and "\\" not in text:
        return (text,) if text else ()
    return _Reader(text).template("", 0)


@cache
def _run(ends: str) -> re.Pattern[str]:
    """Return the pattern of characters that mean themselves, up to one of `ends`."""
    return re.compile(rf"[^\\${re.escape(ends)}]+")


class _Reader:
    """One pass over a text."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def template(self, quote: str, depth: int) -> Text:
        """Read up to the closing `quote`, or the end where there is none."""
        parts: list[Part] = []
        while self._at < len(self._text) and (not quote or self._text[self._at] != quote):
            if self._text.startswith("$(", self._at):
                parts.append(self._substitution(quote, depth + 1))
            else:
                parts.append(self._plain(quote))
        if quote and self._at >= len(self._text):
            raise TemplateError(f"a quote is not closed in `{self._shown}`")
        return tuple(parts)

    def _plain(self, ends: str) -> str:
        """Read text up to a substitution or one of the characters `ends`."""
        read = []
        run = _run(ends)
        while self._at < len(self._text) and self._text[self._at] not in ends:
            if (ordinary := run.match(self._text, self._at)) is not None:
                read.append(ordinary.group())
                self._at = ordinary.end()
                continue
            if self._text.startswith("$(", self._at):
                break
            # A backslash makes the next character plain; the last character of a text is one itself.
            escapes = self._text[self._at] == "\\" and self._at + 1 < len(self._text)
            self._at += 1 if escapes else 0
            read.append(self._text[self._at])
            self._at += 1
        return "".join(read)

    def _substitution(self, quote: str, depth: int) -> Substitution:
        if depth > _MOST_DEPTH:
            raise TemplateError(f"substitutions are nested deeper than {_MOST_DEPTH} levels")
        self._at += 2
        name = _NAME.match(self._text, self._at)
        if name is None:
            raise TemplateError(f"a substitution has no name in `{self._shown}`")
        self._at = name.end()
        operands = []
        while self._skip_spaces() and not self._closes():
            operands.append(self._operand(quote, depth))
        if not self._closes():
            raise TemplateError(f"`$({name.group()}` is not closed in `{self._shown}`")
        self._at += 1
        return Substitution(name.group(), tuple(operands))

    def _skip_spaces(self) -> bool:
        start = self._at
        while self._at < len(self._text) and self._text[self._at].isspace():
            self._at += 1
        return self._at > start

    def _closes(self) -> bool:
        return self._text.startswith(")", self._at)

    def _operand(self, quote: str, depth: int) -> Text:
        if not quote and self._text[self._at : self._at + 1] in tuple(_QUOTES):
            own = self._text[self._at]
            self._at += 1
            found = self.template(own, depth)
            self._at += 1
            return found
        parts: list[Part] = []
        while self._at < len(self._text) and not self._closes() and not self._text[self._at].isspace():
            if self._text.startswith("$(", self._at):
                parts.append(self._substitution(quote, depth + 1))
            elif self._text[self._at] in (quote or _QUOTES) + "(":
                raise TemplateError(f"`{self._text[self._at]}` must be in quotes in `{self._shown}`")
            else:
                parts.append(self._plain(f"{quote or _QUOTES}() \t\r\n\f\v"))
        return tuple(parts)

    @property
    def _shown(self) -> str:
        return self._text if len(self._text) <= 80 else f"{self._text[:77]}..."  # noqa: PLR2004  (what fits in a message)
