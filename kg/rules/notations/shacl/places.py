"""Where things are in a Turtle file; its parser does not report places, so the text is tokenized again."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.syntax.lexer import END, Kind, token_at, unescape, unescape_local

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Places", "StringToken"]

_ESCAPE: Final = re.compile(r"\\(?:u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|.)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class StringToken:
    """A string as it is in the file: where its characters begin, and how they are written."""

    start: int
    written: str

    def offset(self, index: int) -> int:
        """Return the offset in the file of the character at `index` of the string's value."""
        position = passed = 0
        while passed < index and position < len(self.written):
            escape = _ESCAPE.match(self.written, position)
            position = escape.end() if escape else position + 1
            passed += 1
        return self.start + position


@dataclass(slots=True)
class Places:
    """Offsets of the strings and the names of a text, in its order."""

    text: str
    strings: dict[str, list[StringToken]] = field(default_factory=lambda: defaultdict(list))
    names: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    subjects: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Read the text, which is a Turtle file without errors."""
        before = "."
        for iri, written, start, token in _tokens(self.text):
            if written is not None:
                self.strings[unescape(written.written)].append(written)
            elif iri is not None:
                self.names[iri].append(start)
                if before == ".":
                    self.subjects.setdefault(iri, start)
            before = token

    def of_name(self, iri: str) -> int | None:
        """Return the offset of an IRI: as a subject if it is one, else its first occurrence."""
        found = self.subjects.get(iri)
        return found if found is not None else next(iter(self.names.get(iri, ())), None)


def _tokens(text: str) -> Iterator[tuple[str | None, StringToken | None, int, str]]:
    """Yield each token of Turtle with the IRI or the string that it stands for."""
    prefixes: dict[str, str] = {}
    declared: str | None = None
    token = token_at(text, 0)
    while token.text != END:
        iri, written = None, None
        if token.kind is Kind.STRING:
            quotes = 3 if token.text[:3] in {'"""', "'''"} else 1
            written = StringToken(token.start + quotes, token.text[quotes:-quotes])
        elif token.kind is Kind.IRI:
            iri = unescape(token.text[1:-1])
            if declared is not None:
                prefixes[declared] = iri
                declared = None
        elif token.kind is Kind.NAME and not token.text.startswith("_:"):
            prefix, _, local = token.text.partition(":")
            iri = prefixes.get(prefix, "") + unescape_local(local)
            behind = token_at(text, token.end)
            declared = prefix if not local and behind.kind is Kind.IRI and prefix not in prefixes else declared
        yield iri, written, token.start, token.text
        token = token_at(text, token.end)
