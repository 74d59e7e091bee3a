"""SPARQL 1.2 RL as the internal form: well-formedness (section 3.2 of the text), paths as triples, data as triples.

The bodies of SPARQL RL are those of the internal form, element by element, in their order.
"""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Final
from urllib.parse import unquote, urlsplit

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from kg.errors import Fix, Place, RuleError
from kg.rules.decompose.calls import prepared
from kg.rules.decompose.expressions import expression
from kg.rules.decompose.parts import Names
from kg.rules.decompose.paths import Link, normal
from kg.rules.decompose.renaming import uses
from kg.rules.form import Assignment, Atom, Element, Exists, Filter, Pattern, Rule, Term, TripleTerm, Variable
from kg.similar import similar, suggest
from kg.syntax import tree
from kg.syntax.lexer import normalise
from kg.syntax.parser import parse_srl
from kg.syntax.position import place_at, place_of_variable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.syntax.tree import Expression, Group, Node, RuleText, RuleUnit, Span, TriplePattern

_DIGITS: Final = 20


def rules(unit: RuleUnit, name: str, path: str, text: str, *, first: int = 1) -> tuple[Rule, ...]:
    """Return the rules of a rule set; `first` is the part that the first one is.

    Raises RuleError: KG203 for what is not well-formed, KG209 for a head whose subject is a literal, KG201 and KG209
    for calls of functions that rules cannot call.
    """
    result: list[Rule] = []
    written = normalise(text)
    for part, stated in enumerate(unit.rules, first):
        _check(stated, path, written)
        rule = prepared(stated, lambda span: place_at(written, span.start, path))
        reader = _Reader(rule, path, written)
        if rule.template:
            result.append(Rule(name, reader.head(), reader.body(), reader.place(rule.span), part))
    return tuple(result)


def data(unit: RuleUnit, path: str, text: str) -> tuple[Triple, ...]:
    """Return the triples of DATA; a blank node has a name that no other file gives one.

    Raises RuleError KG209 for a triple that a store cannot hold: RDF 1.2 has no literal as subject.
    """
    stem = sha256(text.encode()).hexdigest()[:_DIGITS]
    triples: list[Triple] = []
    for pattern in unit.data:
        triple = _stored(TripleTerm(pattern.subject, _predicate(pattern), pattern.object), stem)
        if not isinstance(triple, Triple):
            raise _literal_subject(place_at(normalise(text), pattern.span.start, path))
        triples.append(triple)
    return tuple(triples)


def _predicate(pattern: TriplePattern) -> NamedNode | Variable:
    if not isinstance(pattern.predicate, NamedNode | Variable):
        raise TypeError(pattern.predicate)
    return pattern.predicate


def _stored(pattern: Pattern, stem: str) -> Term | None:
    """Return a term that a store can hold, its blank nodes renamed; None when it cannot."""
    if isinstance(pattern, BlankNode):
        return BlankNode(f"d{stem}-{pattern.value}")
    if not isinstance(pattern, TripleTerm):
        return None if isinstance(pattern, Variable) else pattern
    subject, obj = _stored(pattern.subject, stem), _stored(pattern.object, stem)
    if isinstance(subject, NamedNode | BlankNode) and isinstance(pattern.predicate, NamedNode) and obj is not None:
        return Triple(subject, pattern.predicate, obj)
    return None


def _literal_subject(place: Place) -> RuleError:
    hint = "Subjects in RDF are IRIs or blank nodes; swap subject and object."
    return RuleError("KG209", "the subject of a triple must be an IRI or a blank node", place=place, hint=hint)


class _Reader:
    """Turns one rule into the internal form."""

    def __init__(self, rule: RuleText, path: str, text: str) -> None:
        self._rule = rule
        self._path = path
        self._text = text
        names = uses(rule.group.nodes) | uses(rule.template)
        self._names = Names(names)

    def place(self, span: Span) -> Place:
        """Return where a span begins."""
        return place_at(self._text, span.start, self._path)

    def head(self) -> tuple[Atom, ...]:
        """Return the triples that the rule derives."""
        return tuple(map(self._derived, self._rule.template))

    def body(self) -> tuple[Element, ...]:
        """Return the body of the rule."""
        return tuple(self._elements(self._rule.group, asserted=self._rule.asserted))

    def _derived(self, pattern: TriplePattern) -> Atom:
        place = self.place(pattern.span)
        terms = (pattern.subject, pattern.object)
        inner = [subject for term in terms if isinstance(term, TripleTerm) for subject in _subjects(term)]
        if any(isinstance(subject, Literal | Triple | TripleTerm) for subject in (pattern.subject, *inner)):
            raise _literal_subject(place)
        return Atom(pattern.subject, _predicate(pattern), pattern.object, place=place)

    def _elements(self, group: Group, *, asserted: bool) -> Iterator[Element]:
        for node in group.nodes:
            if isinstance(node, tree.TriplePattern):
                yield from self._atoms(node, asserted=asserted)
            elif isinstance(node, tree.Filter):
                yield Filter(expression(node.expression.text, self.place(node.expression.span)))
            elif isinstance(node, tree.Bind):
                yield Assignment(node.variable, expression(node.expression.text, self.place(node.expression.span)))
            elif isinstance(node, tree.Exists):
                inner = self._elements(node.group, asserted=asserted or node.asserted)
                yield Exists(tuple(inner), negated=node.negated)

    def _atoms(self, pattern: TriplePattern, *, asserted: bool) -> Iterator[Atom]:
        """Yield the triples that a path stands for, joined by new variables."""
        (steps,) = normal(pattern.predicate).alternatives
        links = [step for step in steps if isinstance(step, Link)]
        place = self.place(pattern.span)
        left = pattern.subject
        for number, link in enumerate(links, 1):
            right = pattern.object if number == len(links) else self._names.hidden()
            subject, obj = (right, left) if link.inverse else (left, right)
            yield Atom(subject, link.predicate, obj, asserted=asserted, place=place)
            left = right


