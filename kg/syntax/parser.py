"""Parsers of rule files, `.rq` (one SPARQL CONSTRUCT) and `.srl` (SPARQL 1.2 RL), and of the patterns of queries."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import Fix
from kg.syntax.functions import AGGREGATES, RULE_FUNCTIONS
from kg.syntax.lexer import END, Kind, as_assignment
from kg.syntax.names import PREFIXES
from kg.syntax.patterns import Patterns
from kg.syntax.tree import Bind, Exists, Filter, Group, Node, RuleText, RuleUnit, TriplePattern, visible
from kg.syntax.triples import Mode

if TYPE_CHECKING:
    from collections.abc import Callable

    from pyoxigraph import NamedNode


_OTHERS: Final = frozenset({"SELECT", "ASK", "DESCRIBE", "INSERT", "DELETE", "WITH", "LOAD", "CLEAR", "DROP", "CREATE"})
_ELEMENTS: Final = ("FILTER", "NOT", "SET")
_STATEMENTS: Final = ("RULE", "DATA", "PREFIX", "BASE", "VERSION", "IMPORTS")
_SPARQL: Final = {
    "OPTIONAL": "Write one rule with the pattern and one without it.",
    "UNION": "Write one rule for each side.",
    "MINUS": "SPARQL RL has NOT { ... }.",
    "BIND": "SPARQL RL has SET(?variable := expression).",
    "EXISTS": "Write the pattern itself, or NOT { ... }.",
}


def parse_rq(text: str, path: str) -> RuleUnit:
    """Return the rule in a SPARQL CONSTRUCT; `path` is its name in errors.

    The prefixes of `kg.syntax.names` are predefined. Raises RuleError: KG201 for invalid SPARQL, KG209 for features not
    allowed in rules (other servers or data sets, ordered or limited rows).
    """
    return _parsed(_Construct(text, path, prefixes=PREFIXES))


def parse_srl(text: str, path: str) -> RuleUnit:
    """Return the rules, data and imports of a rule set of SPARQL 1.2 RL; `path` is its name in errors.

    No prefixes are predefined; relative IRIs are relative to the file. Raises RuleError KG201.
    """
    return _parsed(_RuleSets(text, path, prefixes={}, base=Path(path).absolute().as_uri()))


def _parsed(parser: _Construct | _RuleSets) -> RuleUnit:
    try:
        return parser.unit()
    except RecursionError:
        raise parser.error("the rule nests too deep", parser.token.start) from None


@dataclass(frozen=True, slots=True)
class QueryUnit:
    """A query: its WHERE clause, and the number of EXISTS in it. DESCRIBE and the rest after WHERE are left out."""

    group: Group
    exists: int


def parse_query(text: str, path: str, base: str | None = None) -> QueryUnit:
    """Return the pattern of a SELECT, ASK or CONSTRUCT; the prefixes of `kg.syntax.names` are predefined.

    Raises RuleError: KG201 for invalid SPARQL and for other queries, KG209 for features missing from the grammar of
    rules, and for too much nesting.
    """
    parser = _Query(text, path, prefixes=PREFIXES, base=base)
    try:
        return parser.query()
    except RecursionError:
        raise parser.error("the query nests too deep", parser.token.start, code="KG209") from None


class _Construct(Patterns):
    """Parser of CONSTRUCT queries."""

    def unit(self) -> RuleUnit:
        """Parse the whole text."""
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
            raise self.error("this file contains no rule", start, hint=hint)
        if self.token.kind is Kind.WORD and self.token.text.upper() in _OTHERS:
            raise self.error(f"a rule is a CONSTRUCT query, not {self.token.text.upper()}", start, hint=hint)
        if not self.at_word("CONSTRUCT"):
            raise self.expected("`CONSTRUCT`", ("CONSTRUCT", "PREFIX", "BASE"))
        self.advance()
        short = not self.at("{")
        template = [] if short else self.triples_in_braces(Mode.TEMPLATE)
        if self.at_word("FROM"):
            hint = "Rules read all graphs; write GRAPH <...> { ... } for one of them."
            raise self.error("FROM is not allowed in rules", self.token.start, code="KG209", hint=hint)
        if short:
            self.expect_word("WHERE")
            template, group = self._both()
        else:
            if not self.accept_word("WHERE") and self.token.kind is Kind.WORD:
                raise self.expected("`WHERE`", ["WHERE"])
            group = self.group()
        self._refuse_modifiers()
        if self.at_word("VALUES"):
            group = self._with_values(group, (), grouped=False)
        return RuleText(tuple(template), group, asserted=False, span=self.span(start), calls=tuple(self.calls))

    def _both(self) -> tuple[list[TriplePattern], Group]:
        """Parse triples that are both template and pattern."""
        start, first, token = self.token.start, len(self.consumed), self.token
        template = self.triples_in_braces(Mode.TEMPLATE)
        spelt = self.spelling(self.consumed[first:])
        del self.consumed[first:]
        self.token = token
        self.expect("{")
        pattern = self.triples(Mode.PATTERN)
        self.expect("}")
        return template, Group(tuple(pattern), self.span(start), spelt)

    def _refuse_modifiers(self) -> None:
        start = self.token.start
        keys, having, sliced = self.modifiers()
        if keys or having or sliced:
            hint = "Put it into a sub-SELECT."
            raise self.error("GROUP BY, HAVING, LIMIT and OFFSET are not allowed here", start, code="KG209", hint=hint)


class _Query(_Construct):
    """Parser of other query forms."""

    def query(self) -> QueryUnit:
        """Parse the whole text."""
        self.begin_labels()
        self._prologue()
        group = self._select() if self.at_word("SELECT") else self._pattern()
        if self.accept_word("VALUES"):
            self.table()
        if not self.at(END):
            raise self.expected("the end of the query")
        words = [token.text.upper() for token in self.consumed if token.kind is Kind.WORD]
        return QueryUnit(group, words.count("EXISTS"))

    def _select(self) -> Group:
        start = self.advance().start
        self.accept_word("DISTINCT", "REDUCED")
        columns = self._columns()
        self._dataset()
        self.accept_word("WHERE")
        group = self.group()
        first = len(self.consumed)
        keys, _, _ = self.modifiers()
        aggregated = any(column.expression and column.expression.aggregates for column, _ in columns)
        words = {token.text.upper() for token in self.consumed[first:] if token.kind is Kind.WORD}
        grouped = bool(keys or aggregated or words & AGGREGATES)
        self._check_columns(columns, keys, visible(group.nodes), grouped=grouped, start=start)
        return group

    def _pattern(self) -> Group:
        if self.accept_word("CONSTRUCT"):
            short = not self.at("{")
            if not short:
                self.triples_in_braces(Mode.TEMPLATE)
            self._dataset()
            if short:
                self.expect_word("WHERE")
                group = self._both()[1]
                self.modifiers()
                return group
        else:
            self.expect_word("ASK")
            self._dataset()
        self.accept_word("WHERE")
        group = self.group()
        self.modifiers()
        return group

    def _dataset(self) -> None:
        while self.accept_word("FROM"):
            self.accept_word("NAMED")
            self.iri("the IRI of a graph")


class _RuleSets(Patterns):
    """Parser of rule sets."""

    functions = RULE_FUNCTIONS
    patterns_in_expressions = False
    sequences_only = True

    def unit(self) -> RuleUnit:
        """Parse the whole text."""
        rules: list[RuleText] = []
        data: list[TriplePattern] = []
        imports: list[NamedNode] = []
        readers: dict[str, Callable[[], None]] = {
            "PREFIX": self.prefix,
            "BASE": self.base_iri,
            "VERSION": self.version,
            "IMPORTS": lambda: imports.append(self.iri()),
            "DATA": lambda: data.extend(self.triples_in_braces(Mode.DATA)),
        }
        while not self.at_end():
            if self.at_word("RULE"):
                rules.append(self._rule())
            elif self.at_word(*readers):
                readers[self.advance().text.upper()]()
            else:
                raise self._no_statement()
        return RuleUnit(tuple(rules), tuple(data), tuple(imports), self.prefixes)

    def _no_statement(self) -> Exception:
        if self.at_word("CONSTRUCT"):
            hint = "Write RULE { ... } WHERE { ... }, or give the file the ending .rq."
            fixes = [Fix("RULE", title="Replace `CONSTRUCT` by `RULE`")]
            return self.error("SPARQL RL has no CONSTRUCT", self.token.start, hint=hint, fixes=fixes)
        return self.expected("`RULE` or `DATA`", _STATEMENTS)

    def _rule(self) -> RuleText:
        start = self.expect_word("RULE").start
        identifier = self.iri() if self.at_iri() else None
        template = self.triples_in_braces(Mode.TEMPLATE, "" if identifier else " or the IRI of the rule")
        self.expect_word("WHERE")
        asserted = self.accept_word("DATA")
        self.begin_labels()
        self.calls = []
        body = self._body(_ELEMENTS)
        return RuleText(tuple(template), body, asserted, self.span(start), identifier, tuple(self.calls))

    def group(self) -> Group:
        """Parse the content of NOT: triples and filters."""
        return self._body(_ELEMENTS[:1])

    def _body(self, elements: tuple[str, ...]) -> Group:
        first = len(self.consumed)
        start = self.expect("{").start
        nodes: list[Node] = []
        while True:
            nodes += self.triples(Mode.PATTERN)
            if self.accept("}"):
                return Group(tuple(nodes), self.span(start), self.spelling(self.consumed[first:]))
            if self.at_subject():
                raise self.expected("`.` or `}`")
            nodes.append(self._element(elements))
            self.accept(".")

    def _element(self, elements: tuple[str, ...]) -> Node:
        start = self.token.start
        if not self.at_word(*elements):
            raise self._no_element(elements)
        if self.accept_word("FILTER"):
            return Filter(self.constraint(), self.span(start))
        if self.accept_word("NOT"):
            asserted = self.accept_word("DATA")
            if not self.at("{"):
                raise self.expected("`{`" if asserted else "`{` or `DATA`")
            return Exists(self.group(), negated=True, asserted=asserted, span=self.span(start))
        return self._assignment()

    def _no_element(self, elements: tuple[str, ...]) -> Exception:
        word = self.token.text.upper()
        if self.at_word(*_SPARQL):
            fixes = [Fix("NOT", title="Replace `MINUS` by `NOT`")] if word == "MINUS" else []
            return self.error(f"SPARQL RL has no {word}", self.token.start, hint=_SPARQL[word], fixes=fixes)
        if self.at_word(*_ELEMENTS):
            hint = "NOT contains only triples and filters."
            return self.error(f"{word} inside NOT", self.token.start, hint=hint)
        what = ", ".join(f"`{element}`" for element in elements)
        return self.expected(f"triples, {what} or `}}`", elements)

    def _assignment(self) -> Node:
        start = self.expect_word("SET").start
        self.expect("(")
        variable = self.variable()
        self.token = as_assignment(self.token, self.text)
        self.expect(":=")
        expression = self.expression()
        self.expect(")", " or an operator")
        return Bind(variable, expression, self.span(start))
