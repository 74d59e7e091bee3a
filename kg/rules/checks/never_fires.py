"""KG213: a rule whose body matches nothing in the store."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Finding, at_rule
from kg.rules.form import AUXILIARY, Atom, atoms_of
from kg.rules.sparql import group

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.errors import Place
    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile
    from kg.rules.form import Element, Rule

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG213"
TITLE: Final = "never fires"


def check(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield one finding for a file of which no rule has a match, naming the first part that leaves it without."""
    if context.store is None:
        return
    asked = [rule for rule in file.rules if not _auxiliary(rule)]
    if not asked or any(context.store.matches(rule.body) for rule in asked):
        return
    element = context.store.failing(asked[0].body)
    reason = f": nothing matches {' '.join(group((element,)).split())}" if element else ""
    place: Place = getattr(element, "place", None) or at_rule(file)
    yield Finding(CODE, "note", file.name, f"on this store the rule derives nothing{reason}", place, None)


def _auxiliary(rule: Rule) -> bool:
    """Tell whether a rule reads or derives what only decomposition knows, which no store holds."""
    atoms: list[Element] = [*rule.head, *(atom for atom, _ in atoms_of(rule.body))]
    return any(isinstance(atom, Atom) and str(atom.predicate).startswith(f"<{AUXILIARY}") for atom in atoms)
