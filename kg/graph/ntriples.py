"""Fast writing of N-Triples (W3C RDF 1.1 N-Triples) as text: terms are strings in N-Triples syntax.

IRIs come from `kg.graph.iris` and `kg.graph.vocabulary`, which only produce valid ones; literals may hold any text.
"""

from __future__ import annotations

import math
from datetime import datetime
from decimal import Decimal
from typing import Final

from kg.graph.vocabulary import LABEL, TYPE, XSD
from kg.store.terms import literal

__all__ = ["Writer", "boolean", "double", "integer", "literal", "moment", "plain"]

_BOOLEANS: Final = (f'"false"^^<{XSD}boolean>', f'"true"^^<{XSD}boolean>')


def integer(number: int) -> str:
    """Return the `xsd:integer` literal of `number`."""
    return f'"{number}"^^<{XSD}integer>'


def plain(number: float) -> str:
    """Return a number in decimal digits without exponent, as the store writes `xsd:double`: 0.1, 1, 0.000001, INF."""
    if not math.isfinite(number):
        return "NaN" if math.isnan(number) else "INF" if number > 0 else "-INF"
    return f"{Decimal(repr(float(number))).normalize():f}"


def double(number: float) -> str:
    """Return the `xsd:double` literal of `number`."""
    return f'"{plain(number)}"^^<{XSD}double>'


def apart(content: bytes, beginnings: bytes | tuple[bytes, ...]) -> tuple[list[bytes], list[bytes]]:
    """Return the lines of N-Triples that begin otherwise, and those with one of `beginnings`, in their order."""
    others: list[bytes] = []
    matching: list[bytes] = []
    for line in content.splitlines(keepends=True):
        (matching if line.startswith(beginnings) else others).append(line)
    return others, matching


def boolean(value: bool) -> str:  # noqa: FBT001 - the value is the argument, not a mode
    """Return the `xsd:boolean` literal of `value`."""
    return _BOOLEANS[value]


def moment(time: datetime) -> str:
    """Return the `xsd:dateTime` literal of `time`, to the millisecond, which is what OWL reasoners read."""
    return f'"{time.isoformat(timespec="milliseconds")}"^^<{XSD}dateTime>'


class Writer:
    """Collects the triples of one graph in order.

    Things shared by many facts (topics, message types, files) are described once: `first` returns whether a thing is
    new.
    """

    __slots__ = ("_seen", "lines")

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._seen: set[str] = set()

    def add(self, subject: str, predicate: str, value: str) -> None:
        """Add one triple of spelled terms."""
        self.lines.append(f"{subject} {predicate} {value} .\n")

    def first(self, term: str) -> bool:
        """Return whether `term` was not asked about before."""
        if term in self._seen:
            return False
        self._seen.add(term)
        return True

    def once(self, subject: str, predicate: str, value: str) -> None:
        """Add one triple unless it was added by `once` before."""
        line = f"{subject} {predicate} {value} .\n"
        if self.first(line):
            self.lines.append(line)

    def described(self, subject: str, label: str, *classes: str) -> bool:
        """Type and label `subject` when it is seen for the first time; return whether it was."""
        if not self.first(subject):
            return False
        self.lines.extend(f"{subject} {TYPE} {name} .\n" for name in classes)
        self.lines.append(f"{subject} {LABEL} {literal(label)} .\n")
        return True

    def text(self, subject: str, predicate: str, value: str | None) -> None:
        """Add a string literal unless `value` is None."""
        if value is not None:
            self.lines.append(f"{subject} {predicate} {literal(value)} .\n")

    def number(self, subject: str, predicate: str, value: int | None) -> None:
        """Add an integer literal unless `value` is None."""
        if value is not None:
            self.lines.append(f"{subject} {predicate} {integer(value)} .\n")

    def encoded(self) -> bytes:
        """Return all triples as N-Triples."""
        return "".join(self.lines).encode()
