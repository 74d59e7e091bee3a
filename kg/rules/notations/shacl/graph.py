"""A shapes graph as it is read from Turtle: values, lists, instances, and errors with their place in the file."""

from __future__ import annotations

import re
from collections import defaultdict, deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat, Triple, parse

from kg.errors import Fix, RuleError
from kg.rules.notations.shacl.vocabulary import FIRST, NIL, REST, SH, SUBCLASS, TERMS, sh
from kg.similar import similar, suggest
from kg.syntax.cursor import declaring
from kg.syntax.lexer import END, Kind, Token, normalise, quoted, token_at, unescape, unescape_local
from kg.syntax.names import RDF_TYPE, shorten
from kg.syntax.position import place_at, place_of
from kg.syntax.prologue import declared

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.form import Term

_ESCAPE: Final = re.compile(r"\\(?:u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|.)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class StringToken:
    """A string as it is in the file: where its characters begin, and how they are written."""

    start: int
    written: str

    @classmethod
    def of(cls, token: Token) -> StringToken:
        """Return the string of a token."""
        quotes, written = quoted(token)
        return cls(token.start + quotes, written)

    def offset(self, index: int) -> int:
        """Return the offset in the file of the character at `index` of the string's value."""
        position = passed = 0
        while passed < index and position < len(self.written):
            escape = _ESCAPE.match(self.written, position)
            position = escape.end() if escape else position + 1
            passed += 1
        return self.start + position


@dataclass(slots=True)
class Places:
    """Offsets of the strings and the names of a text, in its order."""

    text: str
    strings: dict[str, list[StringToken]] = field(default_factory=lambda: defaultdict(list))
    names: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    subjects: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Read the text, which is a Turtle file without errors."""
        prefixes: dict[str, str] = {}
        pending: str | None = None
        before = "."
        token = token_at(self.text, 0)
        while token.text != END:
            iri: str | None = None
            behind = token_at(self.text, token.end)
            if token.kind is Kind.STRING:
                written = StringToken.of(token)
                self.strings[unescape(written.written)].append(written)
            elif token.kind is Kind.IRI:
                iri = unescape(token.text[1:-1])
                if pending is not None:
                    prefixes[pending] = iri
                    pending = None
            elif token.kind is Kind.NAME and not token.text.startswith("_:"):
                prefix, _, local = token.text.partition(":")
                iri = prefixes.get(prefix, "") + unescape_local(local)
                # The declaration of a prefix: its name, and the IRI behind it.
                pending = prefix if not local and behind.kind is Kind.IRI and prefix not in prefixes else pending
            if iri is not None:
                self.names[iri].append(token.start)
                if before == ".":
                    self.subjects.setdefault(iri, token.start)
            before, token = token.text, behind

    def of_name(self, iri: str) -> int | None:
        """Return the offset of an IRI: as a subject if it is one, else its first occurrence."""
        offset = self.subjects.get(iri)
        return offset if offset is not None else next(iter(self.names.get(iri, ())), None)


def prefixes(text: str) -> dict[str, str]:
    """Return the prefixes of a file of Turtle that parses, as they are at its end."""
    parsed = parse(text.encode(), RdfFormat.TURTLE)
    deque(parsed, maxlen=0)
    return dict(parsed.prefixes)


class ShapesGraph:
    """The triples of one file; `path` is the path in errors."""

    def __init__(self, text: str, path: str) -> None:
        """Raise `RuleError` KG201 when the text is not Turtle or has a name that SHACL does not know."""
        self.text = normalise(text)
        self.path = path
        self._by_subject: dict[Term, dict[NamedNode, list[Term]]] = defaultdict(lambda: defaultdict(list))
        self._by_object: dict[Term, list[tuple[Term, NamedNode]]] = defaultdict(list)
        self._triples = self._parsed()
        for triple in self._triples:
            self._by_subject[triple.subject][triple.predicate].append(triple.object)
            self._by_object[triple.object].append((triple.subject, triple.predicate))
        self.places = Places(self.text)
        self._check_names()

    def _parsed(self) -> list[Triple]:
        try:
            return [quad.triple for quad in parse(self.text.encode(), RdfFormat.TURTLE)]
        except SyntaxError as error:
            what = str(error.msg or error).partition(": ")[2] or str(error)
            place = place_of(self.text, error.lineno or 1, error.offset or 1, self.path)
            token = token_at(place.excerpt or "", (place.column or 1) - 1)
            prefix = token.text.partition(":")[0]
            missing = token.kind is Kind.NAME and prefix not in declared(self.text)
            fixes = declaring(self.text, [prefix] if missing else [], self.path, turtle=True)
            raise RuleError("KG201", f"the file is not Turtle: {what}", place=place, fixes=fixes) from None

    def _check_names(self) -> None:
        for triple in self._triples:
            name = triple.predicate.value.removeprefix(SH)
            if triple.predicate.value.startswith(SH) and name not in TERMS:
                offset = self.places.of_name(triple.predicate.value)
                near = similar(f"sh:{name}", (f"sh:{known}" for known in TERMS))
                fixes = [Fix(shorten(SH + each[3:], prefixes(self.text))) for each in near]
                what = f"SHACL has no property `sh:{name}`"
                raise self.error(what, triple.subject, hint=suggest(near), offset=offset, fixes=fixes)

    def predicates(self, node: Term) -> list[NamedNode]:
        """Return the predicates of which a node has values."""
        return list(self._by_subject[node]) if node in self._by_subject else []

    def values(self, node: Term, predicate: NamedNode) -> list[Term]:
        """Return the values that a node has for a predicate, in the order of the file."""
        return list(self._by_subject[node].get(predicate, ())) if node in self._by_subject else []

    def subjects(self, predicate: NamedNode, value: Term | None = None) -> list[Term]:
        """Return the nodes that have a value (this value) for a predicate."""
        if value is not None:
            return [subject for subject, key in self._by_object.get(value, ()) if key == predicate]
        return [subject for subject, pairs in self._by_subject.items() if predicate in pairs]

    def one(self, node: Term, name: str) -> Term | None:
        """Return the only value of a property of SHACL; KG201 when there are several."""
        values = self.values(node, sh(name))
        if len(values) > 1:
            raise self.error(
                f"{self.called(node)} has {len(values)} values of sh:{name}", node, hint="Leave one of them."
            )
        return values[0] if values else None

    def required(self, node: Term, name: str) -> Term:
        """Return the only value of a property of SHACL; KG201 when there is none."""
        value = self.one(node, name)
        if value is None:
            raise self.error(f"{self.called(node)} has no sh:{name}", node, hint=f"Give it exactly one sh:{name}.")
        return value

    def flag(self, node: Term, name: str) -> bool:
        """Return whether a property of SHACL is `true`; KG201 when it is not a boolean."""
        value = self.one(node, name)
        if value is None:
            return False
        if not isinstance(value, Literal) or value.value not in {"true", "false", "1", "0"}:
            raise self.error(f"sh:{name} is {value}", node, hint="It is either true or false.")
        return value.value in {"true", "1"}

    def order(self, node: Term) -> float:
        """Return `sh:order`, 0 without one; KG201 when it is not a number."""
        value = self.one(node, "order")
        try:
            return float(value.value) if isinstance(value, Literal) else 0.0 if value is None else float(str(value))
        except ValueError:
            raise self.error(f"sh:order is {value}", node, hint="It is a number, such as 1 or 2.5.") from None

    def members(self, node: Term, owner: Term) -> list[Term]:
        """Return the members of a list; KG201 when it is not well-formed."""
        result: list[Term] = []
        seen: set[Term] = set()
        while node != NIL:
            first, rest = self.values(node, FIRST), self.values(node, REST)
            if len(first) != 1 or len(rest) != 1 or node in seen:
                message = f"{self.called(owner)} has a value that must be a list and is none"
                raise self.error(message, owner, hint="Write the members in brackets: ( ex:one ex:two ).")
            seen.add(node)
            result.append(first[0])
            node = rest[0]
        return result

    def is_list(self, node: Term) -> bool:
        """Return whether a node is a list."""
        return node == NIL or bool(self.values(node, REST))

    def is_instance(self, node: Term, kind: NamedNode) -> bool:
        """Return whether a node is a SHACL instance of a class, by rdf:type and rdfs:subClassOf in this file."""
        open_classes = self.values(node, RDF_TYPE)
        seen: set[Term] = set()
        while open_classes:
            current = open_classes.pop()
            if current == kind:
                return True
            if current not in seen:
                seen.add(current)
                open_classes += self.values(current, SUBCLASS)
        return False

    def offset(self, node: Term) -> int:
        """Return where a node stands: its name, or that of the nearest node around it that has a place."""
        seen: set[Term] = set()
        while node not in seen:
            seen.add(node)
            own = self._own_offset(node)
            if own is not None:
                return own
            node = next((subject for subject, _ in self._by_object.get(node, ())), node)
        return 0

    def _own_offset(self, node: Term) -> int | None:
        if isinstance(node, NamedNode):
            return self.places.of_name(node.value)
        for kind in self.values(node, RDF_TYPE):
            if isinstance(kind, NamedNode):
                instances, offsets = self.subjects(RDF_TYPE, kind), self.places.names.get(kind.value, [])
                if len(instances) == len(offsets):
                    return offsets[instances.index(node)]
        for text in (value for name in ("construct", "select", "ask") for value in self.values(node, sh(name))):
            if isinstance(text, Literal) and (place := self.string(text, node)):
                return place.start
        return next((offset for name in self.predicates(node) if (offset := self._of_property(node, name))), None)

    def _of_property(self, node: Term, predicate: NamedNode) -> int | None:
        """Return where a node has a property, when all of its values are names or literals.

        The parser gives such triples in the order of the text, so counting distinguishes them.
        """
        owners: list[Term] = [triple.subject for triple in self._triples if triple.predicate == predicate]
        offsets = self.places.names.get(predicate.value, [])
        values = [value for owner in dict.fromkeys(owners) for value in self.values(owner, predicate)]
        if len(owners) != len(offsets) or any(isinstance(value, BlankNode) for value in values):
            return None
        return offsets[owners.index(node)]

    def string(self, text: Literal, node: Term) -> StringToken | None:
        """Return the token of a string that is a value of `node`; equal strings are distinguished by their order."""
        tokens = self.places.strings.get(text.value, [])
        owners = [subject for subject, _ in self._by_object.get(text, ())]
        number = owners.index(node) if node in owners and len(owners) == len(tokens) else 0
        return tokens[number] if tokens else None

    def called(self, node: Term) -> str:
        """Return how messages name a node."""
        if isinstance(node, BlankNode):
            kinds = [kind.value.removeprefix(SH) for kind in self.values(node, RDF_TYPE) if isinstance(kind, NamedNode)]
            return f"the blank node of type {kinds[0]}" if kinds else "the blank node"
        return str(node)

    def error(  # noqa: PLR0913 - the parts of an error
        self,
        message: str,
        node: Term,
        *,
        hint: str | None,
        code: str = "KG201",
        offset: int | None = None,
        fixes: Iterable[Fix] = (),
    ) -> RuleError:
        """Return an error about a node, or about the character at `offset`."""
        where = self.offset(node) if offset is None else offset
        return RuleError(code, message, place=place_at(self.text, where, self.path), hint=hint, fixes=fixes)

    def unsupported(self, what: str, node: Term, hint: str) -> RuleError:
        """Return the error that a feature is not supported (KG230)."""
        return self.error(f"{what} is not supported", node, code="KG230", hint=hint)
