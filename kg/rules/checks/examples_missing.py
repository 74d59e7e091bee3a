"""KG219: a rule without examples next to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Finding, at_rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG219"
TITLE: Final = "examples missing"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file without examples."""
    if (file.rules or file.data) and not file.examples.is_file():
        hint = f"Write {file.examples.name} with a block `turtle given` and a block `turtle expect`."
        yield Finding(CODE, "warning", file.name, "the rule has no examples", at_rule(file), hint)
