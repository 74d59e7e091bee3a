"""KG217: a variable that is in one place only: a slip of the pen, or a blank node in disguise."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.errors import Fix
from kg.rules.checks.finding import Finding, at_offset
from kg.rules.checks.tokens import variables
from kg.rules.form import Variable, atoms_of
from kg.similar import asked, similar

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG217"
TITLE: Final = "variable used once"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield each variable that occurs once in a file; a `_` before the name marks it as intended."""
    found = list(variables(file))
    blank = _replaceable(file)
    uses = Counter(token.text[1:] for token in found)
    for token in found:
        name = token.text[1:]
        if uses[name] == 1 and not name.startswith("_"):
            others = [other for other in uses if other != name]
            meant = similar(name, others)
            intended = [f"{token.text[0]}_{name}", *["[]"] * (Variable(name) in blank)]
            fixes = (*(Fix(f"{token.text[0]}{each}") for each in meant), *map(Fix, intended))
            message = f"the variable ?{name} is used only here"
            hint = asked(meant) or _hint(name, blank)
            yield Finding(CODE, "warning", file.name, message, at_offset(file, token.start), hint, fixes=fixes)


def _hint(name: str, blank: set[Variable]) -> str:
    return (
        f"Write `[]`, or ?_{name} if that is meant." if Variable(name) in blank else f"Write ?_{name} if it is meant."
    )


def _replaceable(file: RuleFile) -> set[Variable]:
    """Return the variables that `[]` may replace: those that are only subjects or objects."""
    atoms = [atom for rule in file.rules for atom, _ in atoms_of(rule.body)]
    ends = {end for atom in atoms for end in (atom.subject, atom.object) if isinstance(end, Variable)}
    return ends - {atom.predicate for atom in atoms if isinstance(atom.predicate, Variable)}
