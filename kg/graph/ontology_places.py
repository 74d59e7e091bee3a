"""On which line an ontology states a fact, so that explanations end in files for these too."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode

from kg.graph.ontology_files import default_ontologies

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pyoxigraph import Triple

__all__ = ["place_of"]

_PREFIX: Final = re.compile(r"^\s*@?prefix\s+([\w.-]*):\s*<([^>]*)>", re.MULTILINE | re.IGNORECASE)
_SUBJECT: Final = re.compile(r"^(?:([\w.-]*):([\w.-]+)|<([^>\s]+)>)(?=\s)")


def place_of(fact: Triple) -> tuple[str, int] | None:
    """Return the file and line of the ontologies that `kg` brings along where `fact` stands; None when it does not.

    The line is that of the object where the statement about the subject has it on a line of its own.
    """
    if not isinstance(fact.subject, NamedNode):
        return None
    found = _statements().get(fact.subject.value)
    if found is None:
        return None
    path, lines = found
    named = list(_spellings(fact.object, path))
    for number, text in lines:
        if any(name in text for name in named):
            return str(path), number
    return str(path), lines[0][0]


def _spellings(term: object, path: Path) -> Iterator[str]:
    """Yield how a file may write an object."""
    if isinstance(term, Literal):
        yield f'"{term.value}"'
    elif isinstance(term, NamedNode):
        yield f"<{term.value}>"
        for prefix, namespace in _PREFIX.findall(path.read_text("utf-8")):
            if term.value.startswith(namespace):
                yield f"{prefix}:{term.value.removeprefix(namespace)}"


@cache
def _statements() -> dict[str, tuple[Path, list[tuple[int, str]]]]:
    """Return the lines of the statement about each subject, numbered from one."""
    found: dict[str, tuple[Path, list[tuple[int, str]]]] = {}
    for path in default_ontologies():
        text = path.read_text("utf-8")
        prefixes = dict(_PREFIX.findall(text))
        lines: list[tuple[int, str]] = []
        for number, line in enumerate(text.splitlines(), 1):
            match = _SUBJECT.match(line)
            if match:
                iri = match[3] or prefixes.get(match[1], "") + match[2]
                lines = found.setdefault(iri, (path, []))[1]
            lines.append((number, line))
    return found
