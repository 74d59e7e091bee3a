"""KG218: a rule without title, the headings every rule has, or the version it came with.

What `kg rules new` wrote for the author to replace is missing too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Finding
from kg.rules.files import REQUIRED_HEADINGS
from kg.syntax.position import place_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import Documentation, RuleFile

__all__ = ["CODE", "SCAFFOLD", "TITLE", "check"]

CODE: Final = "KG218"
TITLE: Final = "documentation missing"


SCAFFOLD: Final = "Say here which question can be answered with it."
"""What the templates of new rules say below `## Why`."""

_NOTHING: Final = ("", SCAFFOLD)
_WORDS: Final = {
    "title": ("a title", "`# What it derives, in a line`"),
    "infers": ("`## What it infers`", "`# ## What it infers` and what triples from which"),
    "why": ("`## Why`", "`# ## Why` and which question can be answered with it"),
    "since": ("`since:`", "`# since: 0.1`, the version of yours that has it first"),
}
"""What may be lacking: what the message calls it, and how it is written."""


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding that names all that the header of a file lacks."""
    if not file.rules and not file.data:
        return
    lacks = tuple(_lacking(file.documentation))
    if lacks:
        place = place_of(file.text, 1, 1, str(file.path))
        message = f"the header lacks {', '.join(_WORDS[each][0] for each in lacks)}"
        hint = f"Write above the rule: {'; '.join(_WORDS[each][1] for each in lacks)}."
        yield Finding(CODE, "warning", file.name, message, place, hint, lacks)


def _lacking(documentation: Documentation) -> Iterator[str]:
    sections = documentation.sections or {}
    if not documentation.title:
        yield "title"
    for member, heading in zip(("infers", "why"), REQUIRED_HEADINGS, strict=True):
        if sections.get(heading, "").strip() in _NOTHING:
            yield member
    if not documentation.since:
        yield "since"
