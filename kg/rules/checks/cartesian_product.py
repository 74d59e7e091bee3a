"""KG212: parts of a body without a shared variable: each match of one is combined with each of the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Finding, at_rule
from kg.rules.form import Atom, Exists
from kg.rules.scope import binds, mentions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.errors import Place
    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile
    from kg.rules.form import Rule, Variable

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG212"
TITLE: Final = "cartesian product"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield one finding for a file in which a body falls into parts without a common variable."""
    for rule in file.rules:
        parts = _parts(rule)
        if len(parts) > 1:
            shown = " and ".join(", ".join(sorted(map(str, _named(part) or part))) for part in parts)
            message = f"nothing joins {shown}: every match of one goes with every match of the other"
            place = _second(rule, parts[1]) or at_rule(file)
            hint = "Join them by a variable, or by a filter that compares them."
            yield Finding(CODE, "warning", file.name, message, place, hint)
            return


def _named(part: set[Variable]) -> set[Variable]:
    return {variable for variable in part if not variable.name.startswith(".")}


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


def _second(rule: Rule, part: set[Variable]) -> Place | None:
    return next((each.place for each in rule.body if isinstance(each, Atom) and binds(each) & part), None)
