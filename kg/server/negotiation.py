"""Content negotiation: the format of a response, by the header `Accept` or by name in a link.

The kind of result of a query is known only when it runs, so a format is chosen for each kind. Source: RFC 9110, section
12.5.1.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from kg.query.formats import ALIASES, OF_GRAPHS, OF_RESULTS, Format
from kg.server.errors import RequestError


def _offered(formats: Sequence[Format], first: int) -> tuple[tuple[str, str], ...]:
    """Return media types with their formats: the first few of each format come before all others."""
    parts = (slice(first), slice(first, None))
    return tuple((media, one.name) for part in parts for one in formats for media in one.media[part])


RESULTS: Final = _offered(OF_RESULTS, 2)
"""Media types and formats of rows and booleans, the preferred one first."""
GRAPH: Final = _offered(OF_GRAPHS, 1)
"""Media types and formats of graphs, the preferred one first."""

_N3: Final = (("text/n3", "turtle"), ("text/rdf+n3", "turtle"))  # media types of Notation3, of which Turtle is a subset
_KINDS: Final = {"rows": RESULTS, "boolean": RESULTS, "graph": (*GRAPH, *_N3)}

_AS_GRAPH: Final = {"json": "jsonld", "xml": "rdfxml", "jsonld": "json", "rdfxml": "xml"}
"""The format of a graph result for the name of a format of rows."""

_WORD: Final = r"[!#$%&'*+.^_`|~0-9A-Za-z-]+"
_QUOTED: Final = r'"(?:[^"\\]|\\.)*"'
_ELEMENT: Final = re.compile(rf"(?:{_QUOTED}|[^,\"])*")
_RANGE: Final = re.compile(rf"\s*({_WORD})/({_WORD})\s*((?:;(?:{_QUOTED}|[^\"])*)?)")
_PARAMETER: Final = re.compile(rf";\s*(?:({_WORD})\s*=\s*({_WORD}|{_QUOTED}))?\s*")
_NAMED: Final = 3
_QUALITY: Final = re.compile(r"0(?:\.[0-9]{0,3})?|1(?:\.0{0,3})?")


@dataclass(frozen=True, slots=True)
class Choice:
    """A format and its media type."""

    format: str
    media_type: str

    @property
    def content_type(self) -> str:
        """The header `Content-Type`."""
        return f"{self.media_type}; charset=utf-8" if self.media_type.startswith("text/") else self.media_type


@dataclass(frozen=True, slots=True)
class Range:
    """A media range with its quality; `*` matches any type or subtype."""

    type: str
    subtype: str
    quality: float = 1.0
    charset: str | None = None

    def precision(self, media_type: str) -> int:
        """Return how closely the range names a media type: 3 exactly, 2 its type, 1 anything, 0 not at all."""
        if self.charset not in {None, "utf-8", "utf8", "*"}:
            return 0
        kind, _, subtype = media_type.partition("/")
        if (self.type, self.subtype) == (kind, subtype):
            return _NAMED
        return 0 if self.subtype != "*" else 2 if self.type == kind else self.type == "*"


def ranges(accept: str) -> list[Range]:
    """Return the media ranges of a header `Accept`; malformed elements are skipped."""
    return [media_range for element in _elements(accept) if (media_range := _range(element))]


def _elements(accept: str) -> Iterator[str]:
    start = 0
    while start <= len(accept):
        match = _ELEMENT.match(accept, start)
        end = match.end() if match else start
        if end < len(accept) and accept[end] != ",":
            return  # an unterminated quotation
        yield accept[start:end]
        start = end + 1


def _range(element: str) -> Range | None:
    match = _RANGE.fullmatch(element)
    if match is None or (match[1] == "*" and match[2] != "*"):
        return None
    parameters = _parameters(match[3].rstrip())
    if parameters is None or not _QUALITY.fullmatch(parameters.get("q", "1")):
        return None
    charset = parameters.get("charset")
    return Range(match[1].lower(), match[2].lower(), float(parameters.get("q", "1")), charset and charset.lower())


def _parameters(text: str) -> dict[str, str] | None:
    """Return the parameters of a media range by name; None if they are malformed."""
    parameters: dict[str, str] = {}
    position = 0
    while position < len(text):
        match = _PARAMETER.match(text, position)
        if match is None:
            return None
        if match[1]:
            value = match[2]
            parameters.setdefault(match[1].lower(), value[1:-1].replace("\\", "") if value[0] == '"' else value)
        position = match.end()
    return parameters


def best(accept: Sequence[Range], offered: Iterable[tuple[str, str]]) -> Choice | None:
    """Return the best match for one or more ranges; None if nothing matches.

    The closest range for each media type counts. Ties are resolved by the client's order, then by ours.
    """
    leading = (0.0, 0, 0)
    choice = None
    for media_type, name in offered:
        precision, order = max((one.precision(media_type), -index) for index, one in enumerate(accept))
        rank = (accept[-order].quality if precision else 0.0, precision, order * (precision == _NAMED))
        if rank[0] and rank > leading:
            leading, choice = rank, Choice(name, media_type)
    return choice


@lru_cache(maxsize=1024)
def choose(accept: str | None, named: tuple[str, ...] = ()) -> Mapping[str, Choice]:
    """Return the format for each kind of result (`rows`, `boolean`, `graph`) that the client accepts.

    `named` has formats by name or media type. The first known one wins; clients such as SPARQLWrapper send several.
    Without any, the header `accept` decides. If it allows anything, an unknown name is an error.

    Raises:
        RequestError: KG523 no format for any kind.
    """
    for name in named:
        if choices := _named(name.strip().lower()):
            return choices
    wanted = ranges(accept) if accept else []
    if any(named) and all(one.type == "*" for one in wanted):
        names = sorted({name for _, name in (*RESULTS, *GRAPH)})
        raise RequestError("KG523", f"unknown format `{named[0]}`", hint=f"Use one of {', '.join(names)}.")
    if not wanted:
        return {kind: Choice(offered[0][1], offered[0][0]) for kind, offered in _KINDS.items()}
    choices = _accepted(wanted)
    if not choices:
        types = ", ".join(dict.fromkeys(media_type for media_type, _ in (*RESULTS, *GRAPH)))
        raise RequestError("KG523", f"no answer can be written as `{accept}`", hint=f"Accept one of {types}.")
    return choices


def _accepted(wanted: Sequence[Range]) -> dict[str, Choice]:
    choices = {kind: best(wanted, offered) for kind, offered in _KINDS.items()} if wanted else {}
    return {kind: choice for kind, choice in choices.items() if choice}


def _named(name: str) -> dict[str, Choice]:
    if "/" in name and name not in ALIASES:
        return _accepted(ranges(name))
    name = ALIASES.get(name, name)
    names = {name, _AS_GRAPH.get(name, name)}
    return {
        kind: Choice(name, media_type)
        for kind, offered in _KINDS.items()
        for media_type, name in reversed(offered)
        if name in names
    }


def prefers_pages(accept: str | None) -> bool:
    """Return whether the client prefers HTML to everything else, as browsers do when they follow a link."""
    if not accept or "text/html" not in accept:
        return False
    wanted = ranges(accept)
    chosen = best(wanted, [("text/html", "html"), *RESULTS, *GRAPH]) if wanted else None
    return chosen is not None and chosen.format == "html"
