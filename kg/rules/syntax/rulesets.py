"""Rule sets of SPARQL 1.2 RL, production RuleSet of its grammar: RULE, DATA, IMPORTS, and bodies in sequence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.syntax.functions import RULE_FUNCTIONS
from kg.rules.syntax.lexer import as_assignment
from kg.rules.syntax.selects import Selects
from kg.rules.syntax.terms import Mode
from kg.rules.syntax.tree import Bind, Exists, Filter, Group, RuleText, RuleUnit

if TYPE_CHECKING:
    from collections.abc import Callable

    from pyoxigraph import NamedNode

    from kg.rules.syntax.tree import Node, TriplePattern

__all__ = ["RuleSets"]

_ELEMENTS: Final = ("FILTER", "NOT", "SET")
_STATEMENTS: Final = ("RULE", "DATA", "PREFIX", "BASE", "VERSION", "IMPORTS")
_SPARQL: Final = {
    "OPTIONAL": "Write one rule with the pattern and one without it.",
    "UNION": "Write one rule for each side.",
    "MINUS": "SPARQL RL has NOT { ... }.",
    "BIND": "SPARQL RL has SET(?variable := expression).",
    "EXISTS": "Write the pattern itself, or NOT { ... }.",
}


class RuleSets(Selects):
    """Reads rule sets."""

    functions = RULE_FUNCTIONS
    patterns_in_expressions = False
    sequences_only = True

    def unit(self) -> RuleUnit:
        """Read the whole text."""
        rules: list[RuleText] = []
        data: list[TriplePattern] = []
        imports: list[NamedNode] = []
        readers: dict[str, Callable[[], None]] = {
            "PREFIX": self.prefix,
            "BASE": self.base_iri,
            "VERSION": self.version,
            "IMPORTS": lambda: imports.append(self.iri()),
            "DATA": lambda: data.extend(self._data()),
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
            return self.error("SPARQL RL has no CONSTRUCT", self.token.start, hint=hint)
        return self.expected("`RULE` or `DATA`", _STATEMENTS)

    def _data(self) -> list[TriplePattern]:
        self.expect("{")
        triples = self.triples(Mode.DATA)
        self.expect("}", " or `.`" if triples else " or triples")
        return triples

    def _rule(self) -> RuleText:
        start = self.expect_word("RULE").start
        identifier = self.iri() if self.at_iri() else None
        self.expect("{", "" if identifier else " or the IRI of the rule")
        template = self.triples(Mode.TEMPLATE)
        self.expect("}", " or `.`" if template else " or triples")
        self.expect_word("WHERE")
        asserted = self.accept_word("DATA")
        self.begin_labels()
        body = self._body(_ELEMENTS)
        return RuleText(tuple(template), body, asserted, self.span(start), identifier)

    def group(self) -> Group:
        """Read what stands inside NOT: triples and filters."""
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
            return self.error(f"SPARQL RL has no {word}", self.token.start, hint=_SPARQL[word])
        if self.at_word(*_ELEMENTS):
            hint = "Inside NOT stand triples and filters only."
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
