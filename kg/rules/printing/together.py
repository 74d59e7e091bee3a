"""Several rules as one: a CONSTRUCT whose pattern is the union of their bodies.

The template of a query is filled from every solution, so a triple of one rule must have a variable that the bodies of
the others do not bind: CONSTRUCT leaves it out there. Rules with other heads get variables of their own for that.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pyoxigraph import BlankNode

from kg.errors import Place
from kg.rules.decompose.renaming import everywhere, renamed
from kg.rules.decompose.work import Names
from kg.rules.form import Atom, Rule, TripleTerm, binds, bound_in, is_auxiliary

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.rules.files import RuleFile
    from kg.rules.form import Pattern, Variable


def together(rules: Sequence[Rule]) -> list[Rule] | None:
    """Return rules that a CONSTRUCT of all their heads and the union of their bodies expresses.

    Auxiliary rules are left out. None if a head has no variable to tell it from the others.
    """
    groups: list[list[Rule]] = []
    for rule in rules:
        if not is_auxiliary(rule.head[0].predicate):
            # Two rules never share the nodes that they create.
            fitting = next((group for group in groups if not rule.creates_nodes and _fit([*group, rule])), None)
            if fitting is None:
                groups.append([rule])
            else:
                fitting.append(rule)
    if len(groups) > 1:
        names = Names(variable.name for rule in rules for variable in variables_of(rule))
        groups = [_apart(group, number, names) for number, group in enumerate(groups, 1)]
    ordered = [rule for group in groups for rule in group]
    return ordered if _fit(ordered) else None


def of_data(file: RuleFile) -> Iterator[Rule]:
    """Yield the rule without a pattern that derives the triples of DATA, if a file has any."""
    if file.data:
        stated = tuple(Atom(triple.subject, triple.predicate, triple.object) for triple in file.data)
        yield Rule(file.name, stated, (), Place(str(file.path)), part=len(file.rules) + 1)


def _fit(rules: Sequence[Rule]) -> bool:
    """Return whether no body binds all variables of a triple that its rule does not derive."""
    template = {atom for rule in rules for atom in rule.head}
    return all(not binds(atom) <= bound_in(rule.body) for rule in rules for atom in template.difference(rule.head))


def variables_of(rule: Rule) -> frozenset[Variable]:
    """Return the variables of a rule, at any depth."""
    return everywhere(rule.body).union(*map(binds, rule.head))


def called(rule: Rule, names: Mapping[Variable, Variable]) -> Rule:
    """Return a rule with other names for variables."""
    return replace(rule, head=tuple(atom.replaced(names) for atom in rule.head), body=renamed(rule.body, names))


def _apart(group: Sequence[Rule], number: int, names: Names) -> list[Rule]:
    """Return rules with variables and labels of their own."""
    own = sorted(frozenset().union(*map(variables_of, group)), key=str)
    new = {variable: names.like(variable) for variable in own}
    result = []
    for rule in (called(rule, new) for rule in group):
        labelled = (
            replace(atom, subject=_label(atom.subject, number), object=_label(atom.object, number))
            for atom in rule.head
        )
        result.append(replace(rule, head=tuple(labelled)))
    return result


def _label(pattern: Pattern, number: int) -> Pattern:
    if isinstance(pattern, BlankNode):
        return BlankNode(f"g{number}-{pattern.value}")
    if isinstance(pattern, TripleTerm):
        return TripleTerm(*(_label(part, number) for part in pattern))
    return pattern
