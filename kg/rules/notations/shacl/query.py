"""SPARQL inside shapes graphs: the strings of sh:construct, sh:select and sh:ask, cut into words.

Each word has its offset in the file, names are IRIs in brackets, and comments are dropped. Texts from nodes with
different prefixes can then be joined, and an error still points at the original text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final, TypeAlias

from pyoxigraph import Literal, NamedNode

from kg.errors import Fix
from kg.rules.notations.shacl.vocabulary import IMPORTS, sh
from kg.similar import similar, suggest
from kg.syntax.lexer import Kind, Token, normalise, tokens, unescape, unescape_local
from kg.syntax.names import PREFIXES, is_absolute

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph


@dataclass(frozen=True, slots=True)
class Word:
    """A token of SPARQL; `offset` is its place in the file, `joined`: no blank is before it."""

    kind: Kind
    text: str
    offset: int | None = None
    joined: bool = False


Words: TypeAlias = list[Word]


@dataclass(frozen=True, slots=True)
class Query:
    """A query taken apart: what is between its first word and its group, the group's inside, and what follows."""

    form: str
    head: Words
    group: Words
    modifiers: Words
    owner: Term


PREBOUND: Final = frozenset({"this", "shapesGraph", "currentShape"})
"""Variables that have values before any query of a shape is evaluated (SHACL, appendix A)."""
EXCLUDED: Final = {
    "MINUS": "Write FILTER NOT EXISTS { ... }.",
    "VALUES": "Compare with FILTER(?x IN (...)), or bind the values by { BIND(... AS ?x) } UNION { ... }.",
}
"""What a query with pre-bound variables must not have, with what to write instead; SERVICE is in no rule."""
_FORMS: Final = {"construct": "CONSTRUCT", "select": "SELECT", "ask": "ASK"}
_PAIRS: Final = {"{": "}", "(": ")", "[": "]"}


def query_of(graph: ShapesGraph, owner: Term, name: str) -> Query:
    """Return the query that `owner` has as its one value of sh:construct, sh:select or sh:ask.

    Raises `RuleError` KG201 when it is missing, no string, uses a prefix that is not declared (SHACL, section 5.2.1),
    or is not a query of that form.
    """
    literal = graph.required(owner, name)
    if not isinstance(literal, Literal):
        raise graph.error(f"sh:{name} of {graph.called(owner)} is not a string", owner, hint="Put the query in quotes.")
    return _Reader(graph, owner, literal).query(_FORMS[name])


def check_prebound(graph: ShapesGraph, query: Query, names: Collection[str]) -> None:
    """Raise RuleError KG201 for what a query with the pre-bound variables `names` must not have (SHACL, appendix A).

    The standard excludes it because nothing defines which value such a variable has there.
    """
    words = [*query.head, *query.group, *query.modifiers]
    for before, word in pairwise([plain(""), *words]):
        name = word.text.upper() if word.kind is Kind.WORD else ""
        if name == "SERVICE":
            message, hint = "SERVICE is not allowed in rules", "Rules read the store alone; load the other data first."
            raise graph.error(message, query.owner, code="KG209", hint=hint, offset=word.offset)
        if name in EXCLUDED:
            bound = "this" if "this" in names else min(names)
            message = f"SHACL allows no {name} in a query with pre-bound variables, here ${bound}"
            raise graph.error(message, query.owner, hint=EXCLUDED[name], offset=word.offset)
        if word.kind is Kind.VARIABLE and word.text[1:] in names and before.text.upper() == "AS":
            hint = "Assign to another variable."
            raise graph.error(f"${word.text[1:]} has a value already", query.owner, hint=hint, offset=word.offset)


def spell(words: Words) -> str:
    """Return words as text."""
    return "".join(word.text if word.joined or not number else f" {word.text}" for number, word in enumerate(words))


def plain(text: str) -> Word:
    """Return a piece of text that was not written in the file as one word."""
    return Word(Kind.SIGN, text)


def variables(words: Words) -> set[str]:
    """Return the names of the variables in words, without their signs."""
    return {word.text[1:] for word in words if word.kind is Kind.VARIABLE}


def rename(words: Words, names: Mapping[str, str]) -> Words:
    """Put texts in place of variables, by their names."""
    result = []
    for word in words:
        text = names.get(word.text[1:]) if word.kind is Kind.VARIABLE else None
        if text is None:
            result.append(word)
        else:
            kind = Kind.VARIABLE if text.startswith("?") else Kind.SIGN
            result.append(replace(word, text=text, kind=kind, joined=False))
    return result


def closing(words: Words, start: int) -> int:
    """Return the index of the bracket that closes the one at `start`; the number of words when none does."""
    depth = 0
    for index in range(start, len(words)):
        if words[index].kind is Kind.SIGN and words[index].text in _PAIRS:
            depth += 1
        elif words[index].kind is Kind.SIGN and words[index].text in _PAIRS.values():
            depth -= 1
            if depth == 0:
                return index
    return len(words)


def top_level(words: Words, sign: str) -> list[Words]:
    """Split words at a sign that is in no bracket."""
    parts: list[Words] = [[]]
    index = 0
    while index < len(words):
        word = words[index]
        end = closing(words, index) + 1 if word.kind is Kind.SIGN and word.text in _PAIRS else index + 1
        if word.kind is Kind.SIGN and word.text == sign:
            parts.append([])
        else:
            parts[-1] += words[index:end]
        index = end
    return parts if parts != [[]] else []


