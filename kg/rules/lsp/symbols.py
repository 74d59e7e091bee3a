"""Variables, prefixes, terms and rule names in the text of a file, and all places that mean the same one.

Offsets count characters of the text as it is. A file is a rule in one of the three notations, an ontology or a stored
query (`.ttl`, `.rq`), a page of examples (`.md`), or `kg.toml`.

It also finds where ontologies define terms.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final, NamedTuple
from urllib.parse import unquote, urlsplit

import pyoxigraph
from pyoxigraph import Literal, NamedNode, RdfFormat

from kg.errors import Place, RuleError, UsageError
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.checks.run import check_file
from kg.rules.documents import statements
from kg.rules.notations.shacl.graph import StringToken
from kg.rules.reading import read_text
from kg.syntax.functions import FUNCTIONS
from kg.syntax.lexer import Kind, Token, iri_of, is_name, normalise, quoted, token_at, tokens, unescape, unescape_local
from kg.syntax.names import PREFIXES, RDF_TYPE, is_absolute, resolve, shorten
from kg.syntax.prologue import declared

_LOCAL: Final = re.compile(r"[^#/]*\Z")
_BLOCK: Final = re.compile(r"^```turtle[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
_QUOTED: Final = re.compile(r"""(["'])(.*?)\1""")
_QUERIES: Final = frozenset(PREFIXES["sh"] + name for name in ("construct", "select", "ask"))
_PREBOUND: Final = frozenset({"this", "value", "PATH", "currentShape", "shapesGraph"})
"""Variables of SHACL with a meaning of their own."""
_TURTLE, _QUERY = "turtle", "query"

_KINDS: Final = {
    PREFIXES["owl"] + "Class": "class",
    PREFIXES["rdfs"] + "Class": "class",
    PREFIXES["owl"] + "ObjectProperty": "property",
    PREFIXES["owl"] + "DatatypeProperty": "property",
    PREFIXES["owl"] + "AnnotationProperty": "property",
    PREFIXES["rdf"] + "Property": "property",
    PREFIXES["owl"] + "NamedIndividual": "individual",
    PREFIXES["skos"] + "Concept": "individual",
}
_LABEL: Final = NamedNode(PREFIXES["rdfs"] + "label")
_COMMENTS: Final = (NamedNode(PREFIXES["rdfs"] + "comment"), NamedNode(PREFIXES["skos"] + "definition"))


@dataclass(frozen=True, slots=True)
class DefinedTerm:
    """A class, property or individual: `kind` is which, `uses` how often the store has it (None: not known)."""

    iri: str
    kind: str
    label: str = ""
    comment: str = ""
    place: Place | None = None
    uses: int | None = None

    @property
    def short(self) -> str:
        """The term with its prefix, where it has a known one."""
        return shorten(self.iri)

    def described(self) -> str:
        """Return the Markdown of the hover on a term."""
        lines = [f"**{self.short}** ({self.kind})" + (f": {self.label}" if self.label else "")]
        lines += [self.comment] if self.comment else []
        lines += [f"{self.uses:,} triples in the store"] if self.uses is not None else []
        lines += [f"`{self.iri}`"]
        return "\n\n".join(lines)


@dataclass(frozen=True, slots=True)
class Terms:
    """The terms of some ontologies by their IRI."""

    by_iri: Mapping[str, DefinedTerm] = field(default_factory=dict)

    @classmethod
    def of(cls, files: Iterable[Path], uses: Mapping[str, int] | None = None) -> Terms:
        """Read the terms of files in Turtle; `uses` has how often a store uses terms, those of no ontology too."""
        terms: dict[str, DefinedTerm] = {}
        counted = uses or {}
        for path in files:
            store = pyoxigraph.Store()
            store.load(path=path, format=RdfFormat.TURTLE)
            stated = statements([path])
            for quad in store.quads_for_pattern(None, RDF_TYPE, None):
                kind = _KINDS.get(quad.object.value) if isinstance(quad.object, NamedNode) else None
                if kind and isinstance(quad.subject, NamedNode):
                    iri = quad.subject.value
                    place = Place(str(path), stated[iri].line, 1) if iri in stated else None
                    label, *comments = (_text(store, quad.subject, each) for each in (_LABEL, *_COMMENTS))
                    comment = next(filter(None, comments), "")
                    terms.setdefault(iri, DefinedTerm(iri, kind, label, comment, place, counted.get(iri)))
        for iri, number in counted.items():
            terms.setdefault(iri, DefinedTerm(iri, "property", uses=number))
        return cls(terms)

    def in_namespace(self, namespace: str) -> list[DefinedTerm]:
        """Return the terms of a namespace, sorted by name."""
        return sorted(
            (each for each in self.by_iri.values() if each.iri.startswith(namespace)), key=lambda one: one.iri
        )


def _text(store: pyoxigraph.Store, subject: NamedNode, predicate: NamedNode) -> str:
    texts = (quad.object for quad in store.quads_for_pattern(subject, predicate, None))
    return next((text.value for text in texts if isinstance(text, Literal)), "")


class Symbol(NamedTuple):
    """What the text means at an offset: `kind` is variable, prefix, term or rule.

    `name` is without sign or prefix: that of a variable or prefix, an IRI, the name of a rule. `scope` is where a
    variable or prefix has its meaning. `start` and `end` are those of the part of the text that renaming changes.
    """

    kind: str
    name: str
    scope: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A part of a text that means a symbol; `declares` for where a prefix is declared, `path` for an imported file."""

    start: int
    end: int
    declares: bool = False
    path: Path | None = None


class _Word(NamedTuple):
    """A token, the scope of its variables, that of its prefixes, and their namespaces."""

    token: Token
    scope: str
    layer: str
    prefixes: Mapping[str, str]


def symbol_at(text: str, offset: int, path: Path, name: str, rules: Collection[str]) -> Symbol | None:
    """Return the symbol at an offset; `name` is that of the rule at `path`, `rules` are the names of all rules.

    The first line of the header stands for the rule itself.
    """
    first = text.partition("\n")[0]
    if name in rules and first.startswith("#") and offset <= len(first):
        return Symbol("rule", name, "", 0, len(first.rstrip()))
    # The sign of a variable belongs to it.
    candidates = [each for each in _symbols(text, path) if each.start - (each.kind == "variable") <= offset <= each.end]
    candidates = [each for each in candidates if each.kind != "rule" or each.name in rules]
    # Where two touch, as a prefix and its name do, the one that begins at the offset is meant.
    return max(candidates, key=lambda each: each.start, default=None)


def occurrences(symbol: Symbol, text: str, path: Path) -> Iterator[Occurrence]:
    """Yield where a text means a symbol; for a rule also what a rule set imports, with the path of the file."""
    for each in _symbols(text, path):
        if each.kind == symbol.kind and each.name == symbol.name and each.scope == symbol.scope:
            # A prefix is declared by PREFIX or sh:prefix.
            before = text[: each.start] if symbol.kind == "prefix" else ""
            declares = re.search(r"(prefix\s+|:prefix\s+[\"'])\Z", before, re.IGNORECASE) is not None
            yield Occurrence(each.start, each.end, declares)
    if symbol.kind == "rule" and path.suffix == ".srl":
        yield from _imports(text, path)


def renamed(symbol: Symbol, new: str, text: str, path: Path) -> str:
    """Return what replaces the occurrences of a symbol; `text` is that of the file in which it is renamed.

    Raises UsageError: KG003 for a name of another form, one that is taken in the scope, or a symbol with a fixed name.
    """
    if symbol.kind == "rule":
        if not re.fullmatch(r"[\w.-]+(/[\w.-]+)+", new):
            raise _refused(f"`{new}` is not the name of a rule", "Write FAMILY/NAME.")
        return new
    if symbol.kind == "term":
        return _new_local(symbol, new, text, path)
    if symbol.kind == "variable":
        new = new.lstrip("?$")
        if symbol.scope.startswith(_QUERY) and symbol.name in _PREBOUND:
            raise _refused(f"SHACL gives ${symbol.name} its value", "Rename another variable.")
        token = token_at(f"?{new}", 0)
        fits = token.kind is Kind.VARIABLE and token.text == f"?{new}"
    else:
        new = new.removesuffix(":")
        token = token_at(f"{new}:", 0)
        fits = token.kind is Kind.NAME and token.text == f"{new}:" and not new.startswith("_")
    if not fits:
        raise _refused(f"`{new}` is not the name of a {symbol.kind}", "Use letters, digits and `_`.")
    if any(occurrences(symbol._replace(name=new), text, path)):
        raise _refused(f"there is a {symbol.kind} `{new}` already", "Choose another name.")
    if symbol.kind == "prefix" and not any(each.declares for each in occurrences(symbol, text, path)):
        raise _refused(f"the file does not declare the prefix `{symbol.name}:`", "Declare it with the new name.")
    return new


def _new_local(symbol: Symbol, new: str, text: str, path: Path) -> str:
    prefix, colon, local = new.rpartition(":")
    namespace = symbol.name[: len(symbol.name) - len(_local_of(symbol.name))]
    own = {word.prefixes.get(prefix) for word in _words(text, path)} if colon else {namespace}
    if namespace not in own:
        raise _refused(f"`{new}` has another namespace", "Renaming changes the part after the prefix.")
    token = token_at(f"p:{local}", 0)
    if not local or token.kind is not Kind.NAME or token.text != f"p:{local}" or _LOCAL.match(local) is None:
        raise _refused(f"`{local}` is not a local name", "Use letters, digits, `_` and `-`.")
    return local


def _refused(message: str, hint: str) -> UsageError:
    return UsageError("KG003", message, hint=hint)


def _local_of(iri: str) -> str:
    match = _LOCAL.search(iri)
    return match.group() if match else ""


def _imports(text: str, path: Path) -> Iterator[Occurrence]:
    before = None
    for token in tokens(text):
        if token.kind is Kind.IRI and before is not None and before.text.upper() == "IMPORTS":
            with suppress(ValueError):
                parts = urlsplit(resolve(path.absolute().as_uri(), token.text[1:-1]))
                if parts.scheme == "file":
                    yield Occurrence(token.start + 1, token.end - 1, path=Path(unquote(parts.path)))
        before = token


@lru_cache(maxsize=1024)
def _symbols(text: str, path: Path) -> tuple[Symbol, ...]:
    """Return all symbols of a text; every quoted text counts as the name of a rule."""
    if path.suffix == ".toml":
        return tuple(Symbol("rule", match[2], "", match.start(2), match.end(2)) for match in _QUOTED.finditer(text))
    if path.suffix == ".md":
        blocks = ((match.start(1), match[1]) for match in _BLOCK.finditer(text))
        inner = ((start, each) for start, block in blocks for each in _symbols(block, Path("block.ttl")))
        return tuple(
            each._replace(start=start + each.start, end=start + each.end)
            for start, each in inner
            if each.kind in {"term", "rule"}
        )
    return tuple(_read(text, path))


def _read(text: str, path: Path) -> Iterator[Symbol]:
    for token, scope, layer, prefixes in _words(text, path):
        if token.kind is Kind.VARIABLE:
            yield Symbol("variable", token.text[1:], scope, token.start + 1, token.end)
        elif token.kind is Kind.STRING:
            quotes, value = quoted(token)
            kind = ("prefix", value, _QUERY) if scope == "sh:prefix" else ("rule", value, "")
            yield Symbol(*kind, token.start + quotes, token.end - quotes)
        elif token.kind is Kind.IRI:
            iri = token.text[1:-1]
            local = _local_of(iri)
            if local and is_absolute(iri):
                yield Symbol("term", iri, "", token.end - 1 - len(local), token.end - 1)
        elif token.kind is Kind.NAME and not token.text.startswith("_:"):
            prefix, _, local = token.text.partition(":")
            yield Symbol("prefix", prefix, layer, token.start, token.start + len(prefix))
            if local and prefix in prefixes:
                iri = prefixes[prefix] + unescape_local(local)
                start = token.end - len(_local_of(iri)) if "\\" not in local else token.start + len(prefix) + 1
                yield Symbol("term", iri, "", max(start, token.start + len(prefix) + 1), token.end)


def _words(text: str, path: Path) -> Iterator[_Word]:
    built_in = {} if path.suffix == ".srl" else PREFIXES
    prefixes = {**built_in, **declared(text)}
    lexed = list(tokens(text))
    if path.suffix == ".ttl":
        yield from _turtle(lexed, prefixes)
        return
    number = depth = 0
    for token in lexed:
        depth += (token.text == "{") - (token.text == "}")
        if path.suffix == ".srl" and depth == 0 and token.kind is Kind.WORD and token.text.upper() in {"RULE", "DATA"}:
            number += text[: token.start].rstrip()[-5:].upper() != "WHERE"  # `WHERE DATA` begins no statement
        yield _Word(token, f"rule {number}", "", prefixes)


def _turtle(lexed: Sequence[Token], prefixes: Mapping[str, str]) -> Iterator[_Word]:
    """Yield the tokens of Turtle, and those of the queries in its strings."""
    declared = {**PREFIXES, **dict(_declared(lexed, prefixes))}
    predicate = ""
    for token in lexed:
        if is_name(token):
            predicate = iri_of(token, prefixes) or ""
        if token.kind is Kind.STRING and predicate in _QUERIES:
            written = StringToken.of(token)
            with suppress(ValueError):  # an escape that is no character
                for inner in tokens(unescape(written.written)):
                    start, end = written.offset(inner.start), written.offset(inner.end)
                    yield _Word(inner._replace(start=start, end=end), f"{_QUERY} {token.start}", _QUERY, declared)
        else:
            yield _Word(token, "sh:prefix" if predicate == PREFIXES["sh"] + "prefix" else "", _TURTLE, prefixes)


def _declared(lexed: Iterable[Token], prefixes: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the prefixes that `sh:declare` has for queries."""
    predicate, prefix = "", None
    for token in lexed:
        if is_name(token):
            predicate = iri_of(token, prefixes) or ""
        elif token.kind is Kind.STRING and predicate == PREFIXES["sh"] + "prefix":
            prefix = token.text[1:-1]
        elif token.kind is Kind.STRING and predicate == PREFIXES["sh"] + "namespace" and prefix is not None:
            yield prefix, token.text[1:-1]


_WORD: Final = re.compile(r"[?$]?[\w.-]*(?::[\w.-]*)?$")
_KEYWORDS: Final = {
    ".rq": ("CONSTRUCT", "WHERE", "FILTER", "OPTIONAL", "UNION", "MINUS", "BIND", "VALUES", "NOT EXISTS", "PREFIX"),
    ".srl": ("RULE", "WHERE", "FILTER", "SET", "NOT", "DATA", "PREFIX", "IMPORTS"),
    ".ttl": ("@prefix",),
}


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A completion: `start` is the offset of what `text` replaces; `kind` is variable, term, keyword or function."""

    text: str
    kind: str
    start: int
    detail: str = ""
    documentation: str = ""


def prefixes_of(text: str) -> dict[str, str]:
    """Return the prefixes that a text may use: those that it declares, and those that need no declaration."""
    return {**PREFIXES, **declared(text)}


def diagnose(text: str, path: Path, name: str, context: Context) -> list[Finding]:
    """Return the findings on the text of a rule, saved or not."""
    try:
        file = read_text(text, path, name)
    except RuleError as error:
        return [from_error(error, name, Place(str(path), 1, 1))]
    return list(check_file(file, context))


def width(text: str, place: Place) -> int:
    """Return how many characters of its line belong to what is at a place: a token, or a line of the header."""
    text = normalise(text)
    lines = text.split("\n")
    number, column = (place.line or 1) - 1, (place.column or 1) - 1
    line = lines[number] if number < len(lines) else ""
    if line.startswith("#"):
        return max(len(line) - column, 1)
    start = sum(len(each) + 1 for each in lines[:number]) + column
    token = next((each for each in tokens(text) if each.start <= start < each.end), None)
    if token is not None and token.kind is Kind.STRING and token.start < start:
        token = token_at(text, start)  # in the query of a SHACL rule
    return min(token.end - start, len(line) - column) if token and token.start == start else 1


def complete(text: str, offset: int, suffix: str, terms: Terms) -> list[Suggestion]:
    """Return completions at `offset`: variables, terms of a prefix, words of the notation."""
    match = _WORD.search(text, 0, offset)
    word = match.group() if match else ""
    start = offset - len(word)
    if word[:1] in {"?", "$"}:
        names = {token.text for token in tokens(text) if token.kind is Kind.VARIABLE and token.text[1:] != word[1:]}
        return [Suggestion(each, "variable", start) for each in sorted(names)]
    prefix, colon, _ = word.partition(":")
    if colon:
        namespace = prefixes_of(text).get(prefix, "")
        return [
            Suggestion(
                f"{prefix}:{each.iri.removeprefix(namespace)}",
                "term",
                start,
                f"{each.kind} {each.label}".strip(),
                each.described(),
            )
            for each in (terms.in_namespace(namespace) if namespace else ())
        ]
    words = [Suggestion(each, "keyword", start) for each in _KEYWORDS[suffix]]
    words += [Suggestion(f"{each}:", "term", start, iri) for each, iri in prefixes_of(text).items()]
    if suffix != ".ttl":
        words += [Suggestion(f"{each}(", "function", start) for each in sorted(FUNCTIONS)]
    return words


def hover(text: str, offset: int, path: Path, name: str, terms: Terms) -> str | None:
    """Return Markdown about what is at `offset`: a term, or in the header the documentation of the rule."""
    term = term_at(text, offset, terms)
    if term is not None:
        return term.described()
    line = text[text.rfind("\n", 0, offset) + 1 :]
    if not line.startswith("#"):
        return None
    try:
        documentation = read_text(text, path, name).documentation
    except RuleError:
        return None
    sections = [f"### {heading}\n\n{body}" for heading, body in documentation.sections.items()]
    return "\n\n".join([f"## {documentation.title}", *sections])


def term_at(text: str, offset: int, terms: Terms) -> DefinedTerm | None:
    """Return the term of an ontology that is named at `offset`."""
    token = next((each for each in tokens(text) if each.start <= offset <= each.end and is_name(each)), None)
    iri = iri_of(token, prefixes_of(text)) if token else None
    return terms.by_iri.get(iri) if iri else None
