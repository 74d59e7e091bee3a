"""Rules as written, in any notation, become rules of the internal form.

Only what is exact is taken apart; the rest stays SPARQL, in an `EngineBlock`. Why each rewriting is exact is in the
module that does it: paths in `paths` and `patterns`, groups and sub-SELECTs in `groups`. All are exact for
sets of solutions: a rule derives a triple or not, how often does not matter. Where it does, inside aggregates, only
what keeps the number of solutions is taken apart.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.errors import Fix, RuleError
from kg.rules import form, sparql
from kg.rules.decompose.blocks import block
from kg.rules.decompose.calls import prepared
from kg.rules.decompose.groups import Groups
from kg.rules.decompose.parts import IndivisibleError, Names, Scope, Work, head_variables
from kg.rules.decompose.renaming import everywhere, possible, renamed
from kg.similar import misspelt, suggest
from kg.syntax.lexer import normalise
from kg.syntax.position import place_at, place_of_variable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.syntax.tree import RuleText, TriplePattern

__all__ = ["decompose"]


Statement = tuple[tuple[form.Atom, ...], tuple["form.Element", ...]]
"""A head and a body."""

MOST_ROWS: Final = 16
"""How many rows of VALUES, or choices from several, become rules of their own."""


def finished(head: tuple[form.Atom, ...], body: tuple[form.Element, ...], names: Names) -> Statement | None:
    """Return a rule's head and body as they stay; None if nothing comes of the part.

    IndivisibleError where a block may leave a variable unbound that another element mentions.
    """
    # Variables of blank nodes that are used in expressions or blocks get names that SPARQL can write.
    written = set(_expressions(body))
    hidden = {variable for variable in everywhere(body) if variable.name.startswith(".")}
    chosen = sorted((one for one in hidden if sparql.spelling(one)[1:] in written), key=str)
    body = renamed(body, {variable: names.like(variable) for variable in chosen})
    head, body = _without_copies(head, body)
    _check_blocks(body)
    bound = form.bound_in(body)
    atoms = tuple(atom for atom in head if form.binds(atom) <= bound)
    return (atoms, body) if atoms else None


def _expressions(body: Sequence[form.Element]) -> Iterator[str]:
    """Yield the names in expressions and blocks at any depth, as they are spelt there."""
    for element in body:
        if isinstance(element, form.Filter | form.Assignment):
            yield from element.expression.variables
        elif isinstance(element, form.EngineBlock):
            yield from (sparql.spelling(variable)[1:] for variable in element.variables)
        elif isinstance(element, form.Exists | form.Aggregate):
            yield from _expressions(element.body)


def _without_copies(head: tuple[form.Atom, ...], body: tuple[form.Element, ...]) -> Statement:
    """Use a variable in the place of one that is assigned its value: a solution has the same term for both."""
    index = 0
    while index < len(body):
        names = _copied(body[index], body[index + 1 :])
        if not names:
            index += 1
            continue
        head = tuple(atom.replaced(names) for atom in head)
        # Only where the variable is meant: text may have another of that name inside.
        rest = (renamed([e], names)[0] if names.keys() & form.mentions(e) else e for e in body[index + 1 :])
        body = (*body[:index], *rest)
    return head, body


def _copied(element: form.Element, rest: tuple[form.Element, ...]) -> dict[form.Variable, form.Variable]:
    """Return the variable that an element assigns and that whose value it gets; none if the `rest` needs both."""
    if not isinstance(element, form.Assignment):
        return {}
    value = element.expression
    users = [other for other in rest if element.variable in form.mentions(other)]
    simple = all(isinstance(other, form.Atom | form.Filter | form.Assignment) for other in users)
    copies = value.text == f"?{''.join(value.variables)}"
    return {element.variable: form.Variable(value.variables[0])} if simple and copies else {}


def _check_blocks(body: tuple[form.Element, ...]) -> None:
    for index, element in enumerate(body):
        if isinstance(element, form.Exists | form.Aggregate):
            _check_blocks(element.body)
        inner = element.body if isinstance(element, form.Exists) else (element,)
        open_ends = {variable for one in inner if isinstance(one, form.EngineBlock) for variable in one.optional}
        if open_ends and any(open_ends & form.mentions(one) for one in (*body[:index], *body[index + 1 :])):
            raise IndivisibleError


def decompose(rule: RuleText, name: str, path: str, text: str, *, alone: bool = False) -> tuple[form.Rule, ...]:
    """Return the rules that together derive what a rule as written derives, and those of its auxiliary predicates.

    `text` is the file's, which spans count in, and `path` what places name. The parts count from one; none at all come
    of a rule whose pattern has no solution in any graph. One that runs `alone` keeps its VALUES as they are, since it
    depends on no other rule. RuleError KG203 for a variable of the head that the pattern
    never binds, KG201 and KG209 for calls of functions that rules cannot call.
    """
    written = normalise(text)
    rule = prepared(rule, lambda span: place_at(written, span.start, path))
    work = Work(rule, text, path)
    _check_head(work)
    try:
        statements = _statements(work)
    except IndivisibleError:
        work = Work(rule, text, path)
        statements = [_whole(work)]
    if not alone:
        statements = [unfolded for statement in statements for unfolded in _unfolded(*statement)]
    place = work.place(rule.span)
    every = dict.fromkeys([*statements, *_auxiliary(work, statements)])
    return tuple(form.Rule(name, head, body, place, part) for part, (head, body) in enumerate(every, 1))


def _unfolded(head: tuple[form.Atom, ...], body: tuple[form.Element, ...]) -> Iterator[Statement]:
    """Yield one rule for each row of the VALUES that list predicates or classes; the rule itself where that are many.

    Each then names what it reads and writes. With a variable there, a rule depends on all that derive any predicate or
    any class, and most negations become cycles.
    """
    names = {*form.names_in(head), *form.names_in(body)}
    lists = [one for one in body if isinstance(one, form.Values) and names.intersection(one.variables)]
    lists = [one for one in lists if 1 < len(one.rows) <= MOST_ROWS]
    if not lists or math.prod(len(one.rows) for one in lists) > MOST_ROWS:
        yield head, body
        return
    for row in lists[0].rows:
        cells = zip(lists[0].variables, row, strict=True)
        terms = {variable: term for variable, term in cells if isinstance(term, NamedNode)}
        one = form.Values(lists[0].variables, (row,))
        rest = form.filled((one if each is lists[0] else each for each in body), terms)
        yield from _unfolded(tuple(atom.replaced(terms) for atom in head), rest)


def _auxiliary(work: Work, statements: list[Statement]) -> Iterator[Statement]:
    """Yield the rules of the auxiliary predicates that statements read, at once or through others."""
    reached: dict[str, None] = {}
    waiting = [body for _, body in statements]
    while waiting:
        for atom, _ in form.atoms_of(waiting.pop()):
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
            near = [f"?{other}" for other in misspelt(name, (each for each in bound if not each.startswith(".")))]
            raise RuleError(
                "KG203",
                f"`?{name}` is in the head, but nothing in the body binds it",
                place=place_of_variable(work.written, name, triple.span.start, triple.span.end, work.path),
                hint=suggest(near) or f"Bind `?{name}` in the body, or leave the triple out.",
                fixes=map(Fix, near),
            )


def _statements(work: Work) -> list[Statement]:
    head = tuple(_atom(work, triple) for triple in work.rule.template)
    required = frozenset.intersection(*map(head_variables, work.rule.template)) if head else frozenset()
    parts = Groups(work).group(work.rule.group, Scope(required=required))
    statements = [finished(head, part.elements, work.names) for part in parts]
    return [statement for statement in statements if statement is not None]


def _atom(work: Work, triple: TriplePattern) -> form.Atom:
    subject, predicate, obj = triple.subject, triple.predicate, triple.object
    return form.Atom(subject, predicate, obj, place=work.place(triple.span))  # type: ignore[arg-type]  # a template has no paths


def _whole(work: Work) -> Statement:
    """Return the rule with its body left to the store's engine."""
    rule = work.rule
    place = work.place(rule.group.span)
    text = rule.group.text.strip()[1:-1]
    return tuple(_atom(work, triple) for triple in rule.template), (block(text, rule.group.nodes, place),)
