"""Language features for the text of a rule, as functions of the text; positions are offsets in characters."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import Place, RuleError
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.checks.run import check_file
from kg.rules.reading import read_text
from kg.syntax.functions import FUNCTIONS
from kg.syntax.lexer import Kind, iri_of, is_name, normalise, token_at, tokens
from kg.syntax.names import PREFIXES
from kg.syntax.prologue import declared

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.lsp.symbols import DefinedTerm, Terms

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
