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
from kg.syntax.parser import parse_query, parse_rq

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.rules.explain.proof import Condition, Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule, Term

_NAME: Final = "query"
_ROW: Final = "<urn:kg:row>"
_WHOLE: Final = re.compile(
    r"(?<=\{)\s*SELECT\s+\*\s+WHERE(?=\s*\{)|(?<=\})\s*(?:LIMIT\s+\d+|ORDER\s+BY\s+\?\w+)(?=\s*\})"
)
"""What makes an inner SELECT of a group whose variables it all gives: a row's facts are those of the group."""
_UNBOUND: Final = "KG203"
"""Of a variable that only an inner SELECT knows."""
_REFUSED: Final = "KG209"
"""Of a part that rules do not have, such as a function of the time."""
_HINT: Final = "To explain a row of a query that groups or counts, query for the grouped rows."
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
    lexed = list(tokens(text))
    check(lexed, text)
    start = next((index for index, token in enumerate(lexed) if token.text.upper() == "SELECT"), None)
    if start is None:
        raise RuleError("KG201", "only rows of SELECT queries can be explained", place=Place(_NAME), hint=_HINT)
    where = parse_query(text, _NAME).group.span
    outside = (token.text.upper() for token in lexed[start:] if not where.start <= token.start < where.end)
    merged = not _MERGING.isdisjoint(outside)
    derivation, solutions = None, 0
    for part in _parts(text[: lexed[start].start], text[where.start : where.end]):
        names = bound_by(part.body)
        bound = {name: term for name, term in row.items() if name in names}
        for solution in view.solutions(part.body, names, bound, _MOST if merged else 1):
            derivation = derivation or derivation_of(view, part, solution)
            solutions += 1
        if derivation is not None and not merged:
            break
    if derivation is None:
        raise RuleError("KG226", "the row cannot be traced back to facts", hint=_HINT)
    proofs = tuple(why(view, rules, each) for each in derivation.facts)
    return RowProof(proofs, derivation.conditions, min(solutions, _MOST))


def _parts(prologue: str, where: str) -> tuple[Rule, ...]:
    """Return the WHERE clause of a SELECT query as rules whose head mentions all its variables."""
    names = {token.text[1:] for token in tokens(where) if token.kind is Kind.VARIABLE}
    head = " . ".join(f"{_ROW} {_ROW} ?{name}" for name in sorted(names))
    rule = f"{prologue}CONSTRUCT {{ {head} }} WHERE {where}"
    try:
        return decompose(parse_rq(rule, _NAME).rules[0], _NAME, _NAME, rule, alone=True)
    except RuleError as error:
        if error.code not in {_UNBOUND, _REFUSED}:
            raise
        why, hint = ("", _HINT) if error.code == _UNBOUND else (f": {error.message}", error.hint)
        raise RuleError("KG226", f"the row cannot be traced back to facts{why}", hint=hint) from error
