"""Why a row of an answer is there: the facts that the query matched for it, each with its proof."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import Place, RuleError
from kg.query.guard import check
from kg.rules.decompose import decompose
from kg.rules.explain.derivations import bound_by, derivation_of
from kg.rules.explain.why import why
from kg.syntax.lexer import Kind, normalise, tokens
from kg.syntax.parser import parse_rq

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.rules.explain.proof import Condition, Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule, Term
    from kg.syntax.lexer import Token

__all__ = ["RowProof", "why_row"]

_NAME: Final = "query"
_ROW: Final = "<urn:kg:row>"
_WHOLE: Final = re.compile(
    r"(?<=\{)\s*SELECT\s+\*\s+WHERE(?=\s*\{)|(?<=\})\s*(?:LIMIT\s+\d+|ORDER\s+BY\s+\?\w+)(?=\s*\})"
)
"""What makes an inner SELECT of a group whose variables it all gives: a row's facts are those of the group."""
_UNBOUND: Final = "KG203"
"""Of a variable that only an inner SELECT knows."""
_HINT: Final = "Rows of queries that group or count are explained by asking for the rows behind them."
_MERGING: Final = frozenset(
    {"AVG", "COUNT", "DISTINCT", "GROUP", "GROUP_CONCAT", "HAVING", "MAX", "MIN", "REDUCED", "SAMPLE", "SUM"}
)
"""Words outside of the WHERE clause that make one row of many solutions."""
_MOST: Final = 1000
"""So many solutions of a row are counted."""


@dataclass(frozen=True, slots=True)
class RowProof:
    """The proof of a row: proofs of the facts of one solution of the query, and the `conditions` that held.

    `solutions` is their number if the query makes one row of many by grouping, counting or DISTINCT; more than
    1,000 are not counted.
    """

    proofs: tuple[Proof, ...]
    conditions: tuple[Condition, ...]
    solutions: int = 1

    @property
    def remark(self) -> str | None:
        """A sentence with the number of solutions, None if this is the only one."""
        if self.solutions == 1:
            return None
        more = " or more" if self.solutions == _MOST else ""
        return f"this is one of {self.solutions:,}{more} solutions that make the row"


def why_row(view: View, rules: tuple[Rule, ...], text: str, row: Mapping[str, Term]) -> RowProof:
    """Return the proofs of the facts that the SELECT query `text` matched for a row.

    Raises:
        QueryError: KG502 or KG516 for a query that is refused.
        RuleError: KG201 for a query that is not a SELECT, KG226 when the row cannot be traced back.
    """
    text = _WHOLE.sub("", normalise(text))
    found = list(tokens(text))
    check(found, text)
    start, opening, end = _clauses(found)
    merged = any(token.text.upper() in _MERGING for token in (*found[start:opening], *found[end:]))
    derivation, solutions = None, 0
    for part in _parts(text, found, (start, opening, end)):
        names = bound_by(part.body)
        known = {name: term for name, term in row.items() if name in names}
        for solution in view.solutions(part.body, names, known, _MOST if merged else 1):
            derivation = derivation or derivation_of(view, part, solution)
            solutions += 1
        if derivation is not None and not merged:
            break
    if derivation is None:
        raise RuleError("KG226", "the row cannot be traced back to facts", hint=_HINT)
    proofs = tuple(why(view, rules, each) for each in derivation.facts)
    return RowProof(proofs, derivation.conditions, min(solutions, _MOST))


def _clauses(found: Sequence[Token]) -> tuple[int, int, int]:
    """Return where SELECT is among the tokens of a query, where its WHERE clause opens, and where that ends."""
    start = next((index for index, token in enumerate(found) if _is(token, "SELECT")), None)
    if start is None:
        raise RuleError("KG201", "only rows of SELECT queries can be explained", place=Place(_NAME), hint=_HINT)
    opening, brackets, braces = 0, 0, 0
    for index, token in enumerate(found[start:], start):
        brackets += (token.text == "(") - (token.text == ")")
        if brackets and not opening:
            continue
        if token.text == "{":
            opening = opening or index
        braces += (token.text == "{") - (token.text == "}")
        if opening and braces == 0:
            return start, opening, index + 1
    raise RuleError("KG201", "the query does not end", place=Place(_NAME), hint=_HINT)


def _parts(text: str, found: Sequence[Token], clauses: tuple[int, int, int]) -> tuple[Rule, ...]:
    """Return the WHERE clause of a SELECT query as rules whose head mentions all its variables."""
    start, opening, end = clauses
    where = found[opening:end]
    names = {token.text[1:] for token in where if token.kind is Kind.VARIABLE}
    head = " . ".join(f"{_ROW} {_ROW} ?{name}" for name in sorted(names))
    group = text[where[0].start : where[-1].end]
    return _read(f"{text[: found[start].start]}CONSTRUCT {{ {head} }} WHERE {group}")


def _read(rule: str) -> tuple[Rule, ...]:
    try:
        return decompose(parse_rq(rule, _NAME).rules[0], _NAME, _NAME, rule)
    except RuleError as error:
        if error.code != _UNBOUND:
            raise
        raise RuleError("KG226", "the row cannot be traced back to facts", hint=_HINT) from error


def _is(token: Token, word: str) -> bool:
    return token.kind is Kind.WORD and token.text.upper() == word
