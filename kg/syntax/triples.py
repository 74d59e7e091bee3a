"""Parser of terms, property paths and triples (SPARQL 1.2, section 19.8; SPARQL RL has fewer paths)."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final

from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Triple

from kg.syntax.cursor import Cursor
from kg.syntax.lexer import Kind, quoted, unescape
from kg.syntax.names import RDF_TYPE
from kg.syntax.terms import Pattern, TripleTerm, Variable
from kg.syntax.tree import Alternative, Inverse, Negated, Path, Repeat, Sequence, TriplePattern

RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
_XSD: Final = "http://www.w3.org/2001/XMLSchema#"
_DIRECTIONS: Final = {"ltr": BaseDirection.LTR, "rtl": BaseDirection.RTL}
_LONG_QUOTES: Final = ("'''", '"""')
_OPEN: Final = (Variable, BlankNode, TripleTerm)
"""Parts that make a triple term depend on the solution."""


_FIRST: Final = NamedNode(RDF + "first")
_REST: Final = NamedNode(RDF + "rest")
_NIL: Final = NamedNode(RDF + "nil")
_REIFIES: Final = NamedNode(RDF + "reifies")


class Mode(Enum):
    """The kind of a block of triples, which decides its allowed terms."""

    DATA = auto()
    """No variables; a label is a blank node."""
    TEMPLATE = auto()
    """A label is a new blank node in each solution."""
    PATTERN = auto()
    """A label is a variable that has no name outside; predicates may be paths."""


@dataclass(slots=True)
class Block:
    """A block of triples read so far."""

    mode: Mode
    triples: list[TriplePattern] = field(default_factory=list)


