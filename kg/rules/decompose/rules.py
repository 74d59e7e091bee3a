"""From a rule as written to rules of the internal form."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.errors import RuleError
from kg.rules.decompose.blocks import block
from kg.rules.decompose.finishing import finished
from kg.rules.decompose.groups import Groups
from kg.rules.decompose.parts import IndivisibleError, Scope
from kg.rules.decompose.uses import possible
from kg.rules.decompose.work import Work, head_variables
from kg.rules.form import Atom, Rule, atoms_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.decompose.finishing import Statement
    from kg.syntax.tree import RuleText, TriplePattern

__all__ = ["decompose"]


def decompose(rule: RuleText, name: str, path: str, text: str) -> tuple[Rule, ...]:
    """Return the rules that together derive what a rule as written derives, and those of its auxiliary predicates.

    `text` is the file's, which spans count in, and `path` what places name. The parts count from one; none at all come
    of a rule whose pattern has no solution in any graph. RuleError KG203 for a variable of the head that the pattern
    never binds.
    """
    work = Work(rule, text, path)
    _check_head(work)
    try:
        statements = _statements(work)
    except IndivisibleError:
        work = Work(rule, text, path)
        statements = [_whole(work)]
    place = work.place(rule.span)
    every = dict.fromkeys([*statements, *_auxiliary(work, statements)])
    return tuple(Rule(name, head, body, place, part) for part, (head, body) in enumerate(every, 1))


def _auxiliary(work: Work, statements: list[Statement]) -> Iterator[Statement]:
    """Yield the rules of the auxiliary predicates that statements read, at once or through others."""
    reached: dict[str, None] = {}
    waiting = [body for _, body in statements]
    while waiting:
        for atom, _ in atoms_of(waiting.pop()):
            name = atom.predicate.value if isinstance(atom.predicate, NamedNode) else ""
            if name in work.auxiliary and name not in reached:
                reached[name] = None
                waiting += [body for _, body in work.auxiliary[name]]
    for name in reached:
        yield from work.auxiliary[name]


def _check_head(work: Work) -> None:
    """Raise KG203 for a variable that no solution binds."""
    bound = possible(work.rule.group.nodes)
    for triple in work.rule.template:
        for name in sorted(head_variables(triple) - bound):
            raise RuleError(
                "KG203",
                f"`?{name}` is in the head, but nothing in the body binds it",
                place=work.place(triple.span),
                hint=f"Bind `?{name}` in the body, or leave the triple out.",
            )


def _statements(work: Work) -> list[Statement]:
    head = tuple(_atom(work, triple) for triple in work.rule.template)
    required = frozenset.intersection(*map(head_variables, work.rule.template)) if head else frozenset()
    scope = Scope(required=required)
    parts = Groups(work).group(work.rule.group, scope)
    found = [finished(head, part.elements, work.names) for part in parts]
    return [statement for statement in found if statement is not None]


def _atom(work: Work, triple: TriplePattern) -> Atom:
    subject, predicate, obj = triple.subject, triple.predicate, triple.object
    return Atom(subject, predicate, obj, place=work.place(triple.span))  # type: ignore[arg-type]  # a template has no paths


def _whole(work: Work) -> Statement:
    """Return the rule with its body left to the store's engine."""
    rule = work.rule
    place = work.place(rule.group.span)
    text = rule.group.text.strip()[1:-1]
    return tuple(_atom(work, triple) for triple in rule.template), (block(text, rule.group.nodes, place),)
