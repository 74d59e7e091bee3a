"""KG201: a file without rules, or without one whose filters can hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Finding
from kg.syntax.position import place_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG201"
TITLE: Final = "no rule"
_HINTS: Final = {
    ".rq": "A rule derives triples: CONSTRUCT { ... } WHERE { ... }, with filters that can hold.",
    ".srl": "A rule derives triples: RULE { ... } WHERE { ... }.",
    ".ttl": "A rule is the value of `sh:rule` at a shape with a target.",
}


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file that neither derives nor states anything."""
    if not file.rules and not file.data:
        place = place_of(file.text, 1, 1, str(file.path))
        yield Finding(CODE, "warning", file.name, "no rule here can infer anything", place, _HINTS[file.notation])