class Triples(Cursor):
    """Parser of terms, paths, and triples into a `Block`; triples in brackets follow the enclosing triple."""

    block = 0
    """The number of the current basic graph pattern, the scope of labels."""

    sequences_only = False
    """Whether the notation lacks alternatives, repetition and negation."""

    def begin_labels(self) -> None:
        """Start a new scope of labels."""
        self.labels: dict[str, int] = {}
        self.new_block()

    def new_block(self) -> None:
        """End a basic graph pattern."""
        self.block = len(self.consumed)

    def variable(self) -> Variable:
        """Parse a variable."""
        if self.token.kind is not Kind.VARIABLE:
            raise self.expected("a variable")
        return Variable(self.advance().text[1:])

    def blank(self, mode: Mode, label: str | None = None) -> Variable | BlankNode:
        """Return the term of a blank node, a new one without a label."""
        label = label or self.fresh()
        return Variable(f".{label}") if mode is Mode.PATTERN else BlankNode(label)

    def labelled(self, mode: Mode) -> Variable | BlankNode:
        """Parse the label of a blank node; KG201 if another basic graph pattern of the rule uses it."""
        token = self.advance()
        label = token.text[2:]
        if mode is Mode.PATTERN and self.labels.setdefault(label, self.block) != self.block:
            hint = "A blank node label is local to its block of triples; use a variable."
            raise self.error(f"`{token.text}` occurs in two patterns", token.start, hint=hint)
        return self.blank(mode, label)

    def prefix(self) -> None:
        """Parse the rest of `PREFIX name: <...>`."""
        token = self.token
        if token.kind is not Kind.NAME or not token.text.endswith(":") or token.text.count(":") != 1:
            raise self.expected("a prefix with its colon")
        self.advance()
        if self.token.kind is not Kind.IRI:
            raise self.expected("an IRI in brackets")
        self.prefixes[token.text[:-1]] = self.iri().value

    def base_iri(self) -> None:
        """Parse the rest of `BASE <...>`."""
        if self.token.kind is not Kind.IRI:
            raise self.expected("an IRI in brackets")
        self.base = self.iri().value

    def version(self) -> None:
        """Parse the rest of `VERSION "1.2"`."""
        if self.token.text.startswith(_LONG_QUOTES):
            raise self.expected("a version in quotes")
        self.string()

    def at_label(self) -> bool:
        """Return whether the label of a blank node comes next."""
        return self.token.kind is Kind.NAME and self.token.text.startswith("_:")

    def at_literal(self) -> bool:
        """Return whether a literal comes next, including signed numbers."""
        if self.token.kind in {Kind.STRING, Kind.NUMBER} or self.at_word("TRUE", "FALSE"):
            return True
        return self.at_signed()

    def at_signed(self) -> bool:
        """Return whether a signed number comes next."""
        follows = self.text[self.token.end : self.token.end + 2]
        return self.at("+", "-") and (follows[:1].isdecimal() or (follows[:1] == "." and follows[1:].isdecimal()))

    def literal(self) -> Literal:
        """Parse a literal."""
        if self.token.kind is Kind.STRING:
            return self._string_literal()
        if self.at_word("TRUE", "FALSE"):
            return Literal(self.advance().text.lower(), datatype=NamedNode(_XSD + "boolean"))
        sign = self.advance().text if self.at("+", "-") else ""
        number = self.advance().text
        kind = "double" if "e" in number.lower() else "decimal" if "." in number else "integer"
        return Literal(sign + number, datatype=NamedNode(_XSD + kind))

    def string(self) -> str:
        """Parse a string without a tag and return its characters."""
        if self.token.kind is not Kind.STRING:
            raise self.expected("a string")
        token = self.advance()
        try:
            return unescape(quoted(token)[1])
        except ValueError:
            raise self.error("invalid escape sequence in the string", token.start) from None

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
        """Parse a variable, IRI, literal or blank node without properties; `what` names the position."""
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
        if self.accept("["):
            self.expect("]")
            return self.blank(mode)
        return self.iri(what)

    def verb(self, mode: Mode) -> NamedNode | Variable:
        """Parse a predicate that is not a path."""
        if self.token.kind is Kind.VARIABLE and mode is not Mode.DATA:
            return self.variable()
        return self._step("a predicate")

    def triple_term(self, mode: Mode) -> Pattern:
        """Parse `<<( subject predicate object )>>`."""
        with self.nested():
            self.expect("<<(")
            parts = self.any_term(mode, "a term"), self.verb(mode), self.any_term(mode, "a term")
            self.expect(")>>")
        return triple_of(*parts)

    def any_term(self, mode: Mode, what: str) -> Pattern:
        """Parse a triple term or what `simple_term` parses."""
        return self.triple_term(mode) if self.at("<<(") else self.simple_term(mode, what)

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
            return RDF_TYPE
        return self.iri(what)

    def _negated(self) -> Path:
        forward: list[NamedNode] = []
        backward: list[NamedNode] = []
        several = self.accept("(")
        while True:
            (backward if self.accept("^") else forward).append(self._step("a predicate after `!`"))
            if not several:
                break
            if not self.accept("|"):
                self.expect(")", " or `|`")
                break
        return Negated(tuple(forward), tuple(backward))

    def _full(self, what: str) -> bool:
        """Refuse a path that the notation lacks; return true otherwise."""
        if self.sequences_only:
            hint = "Paths of SPARQL RL are sequences `/` and inverses `^`; write several rules."
            raise self.error(f"{what} is not a path of SPARQL RL", self.token.start, hint=hint)
        return True

    def triples_in_braces(self, mode: Mode, what: str = "") -> list[TriplePattern]:
        """Parse any number of triples in braces; `what` is what may be there instead of the first brace."""
        self.expect("{", what)
        triples = self.triples(mode)
        self.expect("}", " or `.`" if triples else " or triples")
        return triples

    def triples(self, mode: Mode) -> list[TriplePattern]:
        """Parse any number of triples separated by full stops."""
        block = Block(mode)
        while self.at_subject():
            start, before = self.token.start, len(block.triples)
            subject = self._node(block, "a subject")
            # A reified triple, a collection and a blank node with properties are complete without more properties.
            if self._at_verb() or len(block.triples) == before:
                self._property_list(block, subject, start)
            if not self.accept("."):
                break
        return block.triples

    def at_subject(self) -> bool:
        """Return whether triples come next."""
        if self.token.kind in {Kind.VARIABLE, Kind.IRI, Kind.NAME}:
            return True
        return self.at("(", "[", "<<", "<<(") or self.at_literal()

    def _at_verb(self) -> bool:
        if self.token.kind in {Kind.VARIABLE, Kind.IRI, Kind.NAME}:
            return True
        return (self.token.kind is Kind.WORD and self.token.text == "a") or self.at("^", "!", "(")

    def _property_list(self, block: Block, subject: Pattern, start: int) -> None:
        while True:
            path = block.mode is Mode.PATTERN and self.token.kind is not Kind.VARIABLE
            predicate = self._path() if path else self.verb(block.mode)
            self._object(block, subject, predicate, start)
            while self.accept(","):
                self._object(block, subject, predicate, self.token.start)
            if not self.at(";"):
                return
            while self.accept(";"):
                pass
            if not self._at_verb():
                return
            start = self.token.start

    def _object(self, block: Block, subject: Pattern, predicate: Path, start: int) -> None:
        index = len(block.triples)
        obj = self._node(block, "an object")
        block.triples.insert(index, TriplePattern(subject, predicate, obj, self.span(start)))
        self._annotations(block, subject, predicate, obj)

    def _node(self, block: Block, what: str) -> Pattern:
        """Parse a term, a collection or a blank node with properties."""
        if self.at("<<"):
            return self._reified(block)
        if self.at("("):
            return self._collection(block)
        if not self.at("["):
            return self.any_term(block.mode, what)
        with self.nested():
            self.advance()
            node = self.blank(block.mode)
            if not self.accept("]"):
                self._property_list(block, node, self.token.start)
                self.expect("]", " or `;`")
        return node

    def _collection(self, block: Block) -> Pattern:
        start = self.expect("(").start
        if self.accept(")"):
            return _NIL
        first = cell = self.blank(block.mode)
        with self.nested():
            while True:
                index = len(block.triples)
                member = self._node(block, "a member of the collection or `)`")
                block.triples.insert(index, TriplePattern(cell, _FIRST, member, self.span(start)))
                last = self.at(")")
                tail = _NIL if last else self.blank(block.mode)
                block.triples.append(TriplePattern(cell, _REST, tail, self.span(start)))
                if last or isinstance(tail, NamedNode):
                    break
                cell = tail
            self.expect(")")
        return first

    def _reified(self, block: Block) -> Pattern:
        """Parse `<< s p o ~ name >>` and return its name."""
        start = self.token.start
        with self.nested():
            self.expect("<<")
            subject = self._reified_part(block, "a subject")
            predicate = self.verb(block.mode)
            obj = self._reified_part(block, "an object")
            index = len(block.triples)
            name = self._reifier(block) if self.at("~") else self.blank(block.mode)
            self.expect(">>")
        term = triple_of(subject, predicate, obj)
        block.triples.insert(index, TriplePattern(name, _REIFIES, term, self.span(start)))
        return name

    def _reified_part(self, block: Block, what: str) -> Pattern:
        return self._reified(block) if self.at("<<") else self.any_term(block.mode, what)

    def _reifier(self, block: Block) -> Pattern:
        """Parse `~ name`, whose name may be missing."""
        self.expect("~")
        if self.token.kind is Kind.VARIABLE or self.at_iri() or self.at_label() or self.at("["):
            return self.simple_term(block.mode, "a name")
        return self.blank(block.mode)

    def _annotations(self, block: Block, subject: Pattern, predicate: Path, obj: Pattern) -> None:
        name: Pattern | None = None
        while self.at("~", "{|"):
            start = self.token.start
            if not isinstance(predicate, NamedNode | Variable):
                raise self.error("a path cannot be annotated", start, hint="Only a triple has a name or annotations.")
            if self.at("~"):
                name = self._reifier(block)
                self._reifies(block, name, triple_of(subject, predicate, obj), start)
                continue
            if name is None:
                name = self.blank(block.mode)
                self._reifies(block, name, triple_of(subject, predicate, obj), start)
            with self.nested():
                self.expect("{|")
                self._property_list(block, name, self.token.start)
                self.expect("|}")
            name = None

    def _reifies(self, block: Block, name: Pattern, term: Pattern, start: int) -> None:
        block.triples.append(TriplePattern(name, _REIFIES, term, self.span(start)))


def triple_of(subject: Pattern, predicate: NamedNode | Variable, obj: Pattern) -> Pattern:
    """Return a triple term: the engine's own if possible, which excludes literals as subjects."""
    if isinstance(subject, NamedNode) and isinstance(predicate, NamedNode) and not isinstance(obj, _OPEN):
        return Triple(subject, predicate, obj)
    return TripleTerm(subject, predicate, obj)
