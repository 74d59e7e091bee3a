"""Edits that fix findings: the place of a name in the lines of a finding, and its replacement.

Launch files and code rarely contain the full name of a topic: `camera/imge` may be `/front/camera/imge`. So an edit
replaces the written suffix of a name by the same suffix of the other name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.lint.finding import Evidence, Finding
    from kg.lint.lines import Lines

_BEFORE: Final = r"(?<![\w/.~-])(?<!::)"
_BEHIND: Final = r"(?![\w/.-]|::)"
_SUBSTITUTED: Final = r"(?<=[)}]/)"
"""The text before the suffix of a name that begins with a substitution, as in `$(arg robot)/scan`."""
_BRACKETS: Final = {".launch": "<>", ".xml": "<>", ".xacro": "<>"}
_CODE: Final = "([{}])"


@dataclass(frozen=True, slots=True)
class Repair:
    """An edit: in the line (from one) of the file of `place`, `text` replaces `written` at the column (from zero)."""

    place: Evidence
    line: int
    column: int
    written: str
    text: str


def repairs(finding: Finding, lines: Lines) -> Iterator[Repair]:
    """Yield alternative edits that fix a finding: at its own line, then where the other name is written."""
    if not finding.replacement or not finding.subjects:
        return
    wrong, right = finding.subjects[0], finding.replacement
    for place in places(finding, lines):
        yield from _repair(place, wrong, right, lines)
    for place in finding.evidence:
        # Evidence that only starts a node may contain the name in another role.
        if _means(place.words.rpartition(" ")[2], right):
            yield from _repair(place, right, wrong, lines)


def places(finding: Finding, lines: Lines) -> list[Evidence]:
    """Return the places to mark: the finding's line, and the place of its name if that line lacks it.

    For a name in a node's code, the finding's line may only start the node.
    """
    own, name = finding.place, finding.subjects[0] if finding.subjects else ""
    if own is None or not name or written(own, name, lines) or _default(own, name, lines):
        return [own] if own is not None else []
    ends = (each for each in finding.evidence if _means(each.words.rpartition(" ")[2], name))
    return [own, *(each for each in ends if written(each, name, lines))]


def _means(word: str, name: str) -> bool:
    """Return whether a written name may be short for a full name."""
    return bool(word.strip("/~")) and f"/{name}".endswith(f"/{word.lstrip('/~')}")


def _repair(place: Evidence, old: str, new: str, lines: Lines) -> Iterator[Repair]:
    position = written(place, old, lines) or _default(place, old, lines)
    if position is None:
        return
    line, column, text = position
    before = old[: len(old) - len(text.lstrip("~"))]
    if text != old and new.startswith(before):
        yield Repair(place, line, column, text, text[: len(text) - len(text.lstrip("~"))] + new[len(before) :])
    elif not (lines.at(place, line) or "")[:column].endswith("/"):
        yield Repair(place, line, column, text, new)


def written(place: Evidence, name: str, lines: Lines) -> tuple[int, int, str] | None:
    """Return line (from one), column (from zero) and text of a name in the lines of a place.

    None if it is missing. The lines are those of the element or call at the place.
    """
    for end in _ends(name):
        pattern = re.compile(rf"(?:{_BEFORE}|{_SUBSTITUTED}){re.escape(end)}{_BEHIND}")
        matches = [(line, match) for line, text in _statement(place, lines) for match in pattern.finditer(text)]
        if matches:
            line, match = _chosen(matches, place, name)
            return line, match.start(), end
    return None


def _default(place: Evidence, name: str, lines: Lines) -> tuple[int, int, str] | None:
    """Return the place of a name as a whole value in the file of a place, if it is unique.

    That is the default of an argument which the line of the place reads.
    """
    for end in _ends(name):
        pattern = re.compile(rf"""(?<=["']){re.escape(end)}(?=["'])""")
        matches = [(line, match) for line, text in _whole(place, lines) for match in pattern.finditer(text)]
        if len(matches) == 1:
            return matches[0][0], matches[0][1].start(), end
    return None


def _whole(place: Evidence, lines: Lines) -> Iterator[tuple[int, str]]:
    number = 1
    while (text := lines.at(place, number)) is not None:
        yield number, text
        number += 1


def _ends(name: str) -> list[str]:
    """Return the possible spellings of a name, the longest first: with some of its namespaces, or as private."""
    parts = re.split(r"(?<=[/.])", name)
    ends = ["".join(parts[number:]) for number in range(len(parts))]
    return [each for each in (*ends, f"~{ends[-1]}") if each.strip("/.~")]


def _chosen(matches: Sequence[tuple[int, re.Match[str]]], place: Evidence, name: str) -> tuple[int, re.Match[str]]:
    """Return the relevant occurrence: source or target of a remapping, elsewhere the first."""
    words = place.words.split()
    if len(words) != 4 or words[0] != "remaps":  # noqa: PLR2004 - remaps FROM to TO
        return matches[0]
    role = "from" if _means(words[1], name) and not _means(words[3], name) else "to"
    named = [each for each in matches if re.search(rf"\b{role}\b\W*\Z", each[1].string[: each[1].start()])]
    return named[0] if named else matches[0 if role == "from" else -1]


def _statement(place: Evidence, lines: Lines) -> Iterator[tuple[int, str]]:
    """Yield the lines from that of a place to the end of its element, call or block, with their numbers."""
    suffix = place.path[place.path.rfind(".") :]
    signs = _BRACKETS.get(suffix, _CODE)
    half = len(signs) // 2
    number = place.line or 1
    depth, first = 0, lines.at(place, number)
    text = first
    while text is not None:
        yield number, text
        depth += sum((sign in signs[:half]) - (sign in signs[half:]) for sign in text if sign in signs)
        number += 1
        text = lines.at(place, number)
        deeper = suffix in {".yaml", ".yml"} and text is not None and _indent(text) > _indent(first or "")
        if depth <= 0 and not deeper:
            return


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())