def _subjects(term: TripleTerm) -> Iterator[Pattern]:
    yield term.subject
    if isinstance(term.object, TripleTerm):
        yield from _subjects(term.object)


def imported(unit: RuleUnit, path: Path, text: str) -> Iterator[tuple[Path, str, RuleUnit]]:
    """Yield path, text and tree of each rule set that a rule set imports, also through others; cycles end.

    Raises RuleError: KG208 for an import that is not a file here, KG201 for one that does not parse.
    """
    seen = {path.resolve()}
    waiting = [(unit, path, text)]
    while waiting:
        importing, source, written = waiting.pop(0)
        for target in importing.imports:
            file = _imported_file(target, source, written).resolve()
            if file in seen:
                continue
            seen.add(file)
            inner = _imported_text(file, target, source, written)
            item = (file, inner, parse_srl(inner, str(file)))
            yield item
            waiting.append((item[2], file, inner))


def _imported_file(target: NamedNode, source: Path, text: str) -> Path:
    parts = urlsplit(target.value)
    if parts.scheme != "file" or parts.netloc not in {"", "localhost"}:
        hint = "Rule sets are not fetched: save it next to this file and import it by its name."
        raise _import_error(f"`{target.value}` is not a file of this machine", target, source, text, hint)
    return Path(unquote(parts.path))


def _imported_text(file: Path, target: NamedNode, source: Path, text: str) -> str:
    try:
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        hint = "A relative name is relative to the importing file, or to its BASE."
        raise _import_error(f"`{file.name}` cannot be imported: {reason}", target, source, text, hint) from None


def _import_error(message: str, target: NamedNode, source: Path, text: str, hint: str) -> RuleError:
    """Return an error at the importing statement, if the text allows to find it."""
    written = normalise(text)
    name = target.value.rpartition("/")[2]
    keyword = max(written.upper().find("IMPORTS"), 0)
    offset = max(written.find(name, keyword), keyword)
    return RuleError("KG208", message, place=place_at(written, offset, str(source)), hint=hint)


def _check(rule: RuleText, path: str, text: str) -> None:
    """Raise RuleError KG203 at the first variable of a rule that is not bound, or is bound twice.

    A filter and an assignment see the variables of the elements before them; inside NOT also those before the NOT. An
    assignment names a variable that nothing before it has. The head has variables of the body only. `text` is that of
    the file, normalised: its lines end with line feeds.
    """
    checker = _Checker(path, text)
    bound = checker.sequence(rule.group.nodes, set())
    for pattern in rule.template:
        for name in sorted(uses((pattern,)).keys() - bound):
            message = f"the head has `?{name}`, which the body does not bind"
            raise checker.unbound(name, pattern.span, message, bound)


class _Checker:
    """Has the text, for the places of variables in errors."""

    def __init__(self, path: str, text: str) -> None:
        self._path = path
        self._text = text

    def sequence(self, nodes: Iterable[Node], bound: set[str]) -> set[str]:
        """Check elements in their order and return the variables bound behind them."""
        bound = set(bound)
        for node in nodes:
            if isinstance(node, tree.TriplePattern):
                bound |= uses((node,)).keys()
            elif isinstance(node, tree.Filter):
                self._check(node.expression, bound, "FILTER")
            elif isinstance(node, tree.Exists):
                self.sequence(node.group.nodes, bound)
            elif isinstance(node, tree.Bind):
                self._check(node.expression, bound, "SET")
                name = node.variable.name
                if name in bound:
                    hint = "Give the result another name; compare the two with FILTER."
                    raise self._error(name, node.span, f"SET assigns to `?{name}`, which is bound before it", hint)
                bound.add(name)
        return bound

    def _check(self, expression: Expression, bound: set[str], what: str) -> None:
        for name in expression.variables:
            if name not in bound:
                message = f"{what} reads `?{name}`, which nothing before it binds"
                raise self.unbound(name, expression.span, message, bound)

    def unbound(self, name: str, span: Span, message: str, bound: set[str]) -> RuleError:
        """Return the error that a variable is not bound."""
        near = similar(name, {other for other in bound if not other.startswith(".")})
        hint = suggest(near) or f"Bind `?{name}` by a triple or SET before it is read."
        return self._error(name, span, message, hint, [Fix(f"?{each}") for each in near])

    def _error(self, name: str, span: Span, message: str, hint: str, fixes: Iterable[Fix] = ()) -> RuleError:
        place = place_of_variable(self._text, name, span.start, span.end, self._path)
        return RuleError("KG203", message, place=place, hint=hint, fixes=fixes)
