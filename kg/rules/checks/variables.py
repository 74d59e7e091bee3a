"""Checks of variables: parts of a body that share none (KG212), and those that are in one place only (KG217)."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from kg.errors import Fix
from kg.rules.checks.finding import Context, Finding, at_offset, at_rule, variables
from kg.rules.form import Atom, Exists, Rule, Variable, atoms_of, binds, mentions
from kg.similar import misspelt, suggest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.files import RuleFile


def cartesian_product(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file in which a body falls into parts without a common variable."""
    for rule in file.rules:
        parts = _parts(rule)
        if len(parts) > 1:
            named = ({variable for variable in part if not variable.name.startswith(".")} or part for part in parts)
            shown = " and ".join(", ".join(sorted(map(str, part))) for part in named)
            message = f"nothing joins {shown}: every match of one goes with every match of the other"
            second = (each.place for each in rule.body if isinstance(each, Atom) and binds(each) & parts[1])
            hint = "Join them by a variable, or by a filter that compares them."
            yield Finding("KG212", "warning", file.name, message, next(second, None) or at_rule(file), hint)
            return


def _parts(rule: Rule) -> list[set[Variable]]:
    """Return the variables that atoms bind, in groups that some element of the body joins."""
    groups: list[set[Variable]] = []
    for element in rule.body:
        together = set(mentions(element) if isinstance(element, Exists) else mentions(element) | binds(element))
        if isinstance(element, Exists) or not together:
            continue
        joined = [group for group in groups if group & together]
        groups = [group for group in groups if not group & together]
        groups.append(together.union(*joined))
    return groups


def variable_used_once(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield each variable that occurs once in a file; a `_` before the name marks it as intended."""
    occurrences = list(variables(file))
    blank = {variable.name for variable in _replaceable(file)}
    uses = Counter(token.text[1:] for token in occurrences)
    for token in occurrences:
        sign, name = token.text[0], token.text[1:]
        if uses[name] == 1 and not name.startswith("_"):
            others = [other for other in uses if other != name]
            near = misspelt(name, others)
            intended = [f"{sign}_{name}", *["[]"] * (name in blank)]
            fixes = (*(Fix(f"{sign}{each}") for each in near), *map(Fix, intended))
            message = f"the variable ?{name} is used only here"
            advice = (
                f"Write `[]`, or ?_{name} if that is meant." if name in blank else f"Write ?_{name} if it is meant."
            )
            place, hint = at_offset(file, token.start), suggest(near) or advice
            yield Finding("KG217", "warning", file.name, message, place, hint, fixes=fixes)


def _replaceable(file: RuleFile) -> set[Variable]:
    """Return the variables that `[]` may replace: those that are only subjects or objects."""
    atoms = [atom for rule in file.rules for atom, _ in atoms_of(rule.body)]
    ends = {end for atom in atoms for end in (atom.subject, atom.object) if isinstance(end, Variable)}
    return ends - {atom.predicate for atom in atoms if isinstance(atom.predicate, Variable)}
