"""Terms as rules write them: variables, IRIs, literals, blank nodes, triple terms (SPARQL 1.2, section 19.8)."""

from __future__ import annotations

from enum import Enum, auto
from typing import TYPE_CHECKING, Final

from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Triple

from kg.rules.form import TripleTerm, Variable
from kg.rules.syntax.cursor import Cursor
from kg.rules.syntax.lexer import Kind, Token, unescape

if TYPE_CHECKING:
    from kg.rules.form import Pattern

__all__ = ["RDF", "Mode", "Terms", "variable_of"]

RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
TYPE: Final = NamedNode(RDF + "type")
_XSD: Final = "http://www.w3.org/2001/XMLSchema#"
_DIRECTIONS: Final = {"ltr": BaseDirection.LTR, "rtl": BaseDirection.RTL}
_LONG_QUOTES: Final = ("'''", '"""')


_OPEN: Final = (Variable, BlankNode, TripleTerm)
"""What makes a triple term one that is filled in for each solution."""


class Mode(Enum):
    """Where triples stand, which decides what may stand in them."""

    DATA = auto()
    """No variables; a label is a blank node."""
    TEMPLATE = auto()
    """A label is a new blank node in each solution."""
    PATTERN = auto()
    """A label is a variable that has no name outside; predicates may be paths."""


def variable_of(token: Token) -> Variable:
    """Return the variable that a token stands for."""
    return Variable(token.text[1:])


