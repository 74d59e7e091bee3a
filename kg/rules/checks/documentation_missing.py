"""KG218: a rule without title, the headings every rule has, or the version it came with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.position import place_of
from kg.rules.checks.finding import Finding
from kg.rules.files import REQUIRED_HEADINGS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG218"
TITLE: Final = "documentation missing"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding that names all that the header of a file lacks."""
    documentation = file.documentation
    sections = documentation.sections or {}
    lacking = [] if documentation.title else ["a title"]
    lacking += [f"`## {heading}`" for heading in REQUIRED_HEADINGS if not sections.get(heading, "").strip()]
    lacking += [] if documentation.since else ["`since:`"]
    if lacking:
        place = place_of(file.text, 1, 1, str(file.path))
        message = f"the header lacks {', '.join(lacking)}"
        yield Finding(CODE, "warning", file.name, message, place, "`kg rules show` prints what stands there.")
