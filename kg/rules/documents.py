"""The lines of the statements of Turtle files, for explanations and editors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.syntax.prologue import declared

_SUBJECT: Final = re.compile(r"^(?:([\w.-]*):([\w.-]+)|<([^>\s]+)>)(?=\s)")


@dataclass(frozen=True, slots=True)
class Statement:
    """The statements of a file about one subject: lines, numbered from one, and the prefixes of the file."""

    path: Path
    prefixes: Mapping[str, str]
    lines: list[tuple[int, str]] = field(default_factory=list)

    @property
    def line(self) -> int:
        """The line on which it begins."""
        return self.lines[0][0]


def statements(files: Iterable[Path]) -> dict[str, Statement]:
    """Return the statements of files by the IRI of their subject; of two files that have one, those of the first."""
    result: dict[str, Statement] = {}
    for path in files:
        text = path.read_text("utf-8")
        prefixes = declared(text)
        lines: list[tuple[int, str]] = []
        for number, line in enumerate(text.splitlines(), 1):
            match = _SUBJECT.match(line)
            if match:
                iri = match[3] or prefixes.get(match[1], "") + match[2]
                lines = result.setdefault(iri, Statement(path, prefixes)).lines
            lines.append((number, line))
    return result


def place_of(fact: Triple, by_iri: Mapping[str, Statement]) -> tuple[str, int] | None:
    """Return the file and line of the statement that has `fact`; None when its subject has none.

    The line is that of the object where the statement has it on a line of its own.
    """
    statement = by_iri.get(fact.subject.value) if isinstance(fact.subject, NamedNode) else None
    if statement is None:
        return None
    named = list(_spellings(fact.object, statement.prefixes))
    lines = (number for number, text in statement.lines if any(name in text for name in named))
    return str(statement.path), next(lines, statement.line)


def _spellings(term: object, prefixes: Mapping[str, str]) -> Iterator[str]:
    """Yield how a file may write an object."""
    if isinstance(term, Literal):
        yield f'"{term.value}"'
    elif isinstance(term, NamedNode):
        yield f"<{term.value}>"
        for prefix, namespace in prefixes.items():
            if term.value.startswith(namespace):
                yield f"{prefix}:{term.value.removeprefix(namespace)}"
