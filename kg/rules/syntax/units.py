"""Parsers of whole files: `.rq`, one SPARQL CONSTRUCT, and `.srl`, SPARQL 1.2 RL."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.query.prefixes import PREFIXES
from kg.rules.syntax.lexer import END, Kind
from kg.rules.syntax.patterns import Patterns
from kg.rules.syntax.rulesets import RuleSets
from kg.rules.syntax.terms import Mode
from kg.rules.syntax.tree import Group, RuleText, RuleUnit

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.rules.syntax.tree import TriplePattern

__all__ = ["parse_rq", "parse_srl"]


def parse_rq(text: str, path: str) -> RuleUnit:
    """Return the rule that a SPARQL CONSTRUCT states; `path` is what errors name.

    The prefixes of `kg.query.prefixes` are declared already. Raises RuleError: KG201 where the text is not SPARQL,
    KG209 for what rules may not do (other servers, other data sets, rows in an order or up to a limit).
    """
    return _parsed(_Construct(text, path, prefixes=PREFIXES))


def parse_srl(text: str, path: str) -> RuleUnit:
    """Return the rules, data and imports of a rule set of SPARQL 1.2 RL; `path` is what errors name.

    No prefix is declared already; relative IRIs are relative to the file. Raises RuleError KG201.
    """
    return _parsed(RuleSets(text, path, prefixes={}, base=Path(path).absolute().as_uri()))


def _parsed(parser: _Construct | RuleSets) -> RuleUnit:
    try:
        return parser.unit()
    except RecursionError:
        raise parser.error("the rule nests too deep", parser.token.start) from None


class _Construct(Patterns):
    """Reads a CONSTRUCT query."""

    def unit(self) -> RuleUnit:
        """Read the whole text."""
        self.begin_labels()
        self._prologue()
        rule = self._rule()
        if not self.at(END):
            raise self.expected("the end of the rule")
        return RuleUnit((rule,), (), (), self.prefixes)

    def _prologue(self) -> None:
        readers: dict[str, Callable[[], None]] = {"PREFIX": self.prefix, "BASE": self.base_iri, "VERSION": self.version}
        while self.at_word(*readers):
            readers[self.advance().text.upper()]()

    def _rule(self) -> RuleText:
        start = self.token.start
        hint = "A rule derives triples: CONSTRUCT { ... } WHERE { ... }."
        if self.at(END):
            raise self.error("there is no rule in this file", start, hint=hint)
        if self.token.kind is Kind.WORD and self.token.text.upper() in _OTHERS:
            raise self.error(f"a rule is a CONSTRUCT query, not {self.token.text.upper()}", start, hint=hint)
        if not self.at_word("CONSTRUCT"):
            raise self.expected("`CONSTRUCT`", ("CONSTRUCT", "PREFIX", "BASE"))
        self.advance()
        short = not self.at("{")
        template = () if short else self.template()
        self._refuse_dataset()
        if short:
            self.expect_word("WHERE")
            template, group = self._both()
        else:
            self.accept_word("WHERE")
            group = self.group()
        self._refuse_modifiers()
        if self.at_word("VALUES"):
            group = self._with_values(group, (), grouped=False)
        return RuleText(template, group, asserted=False, span=self.span(start))

    def template(self) -> tuple[TriplePattern, ...]:
        """Read triples in braces whose labels are new blank nodes."""
        self.expect("{")
        triples = self.triples(Mode.TEMPLATE)
        self.expect("}", " or `.`" if triples else " or triples")
        return tuple(triples)

    def _both(self) -> tuple[tuple[TriplePattern, ...], Group]:
        """Read triples that are template and pattern."""
        start, first, token = self.token.start, len(self.consumed), self.token
        template = self.template()
        spelt = self.spelling(self.consumed[first:])
        del self.consumed[first:]
        self.token = token
        self.expect("{")
        pattern = self.triples(Mode.PATTERN)
        self.expect("}")
        return template, Group(tuple(pattern), self.span(start), spelt)

    def _refuse_dataset(self) -> None:
        if self.at_word("FROM"):
            hint = "Rules read all graphs; write GRAPH <...> { ... } for one of them."
            raise self.error("FROM is not allowed in rules", self.token.start, code="KG209", hint=hint)

    def _refuse_modifiers(self) -> None:
        start = self.token.start
        keys, having, sliced = self.modifiers()
        if keys or having or sliced:
            hint = "Put it into a sub-SELECT."
            raise self.error("GROUP BY, HAVING, LIMIT and OFFSET are not allowed here", start, code="KG209", hint=hint)


_OTHERS = frozenset({"SELECT", "ASK", "DESCRIBE", "INSERT", "DELETE", "WITH", "LOAD", "CLEAR", "DROP", "CREATE"})
