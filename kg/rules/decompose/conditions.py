"""The filters of a group, cut into the smallest that together test the same."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kg.rules.decompose import expressions
from kg.rules.decompose.parts import IndivisibleError
from kg.syntax.tree import Exists, Filter

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.syntax.tree import Span

__all__ = ["Condition", "conditions"]


@dataclass(frozen=True, slots=True)
class Condition:
    """An expression, or an EXISTS; `requires` are the names without which it is never true."""

    text: str
    span: Span
    exists: Exists | None = None

    @property
    def requires(self) -> tuple[str, ...]:
        """An unbound variable is an error in an expression that has nothing to forgive it; BOUND asks for one."""
        if self.exists is None and expressions.simplified(self.text, expressions.variables(self.text)) == "true":
            return expressions.variables(self.text)
        strict = self.exists is None and expressions.is_strict(self.text)
        return expressions.variables(self.text) if strict else ()


def conditions(filters: Iterable[Filter | Exists]) -> list[Condition]:
    """Return the conditions of filters; IndivisibleError where an EXISTS is inside a larger expression."""
    return [condition for node in filters for condition in _conditions(node)]


def _conditions(node: Filter | Exists) -> Iterator[Condition]:
    if isinstance(node, Exists):
        yield Condition("", node.span, node)
    else:
        tests = iter(node.expression.exists)
        for text in expressions.conjuncts(node.expression.text):
            try:
                turned = expressions.existence(text)
            except ValueError:
                raise IndivisibleError from None
            if turned is None:
                yield Condition(text, node.span)
            else:
                test = next(tests)
                yield Condition("", test.span, replace(test, negated=test.negated ^ turned))
