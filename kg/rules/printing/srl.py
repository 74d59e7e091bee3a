"""Rules as SPARQL 1.2 RL (`.srl`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules import sparql
from kg.rules.decompose.expressions import bare
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Expression,
    Filter,
    Rule,
    Values,
    atoms_of,
)
from kg.rules.printing.words import head, refusal, with_prefixes
from kg.syntax.functions import FUNCTIONS, RULE_FUNCTIONS
from kg.syntax.lexer import Kind, tokens_of
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


_MISSING = {
    Aggregate: "aggregates",
    EngineBlock: "more of SPARQL than patterns and filters, which was left to the store's engine",
    Values: "VALUES",
    Exists: "EXISTS",
}

_MIXED = "reads asserted data for a part of its body"


def to_srl(rules: Sequence[Rule], prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return the rules as a rule set.

    RuleError KG209 for aggregates, VALUES, EXISTS, blocks of SPARQL, and functions that SPARQL RL lacks; for a body
    that mixes asserted and other triples in one place; for blank nodes of the data.
    """
    return with_prefixes("\n\n".join(map(_rule, rules)), prefixes)


def _rule(rule: Rule) -> str:
    data = "DATA " if _only_asserted(rule, rule.body) else ""
    body = "\n".join(_elements(rule, rule.body, asserted=bool(data)))
    return f"RULE {{\n{sparql.indented(head(rule.head))}\n}} WHERE {data}{{\n{sparql.indented(body)}\n}}"


def _only_asserted(rule: Rule, body: tuple[Element, ...]) -> bool:
    """Return whether the triples of a body are asserted ones."""
    found = {element.asserted for element in body if isinstance(element, Atom)}
    if len(found) > 1:
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    return found == {True}


def _elements(rule: Rule, body: tuple[Element, ...], *, asserted: bool, inside: bool = False) -> Iterator[str]:
    for element in body:
        if isinstance(element, Atom):
            yield sparql.group((Atom(*element.positions, place=element.place),))
        elif isinstance(element, Filter):
            yield f"FILTER({_expression(rule, element.expression)})"
        elif isinstance(element, Assignment) and not inside:
            yield f"SET({sparql.spelling(element.variable)} := {_expression(rule, element.expression)})"
        elif isinstance(element, Exists) and element.negated and not inside:
            yield _negation(rule, element, asserted=asserted)
        else:
            what = _MISSING.get(type(element), "an assignment inside NOT")
            raise refusal(rule, f"has {what}; SPARQL RL has none", "Print it as .rq.")


def _negation(rule: Rule, element: Exists, *, asserted: bool) -> str:
    if asserted and not all(atom.asserted for atom, _ in atoms_of(element.body)):
        raise refusal(rule, _MIXED, "SPARQL RL has DATA for a whole body or NOT.")
    data = "DATA " if not asserted and _only_asserted(rule, element.body) else ""
    inner = "\n".join(_elements(rule, element.body, asserted=asserted, inside=True))
    return f"NOT {data}{{\n{sparql.indented(inner)}\n}}"


def _expression(rule: Rule, expression: Expression) -> str:
    for token in tokens_of(expression.text):
        name = token.text.upper()
        if token.kind is Kind.WORD and name in FUNCTIONS and name not in RULE_FUNCTIONS:
            raise refusal(rule, f"calls {name}; SPARQL RL has no such function", "Print it as .rq.")
    return bare(expression.text)