class Terms(Cursor):
    """Reads terms."""

    block = 0
    """The basic graph pattern that is being read: a label means nothing outside its own."""

    def begin_labels(self) -> None:
        """Begin with labels that stand for other blank nodes than those before."""
        self.labels: dict[str, int] = {}
        self.new_block()

    def new_block(self) -> None:
        """End a basic graph pattern."""
        self.block = len(self.consumed)

    def variable(self) -> Variable:
        """Read a variable."""
        if self.token.kind is not Kind.VARIABLE:
            raise self.expected("a variable")
        return variable_of(self.advance())

    def new_variable(self, known: set[str], what: str) -> Variable:
        """Read a variable to assign to; KG201 where it is bound already."""
        if self.token.kind is Kind.VARIABLE and self.token.text[1:] in known:
            raise self.error(f"{what} assigns to `{self.token.text}`, which is bound before it", self.token.start)
        return self.variable()

    def blank(self, mode: Mode, label: str | None = None) -> Variable | BlankNode:
        """Return what a blank node stands for, a new one without a label."""
        label = label or self.fresh()
        return Variable(f".{label}") if mode is Mode.PATTERN else BlankNode(label)

    def labelled(self, mode: Mode) -> Variable | BlankNode:
        """Read the label of a blank node; KG201 where another basic graph pattern of the rule has it."""
        token = self.advance()
        label = token.text[2:]
        if mode is Mode.PATTERN and self.labels.setdefault(label, self.block) != self.block:
            hint = "A blank node is known only among triples that stand together; use a variable."
            raise self.error(f"`{token.text}` stands in two patterns", token.start, hint=hint)
        return self.blank(mode, label)

    def prefix(self) -> None:
        """Read the rest of `PREFIX name: <...>`."""
        token = self.token
        if token.kind is not Kind.NAME or not token.text.endswith(":") or token.text.count(":") != 1:
            raise self.expected("a prefix with its colon")
        self.advance()
        if self.token.kind is not Kind.IRI:
            raise self.expected("an IRI in brackets")
        self.prefixes[token.text[:-1]] = self.iri().value

    def base_iri(self) -> None:
        """Read the rest of `BASE <...>`."""
        if self.token.kind is not Kind.IRI:
            raise self.expected("an IRI in brackets")
        self.base = self.iri().value

    def version(self) -> None:
        """Read the rest of `VERSION "1.2"`."""
        if self.token.text.startswith(_LONG_QUOTES):
            raise self.expected("a version in quotes")
        self.string()

    def at_label(self) -> bool:
        """Tell whether the label of a blank node comes next."""
        return self.token.kind is Kind.NAME and self.token.text.startswith("_:")

    def at_literal(self) -> bool:
        """Tell whether a literal comes next, signed numbers among them."""
        if self.token.kind in {Kind.STRING, Kind.NUMBER} or self.at_word("TRUE", "FALSE"):
            return True
        return self.at_signed()

    def at_signed(self) -> bool:
        """Tell whether a number with its sign comes next."""
        follows = self.text[self.token.end : self.token.end + 2]
        return self.at("+", "-") and (follows[:1].isdecimal() or (follows[:1] == "." and follows[1:].isdecimal()))

    def literal(self) -> Literal:
        """Read a literal."""
        if self.token.kind is Kind.STRING:
            return self._string_literal()
        if self.at_word("TRUE", "FALSE"):
            return Literal(self.advance().text.lower(), datatype=NamedNode(_XSD + "boolean"))
        sign = self.advance().text if self.at("+", "-") else ""
        number = self.advance().text
        kind = "double" if "e" in number.lower() else "decimal" if "." in number else "integer"
        return Literal(sign + number, datatype=NamedNode(_XSD + kind))

    def string(self) -> str:
        """Read a string without a tag and return its characters."""
        if self.token.kind is not Kind.STRING:
            raise self.expected("a string")
        token = self.advance()
        quotes = 3 if token.text.startswith(_LONG_QUOTES) else 1
        try:
            return unescape(token.text[quotes:-quotes])
        except ValueError:
            raise self.error("an escape in the string is no character", token.start) from None

    def _string_literal(self) -> Literal:
        value = self.string()
        if self.accept("^^"):
            return Literal(value, datatype=self.iri("the IRI of a datatype"))
        if self.token.kind is not Kind.TAG:
            return Literal(value)
        token = self.advance()
        language, _, direction = token.text[1:].partition("--")
        if direction and direction not in _DIRECTIONS:
            hint = "The directions are `ltr` and `rtl`, in lower case."
            raise self.error(f"`{direction}` is not a direction of text", token.start, hint=hint)
        try:
            return Literal(value, language=language, direction=_DIRECTIONS.get(direction))
        except ValueError as error:
            raise self.error(f"`{language}` is not a language: {error}", token.start) from None

    def simple_term(self, mode: Mode, what: str) -> Pattern:
        """Read a variable, IRI, literal or blank node without properties; `what` names the position."""
        if self.token.kind is Kind.VARIABLE:
            if mode is Mode.DATA:
                raise self.error(
                    f"variable `{self.token.text}` in DATA", self.token.start, hint="Data has no variables."
                )
            return self.variable()
        if self.at_label():
            return self.labelled(mode)
        if self.at_literal():
            return self.literal()
        if self.at("["):
            return self.anonymous(mode)
        return self.iri(what)

    def anonymous(self, mode: Mode) -> Variable | BlankNode:
        """Read `[]`."""
        self.expect("[")
        self.expect("]")
        return self.blank(mode)

    def verb(self, mode: Mode) -> NamedNode | Variable:
        """Read a predicate that is no path."""
        if self.token.kind is Kind.WORD and self.token.text == "a":
            self.advance()
            return TYPE
        if self.token.kind is Kind.VARIABLE and mode is not Mode.DATA:
            return self.variable()
        return self.iri("a predicate")

    def triple_term(self, mode: Mode) -> Pattern:
        """Read `<<( subject predicate object )>>`."""
        with self.nested():
            self.expect("<<(")
            parts = self._inner(mode), self.verb(mode), self._inner(mode)
            self.expect(")>>")
        return triple_of(*parts)

    def _inner(self, mode: Mode) -> Pattern:
        return self.triple_term(mode) if self.at("<<(") else self.simple_term(mode, "a term")


def triple_of(subject: Pattern, predicate: NamedNode | Variable, obj: Pattern) -> Pattern:
    """Return a triple term: the engine's own where it can hold it, which it cannot with a literal as subject."""
    if isinstance(subject, NamedNode) and isinstance(predicate, NamedNode) and not isinstance(obj, _OPEN):
        return Triple(subject, predicate, obj)
    return TripleTerm(subject, predicate, obj)