class _Reader:
    """Reads one string."""

    def __init__(self, graph: ShapesGraph, owner: Term, literal: Literal) -> None:
        self._graph = graph
        self._owner = owner
        self._text = normalise(literal.value)
        self._written = graph.string(literal, owner)
        self._prefixes = {**PREFIXES, **_prefixes(graph, owner)}

    def _offset(self, token: Token) -> int:
        return self._written.offset(token.start) if self._written else self._graph.offset(self._owner)

    def query(self, form: str) -> Query:
        lexed = self._prologue(list(tokens(self._text)))
        if not lexed or lexed[0].text.upper() != form:
            offset = self._offset(lexed[0]) if lexed else None
            hint = f"sh:{form.lower()} has a {form} query; only PREFIX declarations may precede it."
            raise self._error(f"expected a {form} query", offset, hint)
        words = [self._word(number, lexed) for number in range(len(lexed))]
        opening = next((number for number, word in enumerate(words) if word.text == "{"), len(words))
        if form == "CONSTRUCT" and opening == 1:
            template_end = closing(words, opening)
            opening = next((n for n, word in enumerate(words) if word.text == "{" and n > template_end), len(words))
        end = closing(words, opening)
        if end >= len(words):
            hint = "Each of { ( [ needs its counterpart, and a query needs WHERE { ... }."
            raise self._error("a bracket of the query is not closed, or it has no group", words[-1].offset, hint)
        return Query(form, words[1:opening], words[opening + 1 : end], words[end + 1 :], self._owner)

    def _prologue(self, lexed: list[Token]) -> list[Token]:
        """Take the PREFIX declarations of the text itself."""
        while lexed and lexed[0].text.upper() in {"PREFIX", "BASE", "VERSION"}:
            size = 3 if lexed[0].text.upper() == "PREFIX" else 2
            if size == 3 and len(lexed) > size:  # noqa: PLR2004 - PREFIX name: <iri>
                self._prefixes[lexed[1].text.rstrip(":")] = lexed[2].text[1:-1]
            elif lexed[0].text.upper() == "BASE":
                raise self._error("BASE is not allowed in a query of a shapes graph", self._offset(lexed[0]))
            lexed = lexed[size:]
        return lexed

    def _word(self, number: int, lexed: list[Token]) -> Word:
        token = lexed[number]
        offset = self._offset(token)
        joined = number > 0 and lexed[number - 1].end == token.start
        text = token.text
        if token.kind is Kind.VARIABLE:
            text = f"?{text[1:]}"
        elif token.kind is Kind.NAME and not text.startswith("_:"):
            text = self._named(text, offset)
        elif token.kind is Kind.IRI and not is_absolute(unescape(text[1:-1])):
            raise self._error(f"the IRI `{text}` is relative", offset, "Write it out, or use a prefix.")
        return Word(Kind.IRI if text.startswith("<") and len(text) > 2 else token.kind, text, offset, joined)  # noqa: PLR2004 - longer than `<=`

    def _named(self, name: str, offset: int) -> str:
        prefix, _, local = name.partition(":")
        namespace = self._prefixes.get(prefix)
        if namespace is None:
            near = similar(prefix, self._prefixes) if prefix else []
            declare = f'[ sh:prefix "{prefix}" ; sh:namespace "..." ]'
            hint = f"Point sh:prefixes at a node with sh:declare {declare}; the prefixes of Turtle do not count."
            fixes = [Fix(f"{each}:{local}") for each in near]
            raise self._error(f"unknown prefix `{prefix}:`", offset, suggest(near) or hint, fixes)
        return str(NamedNode(namespace + unescape_local(local)))

    def _error(self, message: str, offset: int | None, hint: str | None = None, fixes: Iterable[Fix] = ()) -> Exception:
        return self._graph.error(message, self._owner, hint=hint, offset=offset, fixes=fixes)


def _prefixes(graph: ShapesGraph, owner: Term) -> dict[str, str]:
    """Return what sh:prefixes declares, also through owl:imports (SHACL, section 5.2.1)."""
    prefixes: dict[str, str] = {}
    open_nodes = graph.values(owner, sh("prefixes"))
    seen: set[Term] = set()
    while open_nodes:
        node = open_nodes.pop()
        if node in seen:
            continue
        seen.add(node)
        open_nodes += graph.values(node, IMPORTS)
        for declaration in graph.values(node, sh("declare")):
            prefix, namespace = graph.required(declaration, "prefix"), graph.required(declaration, "namespace")
            if not isinstance(prefix, Literal) or not re.fullmatch(r"[\w.·-]*", prefix.value):
                raise graph.error(f"{prefix} is not a valid prefix", node, hint='sh:prefix has a string such as "ex".')
            value = namespace.value if isinstance(namespace, Literal | NamedNode) else str(namespace)
            if prefixes.setdefault(prefix.value, value) != value:
                raise graph.error(
                    f"the prefix `{prefix.value}:` is declared for two namespaces", node, hint="Leave one of them."
                )
    return prefixes
