"""KG217: a variable that stands in one place only: a slip of the pen, or a blank node in disguise."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.query.similar import did_you_mean
from kg.rules.checks.finding import Finding, at_offset
from kg.rules.checks.tokens import variables

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG217"
TITLE: Final = "variable used once"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield each variable that a file has once; names that begin with `_` say that this is meant."""
    found = list(variables(file))
    uses = Counter(token.text[1:] for token in found)
    for token in found:
        name = token.text[1:]
        if uses[name] == 1 and not name.startswith("_"):
            others = [other for other in uses if other != name]
            hint = did_you_mean(name, others) or f"Write `[]`, or ?_{name} if that is meant."
            message = f"the variable ?{name} stands here only"
            yield Finding(CODE, "warning", file.name, message, at_offset(file, token.start), hint)
