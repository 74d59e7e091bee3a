"""Why a row of an answer is there: the facts that the query matched for it, each with its proof."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.errors import Place, RuleError
from kg.query.lexer import Kind, normalise, tokens
from kg.rules.explain.derivations import bound_by, derivation_of
from kg.rules.explain.why import why
from kg.rules.notations import rq
from kg.rules.syntax.units import parse_rq

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.query.lexer import Token
    from kg.rules.explain.proof import Condition, Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule, Term

__all__ = ["why_row"]

_NAME: Final = "query"
_ROW: Final = "<urn:kg:row>"
_HINT: Final = "Rows of queries that group or count are explained by asking for the rows behind them."


def why_row(
    view: View, rules: tuple[Rule, ...], text: str, row: Mapping[str, Term]
) -> tuple[tuple[Proof, ...], tuple[Condition, ...]]:
    """Return the proofs of the facts that the SELECT query `text` matched for a row, and the conditions that held.

    Raises:
        RuleError: KG201 for a query that is no SELECT, KG226 when the row cannot be traced back.
    """
    for part in _parts(text):
        names = bound_by(part.body)
        known = {name: term for name, term in row.items() if name in names}
        for solution in view.solutions(part.body, names, known, 1):
            derivation = derivation_of(view, part, solution)
            if derivation is not None:
                return tuple(why(view, rules, each) for each in derivation.facts), derivation.conditions
    raise RuleError("KG226", "the row cannot be traced back to facts", hint=_HINT)


def _parts(text: str) -> tuple[Rule, ...]:
    """Return the WHERE clause of a SELECT query as rules whose head mentions all its variables."""
    text = normalise(text)
    found = list(tokens(text))
    start = next((index for index, token in enumerate(found) if _is(token, "SELECT")), None)
    if start is None:
        raise RuleError("KG201", "only rows of SELECT queries can be explained", place=Place(_NAME), hint=_HINT)
    opening = next(index for index in range(start, len(found)) if found[index].text == "{")
    depth = 0
    for token in found[opening:]:
        depth += (token.text == "{") - (token.text == "}")
        if depth == 0:
            group = text[found[opening].start : token.end]
            names = {each.text[1:] for each in found[opening:] if each.kind is Kind.VARIABLE and each.end <= token.end}
            head = " . ".join(f"{_ROW} {_ROW} ?{name}" for name in sorted(names))
            rule = f"{text[: found[start].start]}CONSTRUCT {{ {head} }} WHERE {group}"
            return rq.rules(parse_rq(rule, _NAME), _NAME, _NAME, rule)
    raise RuleError("KG201", "the query does not end", place=Place(_NAME), hint=_HINT)


def _is(token: Token, word: str) -> bool:
    return token.kind is Kind.WORD and token.text.upper() == word
