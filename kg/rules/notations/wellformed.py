"""Well-formedness of SPARQL 1.2 RL (section 3.2 of its text): what a rule reads is bound where it reads it.

A filter and an assignment see the variables of the elements before them; inside NOT also those before the NOT. An
assignment names a variable that nothing before it has. The head has variables of the body only.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kg.errors import Fix, RuleError
from kg.similar import asked, similar
from kg.syntax.position import place_at
from kg.syntax.tree import Bind, Exists, Filter, TriplePattern, mentioned

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.syntax.tree import Expression, Node, RuleText, Span

__all__ = ["check"]


def check(rule: RuleText, path: str, text: str) -> None:
    """Raise RuleError KG203 at the first variable of a rule that is not bound, or is bound twice.

    `text` is that of the file, normalised: its lines end with line feeds.
    """
    checker = _Checker(path, text)
    bound = checker.sequence(rule.group.nodes, set())
    for pattern in rule.template:
        for name in sorted(mentioned((pattern,)) - bound):
            message = f"the head has `?{name}`, which the body does not bind"
            raise checker.unbound(name, pattern.span, message, bound)


class _Checker:
    """Has the text, for the places of variables in errors."""

    def __init__(self, path: str, text: str) -> None:
        self._path = path
        self._text = text

    def sequence(self, nodes: Iterable[Node], bound: set[str]) -> set[str]:
        """Check elements in their order and return the variables bound behind them."""
        bound = set(bound)
        for node in nodes:
            if isinstance(node, TriplePattern):
                bound |= mentioned((node,))
            elif isinstance(node, Filter):
                self._check(node.expression, bound, "FILTER")
            elif isinstance(node, Exists):
                self.sequence(node.group.nodes, bound)
            elif isinstance(node, Bind):
                self._check(node.expression, bound, "SET")
                self._check_new(node, bound)
                bound.add(node.variable.name)
        return bound

    def _check(self, expression: Expression, bound: set[str], what: str) -> None:
        for name in expression.variables:
            if name not in bound:
                message = f"{what} reads `?{name}`, which nothing before it binds"
                raise self.unbound(name, expression.span, message, bound)

    def _check_new(self, node: Bind, bound: set[str]) -> None:
        name = node.variable.name
        if name in bound:
            hint = "Give the result another name; compare the two with FILTER."
            raise self._error(name, node.span, f"SET assigns to `?{name}`, which is bound before it", hint)

    def unbound(self, name: str, span: Span, message: str, bound: set[str]) -> RuleError:
        """Return the error that a variable is not bound."""
        near = similar(name, {other for other in bound if not other.startswith(".")})
        hint = asked(near) or f"Bind `?{name}` by a triple or SET before it is read."
        return self._error(name, span, message, hint, [Fix(f"?{each}") for each in near])

    def _error(self, name: str, span: Span, message: str, hint: str, fixes: Iterable[Fix] = ()) -> RuleError:
        found = re.compile(rf"[?$]{re.escape(name)}(?!\w)").search(self._text, span.start, span.end)
        place = place_at(self._text, found.start() if found else span.start, self._path)
        return RuleError("KG203", message, place=place, hint=hint, fixes=fixes)
