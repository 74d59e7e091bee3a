"""Expressions (SPARQL 1.2, section 19.8, productions from Expression on).

They are checked and spelt anew, not made into a tree: the store's engine evaluates them from their text.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.rules.syntax.cursor import MAX_NESTING
from kg.rules.syntax.functions import AGGREGATES, FUNCTIONS, Arguments
from kg.rules.syntax.lexer import Kind, as_operator
from kg.rules.syntax.terms import Mode
from kg.rules.syntax.tree import AggregateCall, Exists, Expression
from kg.rules.syntax.triples import Triples
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.rules.syntax.tree import Group

__all__ = ["Expressions"]

_COMPARISONS: Final = ("=", "!=", "<", ">", "<=", ">=")
_ARITHMETIC: Final = ("+", "-", "*", "/")


@dataclass(slots=True)
class _Found:
    """What an expression has, as far as it is read."""

    functions: set[str] = field(default_factory=set)
    exists: list[Exists] = field(default_factory=list)
    aggregates: list[AggregateCall] = field(default_factory=list)


class Expressions(Triples):
    """Reads expressions."""

    functions: Mapping[str, Arguments] = FUNCTIONS
    """The built-in functions of the notation."""

    patterns_in_expressions = True
    """Whether the notation has EXISTS."""

    aggregates_allowed = False
    """Whether an aggregate may stand in what is read now."""

    def __init__(self, text: str, path: str, *, prefixes: Mapping[str, str], base: str | None = None) -> None:
        super().__init__(text, path, prefixes=prefixes, base=base)
        self._open: list[_Found] = []

    @abstractmethod
    def group(self) -> Group:
        """Read a group in braces."""

    def expression(self) -> Expression:
        """Read an expression."""
        start, first = self.token.start, len(self.consumed)
        self._open.append(_Found())
        self._operations()
        return self._closed(start, first)

    def constraint(self) -> Expression:
        """Read what FILTER and HAVING take: an expression in brackets or the call of a function."""
        start, first = self.token.start, len(self.consumed)
        self._open.append(_Found())
        if self.at("("):
            self._bracketed_expression()
        elif self.token.kind is Kind.WORD:
            self._called_word("`(` or a function")
        else:
            self._open[-1].functions.add(self.iri("`(` or a function").value)
            self._arguments()
        return self._closed(start, first)

    def _closed(self, start: int, first: int) -> Expression:
        found = self._open.pop()
        tokens = self.consumed[first:]
        grouped = [call.span for call in found.aggregates]
        names = dict.fromkeys(
            token.text[1:]
            for token in tokens
            if token.kind is Kind.VARIABLE and not any(span.start < token.start < span.end for span in grouped)
        )
        return Expression(
            self.spelling(tokens),
            tuple(names),
            frozenset(found.functions),
            self.span(start),
            tuple(found.exists),
            tuple(found.aggregates),
        )

    def _operations(self) -> None:
        """Read operands and the operators between them; how they bind is the engine's to know."""
        compared = False
        self._operand()
        while True:
            self.token = as_operator(self.token)
            if self.at("&&", "||"):
                compared = False
            elif self.at(*_COMPARISONS) or self.at_word("IN", "NOT"):
                if compared:
                    raise self.error("comparisons do not chain", self.token.start, hint="Join two with `&&`.")
                compared = True
                if self.token.kind is Kind.WORD:
                    self._membership()
                    continue
            elif self.at(*_ARITHMETIC):
                self._open[-1].functions.add(self.token.text)
            else:
                return
            self.advance()
            self._operand()

    def _membership(self) -> None:
        self.accept_word("NOT")
        self.expect_word("IN")
        self._arguments()

    def _operand(self) -> None:
        """Read an operand with the signs before it: any number of `!`, or one `-` or `+`."""
        signs = 0
        while self.accept("!"):
            signs += 1
            if signs > MAX_NESTING:
                raise self.error(f"the rule nests deeper than {MAX_NESTING}", self.token.start)
        if not self.at_signed():
            self.accept("-", "+")
        self._primary_expression()

    def _primary_expression(self) -> None:
        with self.nested():
            if self.at("("):
                self._bracketed_expression()
            elif self.at("<<("):
                self.triple_term(Mode.PATTERN)
            elif self.at_iri():
                name = self.iri()
                if self.at("("):
                    self._open[-1].functions.add(name.value)
                    self._arguments()
            elif self.token.kind is Kind.VARIABLE:
                self.advance()
            elif self.at_literal():
                self.literal()
            else:
                self._called_word("an expression")

    def _bracketed_expression(self) -> None:
        self.expect("(")
        self._operations()
        self.expect(")", " or an operator")

    def _called_word(self, what: str) -> None:
        """Read the call of a built-in function, of an aggregate, or EXISTS."""
        name = self.token.text.upper()
        if self.token.kind is not Kind.WORD:
            raise self.expected(what)
        if name in {"NOT", "EXISTS"} and self.patterns_in_expressions:
            self._existence()
        elif name in AGGREGATES and self.aggregates_allowed:
            self._aggregate(name)
        elif name in self.functions:
            self._built_in(name)
        else:
            raise self._unknown_function(what)

    def _unknown_function(self, what: str) -> Exception:
        name = self.token.text
        if name.upper() in AGGREGATES and self.patterns_in_expressions:
            hint = "Aggregates stand in a sub-SELECT, in its columns or behind HAVING."
            return self.error(f"the aggregate {name.upper()} cannot stand here", self.token.start, hint=hint)
        if name.upper() in FUNCTIONS or name.upper() in {"EXISTS", *AGGREGATES}:
            return self.error(f"SPARQL RL has no {name.upper()}", self.token.start)
        if self.text[self.token.end :].lstrip().startswith("("):
            near = did_you_mean(name.upper(), self.functions)
            return self.error(f"unknown function `{name}`", self.token.start, hint=near)
        return self.expected(what, self.functions)

    def _built_in(self, name: str) -> None:
        token = self.advance()
        self._open[-1].functions.add(name)
        if name == "BOUND" and self.at("("):
            self.advance()
            self.variable()
            self.expect(")")
            return
        count = self._arguments()
        fewest, most = self.functions[name]
        if count < fewest or (most is not None and count > most):
            takes = f"{fewest}" if most == fewest else f"{fewest} to {most}"
            raise self.error(f"{name} takes {takes} argument{'' if takes == '1' else 's'}, not {count}", token.start)

    def _arguments(self) -> int:
        """Read arguments in brackets and return how many there are."""
        self.expect("(")
        if self.accept(")"):
            return 0
        count = 1
        self._operations()
        while self.accept(","):
            self._operations()
            count += 1
        self.expect(")", " or `,`")
        return count

    def _existence(self) -> None:
        start = self.token.start
        negated = self.accept_word("NOT")
        self.expect_word("EXISTS")
        group = self.group()
        self._open[-1].exists.append(Exists(group, negated, asserted=False, span=self.span(start)))

    def _aggregate(self, name: str) -> None:
        start, first = self.token.start, len(self.consumed)
        self.advance()
        self.expect("(")
        distinct = self.accept_word("DISTINCT")
        self.aggregates_allowed = False
        argument = None if name == "COUNT" and self.accept("*") else self.expression()
        self.aggregates_allowed = True
        separator = self._separator() if name == "GROUP_CONCAT" else " "
        self.expect(")")
        text = self.spelling(self.consumed[first:])
        call = AggregateCall(name, argument, distinct, separator, self.span(start), text)
        self._open[-1].aggregates.append(call)

    def _separator(self) -> str:
        if not self.accept(";"):
            return " "
        self.expect_word("SEPARATOR")
        self.expect("=")
        return self.string()
