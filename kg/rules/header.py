"""The header of a file of rules: comments that document it, in the form that `kg.rules.files` states."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.codes import SEVERITIES
from kg.errors import Fix, Place, RuleError
from kg.rules.files import HEADINGS, Documentation
from kg.similar import similar, suggest

if TYPE_CHECKING:
    from collections.abc import Iterable

_KEY: Final = re.compile(r"(since|severity):\s*(\S*)\s*")


def parse_header(text: str, path: str) -> Documentation:
    """Return the documentation in the comments that a text begins with; an empty one when it begins with none.

    Raises RuleError: KG206 for a heading that is unknown or appears twice, and for a severity that there is not.
    """
    title = ""
    sections: dict[str, list[str]] = {}
    keys: dict[str, str] = {}
    section: list[str] | None = None
    for number, line, column, whole in _comments(text):
        place = Place(path, number, column, whole)
        if line.startswith("## "):
            section = sections.setdefault(_heading(line[3:].strip(), sections, place), [])
        elif match := _KEY.fullmatch(line):
            keys[match[1]] = _value(match[1], match[2], place)
            section = None
        elif section is not None:
            section.append(line)
        elif not title:
            title = line.strip()
    written = {heading: "\n".join(lines).strip("\n") for heading, lines in sections.items()}
    return Documentation(title, written, keys.get("since"), keys.get("severity"))


def _comments(text: str) -> list[tuple[int, str, int, str]]:
    """Return the lines of the header: number, what is behind the comment sign, the column of that, all of the line."""
    comments: list[tuple[int, str, int, str]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            comments.append((number, line[1:].removeprefix(" ").rstrip(), 3, line))
        elif comments or line.strip():
            break
    return comments


def _heading(heading: str, before: dict[str, list[str]], place: Place) -> str:
    if heading not in HEADINGS:
        raise _unknown("heading", heading, f"The headings are: {', '.join(HEADINGS)}.", HEADINGS, place)
    if heading in before:
        raise RuleError("KG206", f"the heading `{heading}` appears twice", place=place, hint="Join the two parts.")
    return heading


def _unknown(what: str, written: str, hint: str, valid: Iterable[str], place: Place) -> RuleError:
    """Return the error about a word in the line of a place that is none of those known."""
    near = similar(written, valid)
    start = (place.excerpt or "").rfind(written) + 1
    word = replace(place, column=start, end_line=place.line, end_column=start + len(written))
    fixes = [Fix(each, word) for each in near]
    return RuleError("KG206", f"unknown {what} `{written}`", place=place, hint=suggest(near) or hint, fixes=fixes)


def _value(key: str, value: str, place: Place) -> str:
    if key == "severity" and value not in SEVERITIES:
        raise _unknown("severity", value, f"The severities are: {', '.join(SEVERITIES)}.", SEVERITIES, place)
    if not value:
        raise RuleError("KG206", f"`{key}:` has no value", place=place, hint="Write the version, as in `since: 0.2`.")
    return value
