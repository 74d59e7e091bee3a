"""Property paths (SPARQL 1.1, section 9; SPARQL 1.2 RL has sequences and inverses only)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules.syntax.lexer import Kind
from kg.rules.syntax.terms import TYPE, Terms
from kg.rules.syntax.tree import Alternative, Inverse, Negated, Repeat, Sequence

if TYPE_CHECKING:
    from pyoxigraph import NamedNode

    from kg.rules.form import Variable
    from kg.rules.syntax.tree import Path

__all__ = ["Paths"]


class Paths(Terms):
    """Reads paths."""

    sequences_only = False
    """Whether the notation lacks alternatives, repetition and negation."""

    def path_or_variable(self) -> Path | Variable:
        """Read the predicate of a pattern."""
        return self.variable() if self.token.kind is Kind.VARIABLE else self._path()

    def _path(self) -> Path:
        parts = [self._sequence()]
        while self.at("|") and self._full("`|`"):
            self.advance()
            parts.append(self._sequence())
        return parts[0] if len(parts) == 1 else Alternative(tuple(parts))

    def _sequence(self) -> Path:
        parts = [self._inverse()]
        while self.accept("/"):
            parts.append(self._inverse())
        return parts[0] if len(parts) == 1 else Sequence(tuple(parts))

    def _inverse(self) -> Path:
        return Inverse(self._repeated()) if self.accept("^") else self._repeated()

    def _repeated(self) -> Path:
        path = self._primary()
        if self.at("*", "+", "?") and self._full(f"`{self.token.text}`"):
            sign = self.advance().text
            return Repeat(path, 1 if sign == "+" else 0, many=sign != "?")
        return path

    def _primary(self) -> Path:
        if self.at("("):
            with self.nested():
                self.advance()
                path = self._path()
                self.expect(")")
            return path
        if self.at("!") and self._full("`!`"):
            self.advance()
            return self._negated()
        return self._step("a predicate")

    def _step(self, what: str) -> NamedNode:
        if self.token.kind is Kind.WORD and self.token.text == "a":
            self.advance()
            return TYPE
        return self.iri(what)

    def _negated(self) -> Path:
        forward: list[NamedNode] = []
        backward: list[NamedNode] = []
        several = self.accept("(")
        while True:
            (backward if self.accept("^") else forward).append(self._step("a predicate behind `!`"))
            if not several:
                break
            if not self.accept("|"):
                self.expect(")", " or `|`")
                break
        return Negated(tuple(forward), tuple(backward))

    def _full(self, what: str) -> bool:
        """Refuse what the notation lacks; the truth otherwise."""
        if self.sequences_only:
            hint = "Paths of SPARQL RL are sequences `/` and inverses `^`; write several rules."
            raise self.error(f"{what} is not a path of SPARQL RL", self.token.start, hint=hint)
        return True
