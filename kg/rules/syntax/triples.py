"""Triples as rules write them: property lists, collections, paths, reified triples and annotations."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.form import Variable
from kg.rules.syntax.lexer import Kind
from kg.rules.syntax.paths import Paths
from kg.rules.syntax.terms import RDF, Mode, triple_of
from kg.rules.syntax.tree import TriplePattern

if TYPE_CHECKING:
    from kg.rules.form import Pattern
    from kg.rules.syntax.tree import Path

__all__ = ["Block", "Triples"]

_FIRST: Final = NamedNode(RDF + "first")
_REST: Final = NamedNode(RDF + "rest")
_NIL: Final = NamedNode(RDF + "nil")
_REIFIES: Final = NamedNode(RDF + "reifies")


@dataclass(slots=True)
class Block:
    """Triples that stand together, as far as they are read."""

    mode: Mode
    triples: list[TriplePattern] = field(default_factory=list)


class Triples(Paths):
    """Reads triples into a `Block`; what brackets stand for comes behind the triple that has them."""

    def triples(self, mode: Mode) -> list[TriplePattern]:
        """Read triples with full stops between them, as many as there are."""
        block = Block(mode)
        while self.at_subject():
            self._same_subject(block)
            if not self.accept("."):
                break
        return block.triples

    def at_subject(self) -> bool:
        """Tell whether triples come next."""
        if self.token.kind in {Kind.VARIABLE, Kind.IRI, Kind.NAME}:
            return True
        return self.at("(", "[", "<<", "<<(") or self.at_literal()

    def _same_subject(self, block: Block) -> None:
        start = self.token.start
        subject, alone = self._subject(block)
        if self._at_verb() or not alone:
            self._property_list(block, subject, start)

    def _subject(self, block: Block) -> tuple[Pattern, bool]:
        """Return a subject and whether it says something without properties."""
        if self.at("<<"):
            return self._reified(block), True
        before = len(block.triples)
        subject = self._node(block, "a subject")
        return subject, len(block.triples) > before

    def _at_verb(self) -> bool:
        if self.token.kind in {Kind.VARIABLE, Kind.IRI, Kind.NAME}:
            return True
        return (self.token.kind is Kind.WORD and self.token.text == "a") or self.at("^", "!", "(")

    def _property_list(self, block: Block, subject: Pattern, start: int) -> None:
        while True:
            predicate = self.path_or_variable() if block.mode is Mode.PATTERN else self.verb(block.mode)
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
        """Read a term, a collection or a blank node with properties."""
        if self.at("<<"):
            return self._reified(block)
        if self.at("<<("):
            return self.triple_term(block.mode)
        if self.at("("):
            return self._collection(block)
        return self._bracketed(block) if self.at("[") else self.simple_term(block.mode, what)

    def _bracketed(self, block: Block) -> Pattern:
        with self.nested():
            self.expect("[")
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
                rest = _NIL if last else self.blank(block.mode)
                block.triples.append(TriplePattern(cell, _REST, rest, self.span(start)))
                if last or isinstance(rest, NamedNode):
                    break
                cell = rest
            self.expect(")")
        return first

    def _reified(self, block: Block) -> Pattern:
        """Read `<< s p o ~ name >>` and return its name."""
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
        if self.at("<<"):
            return self._reified(block)
        return self.triple_term(block.mode) if self.at("<<(") else self.simple_term(block.mode, what)

    def _reifier(self, block: Block) -> Pattern:
        """Read `~ name`, whose name may be missing."""
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
