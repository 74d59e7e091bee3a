"""The lines of code behind facts, kept with them so that they can be shown where the sources are not.

What stands behind a word for a secret on its line is left out, and so are keys and the passwords of addresses.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import fields, is_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from kg.corpus.files import FilePath
from kg.facts import Location, PackageFacts, Snippet

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.reading import Reader

_MOST_LINES: Final = 400
"""Lines of one file; where facts need more, those around them go first, and then the facts farthest down."""
_REACHES: Final = ((0, 0), (0, 3), (1, 3))
"""Lines before and after that of a fact, the most needed first: the line, the rest of its statement, one above."""
_SECRET: Final = re.compile(
    r"(?:pass(?:word|wd|phrase)|secret|credential|token|(?:api|access|auth|private)[_-]?key)s?\b", re.IGNORECASE
)
_ADDRESS: Final = re.compile(r"(?<=://)[^/\s@'\"]+(?=@)")
_KEY: Final = re.compile(
    r"-----BEGIN |\b(?:gh[pousr]_|github_pat_|glpat-|AKIA|xox[abprs]-)[\w-]{8,}|\b[A-Za-z0-9+/]{64,}"
)
_CUT: Final = "…"
_ATOMS: Final = frozenset({str, int, float, bool, type(None)})
"""Types of values that contain no place."""


def read_snippets(reader: Reader, facts: PackageFacts) -> tuple[Snippet, ...]:
    """Return for each file that the facts of a package are read from the lines around them, by repository and path.

    Only texts that `reader` has read are looked at, so they add no input.
    """
    wanted: defaultdict[FilePath, set[int]] = defaultdict(set)
    for place in _locations((facts.package, facts.nodes, facts.definitions, facts.launches)):
        if place.line > 0:
            wanted[FilePath(place.repository or facts.repository, place.path)].add(place.line)
    snippets = []
    for file in sorted(wanted):
        text = reader.cached_text(file)
        lines = _chosen(text.decode("utf-8", "replace").split("\n"), wanted[file]) if text else {}
        if lines:
            other = file.repository if file.repository != facts.repository else None
            snippets.append(Snippet(file.path, tuple(sorted(lines.items())), other))
    return tuple(snippets)


def _chosen(lines: list[str], wanted: Iterable[int]) -> dict[int, str]:
    """Return the lines to keep, by their numbers."""
    chosen: dict[int, str] = {}
    order = sorted(wanted)
    for before, after in _REACHES:
        for middle in order:
            for number in range(max(1, middle - before), min(len(lines), middle + after) + 1):
                if number not in chosen and len(chosen) < _MOST_LINES:
                    chosen[number] = _harmless(lines, number)
    return chosen


def _harmless(lines: list[str], number: int) -> str:
    """Return a line without secrets. A line that ends after a word for one hides the next line with it."""
    above = lines[number - 2].rstrip() if number > 1 else ""
    if _SECRET.search(above) and above.endswith(("=", "(", ",", ":", "\\", "{")):
        return _CUT
    text = Snippet.shortened(lines[number - 1])
    if word := _SECRET.search(text):
        text = text[: word.end()] + (_CUT if text[word.end() :].strip() else "")
    if _KEY.search(text):
        return _CUT
    return _ADDRESS.sub(_CUT, text)


def _locations(facts: Iterable[Any]) -> Iterator[Location]:
    """Yield all places that facts name. What several facts share is visited once."""
    seen: set[int] = set()
    pending = [*facts]
    while pending:
        value = pending.pop()
        kind: Any = type(value)
        if kind in _ATOMS or id(value) in seen:
            continue
        seen.add(id(value))
        if kind is Location:
            yield value
        elif isinstance(value, tuple | list | frozenset):
            pending += value
        elif isinstance(value, dict):
            pending += value.values()
        else:
            pending += [getattr(value, name) for name in _fields(kind)]


@cache
def _fields(kind: Any) -> tuple[str, ...]:
    """Return the fields of a data class; none for another type."""
    return tuple(one.name for one in fields(kind)) if is_dataclass(kind) else ()
