"""Rules as SPARQL 1.2 RL (`.srl`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules import form, sparql
from kg.rules.printing.rq import head, refusal, with_prefixes
from kg.syntax.functions import FUNCTIONS, RULE_FUNCTIONS
from kg.syntax.lexer import Kind, bare, tokens_of
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pyoxigraph import Triple


_MISSING = {
    form.Aggregate: "aggregates",
    form.EngineBlock: "more of SPARQL than patterns and filters, which was left to the store's engine",
    form.Values: "VALUES",
    form.Exists: "EXISTS",
}

_MIXED = "reads asserted data for a part of its body"


def to_srl(rules: Sequence[form.Rule], prefixes: Mapping[str, str] = PREFIXES, data: Sequence[Triple] = ()) -> str:
    """Return the rules, and the triples that their file states, as a rule set.

    RuleError KG209 for aggregates, VALUES, EXISTS, blocks of SPARQL, and functions that SPARQL RL lacks; for a body
    that mixes asserted and other triples in one place; for blank nodes of the data.
    """
    stated = head(form.Atom(triple.subject, triple.predicate, triple.object) for triple in data)
    parts = [f"DATA {{\n{sparql.indented(stated)}\n}}"] if stated else []
    return with_prefixes("\n\n".join([*parts, *map(_rule, rules)]), prefixes)


def _rule(rule: form.Rule) -> str:
    data = "DATA " if _only_asserted(rule, rule.body) else ""
    body = "\n".join(_elements(rule, rule.body, asserted=bool(data)))
    return f"RULE {{\n{sparql.indented(head(rule.head))}\n}} WHERE {data}{{\n{sparql.indented(body)}\n}}"


def _only_asserted(rule: form.Rule, body: tuple[form.Element, ...]) -> bool:
    """Return whether the triples of a body are asserted ones."""
    kinds = {element.asserted for element in body if isinstance(element, form.Atom)}
    if len(kinds) > 1:
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    return kinds == {True}


def _elements(
    rule: form.Rule, body: tuple[form.Element, ...], *, asserted: bool, inside: bool = False
) -> Iterator[str]:
    for element in body:
        if isinstance(element, form.Atom):
            yield sparql.group((form.Atom(*element.positions, place=element.place),))
        elif isinstance(element, form.Filter):
            yield f"FILTER({_expression(rule, element.expression)})"
        elif isinstance(element, form.Assignment) and not inside:
            yield f"SET({sparql.spelling(element.variable)} := {_expression(rule, element.expression)})"
        elif isinstance(element, form.Exists) and element.negated and not inside:
            yield _negation(rule, element, asserted=asserted)
        else:
            what = _MISSING.get(type(element), "an assignment inside NOT")
            raise refusal(rule, f"has {what}; SPARQL RL has none", "Print it as .rq.")


def _negation(rule: form.Rule, element: form.Exists, *, asserted: bool) -> str:
    if asserted and not all(atom.asserted for atom, _ in form.atoms_of(element.body)):
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    data = "DATA " if not asserted and _only_asserted(rule, element.body) else ""
    inner = "\n".join(_elements(rule, element.body, asserted=asserted, inside=True))
    return f"NOT {data}{{\n{sparql.indented(inner)}\n}}"


def _expression(rule: form.Rule, expression: form.Expression) -> str:
    for token in tokens_of(expression.text):
        name = token.text.upper()
        if token.kind is Kind.WORD and name in FUNCTIONS and name not in RULE_FUNCTIONS:
            raise refusal(rule, f"calls {name}; SPARQL RL has no such function", "Print it as .rq.")
    return bare(expression.text)
