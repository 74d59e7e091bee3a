"""`complete`: the candidates at a position of a query, for any interface."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from kg.query.completion import terms
from kg.query.completion.outline import Role, Slot
from kg.query.completion.site import Candidate, Form, Site, site_of, typed
from kg.query.completion.vocabulary import AGGREGATES, FUNCTIONS, KEYWORDS
from kg.syntax.lexer import Kind
from kg.syntax.prologue import declaration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kg.query.completion.statistics import SnapshotCache
    from kg.query.stored import StoredQuery

WORST: Final = 4
_SHORTEST: Final = 2
"""Shorter texts are not matched as subsequences of a name."""
_SIGNS: Final = re.compile(r"\A[^a-z0-9]+")
_HUMP: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")


def matcher(typed: str) -> Callable[[str], int | None]:
    """Return a function that rates how well a name matches the typed text; it returns None for no match.

    0 is the name itself, 1 its beginning (or after a leading sign such as a slash), 2 the beginning of a part (after a
    slash, a dot, an underscore or a hump of camel case), 3 anywhere in it, 4 the characters as a subsequence that
    starts at the beginning of a part.
    """
    wanted = typed.lower()
    if not wanted:
        return lambda _: 1
    part = re.compile(r"(?:^|[^a-z0-9])" + re.escape(wanted))
    spread = re.compile(r"(?:^|[^a-z0-9])" + ".*?".join(map(re.escape, wanted)), re.DOTALL)

    def fit(name: str) -> int | None:
        lower = name.lower()
        if wanted not in lower:
            parts = _HUMP.sub(" ", name).lower()
            return WORST if len(wanted) >= _SHORTEST and spread.search(parts) else None
        if lower == wanted:
            return 0
        if lower.startswith(wanted) or _SIGNS.sub("", lower, count=1).startswith(wanted):
            return 1
        humps = (name[hump.start() : hump.start() + len(wanted)].lower() for hump in _HUMP.finditer(name))
        return 2 if part.search(lower) or wanted in humps else 3

    return fit


_FORMS: Final = ("SELECT", "CONSTRUCT", "ASK", "DESCRIBE", "PREFIX", "BASE")
_PATTERNS: Final = (
    "OPTIONAL",
    "FILTER",
    "FILTER NOT EXISTS",
    "FILTER EXISTS",
    "BIND",
    "VALUES",
    "UNION",
    "MINUS",
    "GRAPH",
)
_MODIFIERS: Final = ("GROUP BY", "HAVING", "ORDER BY", "LIMIT", "OFFSET", "VALUES")


def candidates(site: Site) -> Iterator[Candidate]:
    """Yield the candidates for a site, before matching the typed text."""
    form, slot = site.typed.form, site.before.frame.slot
    if form is Form.COMMENT:
        return
    if form is Form.STRING:
        yield from terms.values_here(site)
    elif form is Form.VARIABLE:
        yield from variables(site)
    elif site.before.previous is not None and site.before.previous.text.lower() in _BY:
        yield _keyword(_BY[site.before.previous.text.lower()], "")
    else:
        for produce in _AT[slot]:
            yield from produce(site)


_BY: Final = {"group": "BY", "order": "BY"}


def keywords(*names: str, rank: int = 1) -> Callable[[Site], Iterable[Candidate]]:
    """Return a producer of candidates for some keywords."""
    candidates_of_words = [_keyword(name, KEYWORDS[name][1], rank) for name in names]
    return lambda _: candidates_of_words


def _keyword(name: str, sentence: str, rank: int = 1) -> Candidate:
    """Return the candidate for a keyword, with a hole in each of its empty brackets."""
    insert = KEYWORDS[name][0] if name in KEYWORDS else name + " "
    holes = tuple(
        index + 1 for index in range(len(insert)) if insert[index : index + 2] in {"()", "<>", "? ", "?)", "( "}
    )
    holes += tuple(index + 2 for index in range(len(insert)) if insert.startswith("{  }", index))
    return Candidate(name, insert, "keyword", name, documentation=sentence, rank=rank, holes=tuple(sorted(holes)))


def variables(site: Site) -> Iterator[Candidate]:
    """Yield the variables of the query with their numbers of uses."""
    used: dict[str, int] = {}
    for use in site.whole.uses:
        if use.name:
            used[use.name] = used.get(use.name, 0) + 1
    for name, number in used.items():
        yield Candidate("?" + name, "?" + name, "variable", "?" + name, count=number)


def _new_variables(site: Site) -> Iterator[Candidate]:
    aggregates = [token for token in site.typed.before if token.text.upper() in AGGREGATES]
    name = aggregates[-1].text.lower() if aggregates else "value"
    yield Candidate("?" + name, "?" + name, "variable", "?" + name, detail="a new variable")


def functions(site: Site) -> Iterator[Candidate]:
    """Yield the functions; aggregates rank higher after GROUP BY, in SELECT and in HAVING."""
    groups = site.before.frame.role is Role.QUERY or any(
        each.slot in {Slot.PROJECTION, Slot.ORDER} for each in site.before.frames[:-1]
    )
    for group, rank in ((AGGREGATES, 1 if groups else 3), (FUNCTIONS, 2)):
        for name, one in group.items():
            hole = (len(name) + 1,) if one.arguments else ()
            detail = f"({one.arguments})"
            yield Candidate(name, f"{name}()", "function", name, detail, None, one.sentence, rank, hole)


def _aggregates(_site: Site) -> Iterator[Candidate]:
    for name, one in AGGREGATES.items():
        insert = f"({name}() AS ?{name.lower()})"
        detail = f"({one.arguments}) as a column"
        yield Candidate(name, insert, "function", name, detail, None, one.sentence, 2, (len(name) + 2,))


def _stored(site: Site) -> Iterator[Candidate]:
    if not site.typed.before and not site.typed.after:
        for one in site.stored():
            yield Candidate(one.name, one.text, "query", one.name, one.title, None, one.description, 3)


def _expression(site: Site) -> Iterator[Candidate]:
    before = site.typed.before
    operand = bool(before) and (before[-1].kind not in {Kind.SIGN, Kind.WORD} or before[-1].text in {")", "]"})
    if operand:
        yield from keywords("AS", "IN", "NOT IN", rank=0)(site)
        return
    yield from terms.compared_values(site)
    yield from variables(site)
    yield from functions(site)
    yield from keywords("EXISTS", "NOT EXISTS", "DISTINCT", rank=3)(site)
    yield from terms.prefixes(site)


def _subject(site: Site) -> Iterator[Candidate]:
    yield from variables(site)
    yield from keywords(*_PATTERNS)(site)
    if site.before.frame.role is Role.GROUP and not site.whole.patterns:
        yield from keywords("SELECT", rank=2)(site)
    yield from terms.prefixes(site)


def _after(site: Site) -> Iterator[Candidate]:
    yield from keywords(*_PATTERNS)(site)
    yield from variables(site)


_AT: Final[dict[Slot, tuple[Callable[[Site], Iterable[Candidate]], ...]]] = {
    Slot.BEGIN: (keywords(*_FORMS, rank=0), _stored),
    Slot.PREFIX: (terms.declarations,),
    Slot.NAMESPACE: (terms.namespaces,),
    Slot.PROJECTION: (variables, keywords("DISTINCT", "WHERE", "FROM"), _aggregates),
    Slot.DATASET: (terms.graph_names, keywords("NAMED", "WHERE")),
    Slot.CLAUSE: (keywords("WHERE", "FROM"),),
    Slot.TEMPLATE: (keywords("WHERE"),),
    Slot.OPENING: (),
    Slot.CONSTRAINT: (keywords("EXISTS", "NOT EXISTS", rank=0), functions),
    Slot.GRAPH: (variables, terms.graph_names),
    Slot.SUBJECT: (_subject,),
    Slot.PREDICATE: (terms.properties, variables),
    Slot.OBJECT: (terms.values_here, variables, terms.prefixes),
    Slot.AFTER: (_after,),
    Slot.EXPRESSION: (_expression,),
    Slot.NEW: (_new_variables,),
    Slot.COLUMNS: (variables,),
    Slot.DATA: (terms.values_here, keywords("UNDEF")),
    Slot.MODIFIER: (keywords(*_MODIFIERS, rank=0),),
    Slot.ORDER: (variables, keywords("ASC", "DESC", *_MODIFIERS[1:-1]), functions),
    Slot.NUMBER: (),
}


_MOST: Final = 100
"""Largest number of returned candidates."""


def complete(
    text: str,
    position: int,
    cache: SnapshotCache,
    stored: Callable[[], Sequence[StoredQuery]] = tuple,
    *,
    fresh: bool = False,
) -> dict[str, Any]:
    """Return the completions at `position` (in code points) of the query `text`, the likeliest first.

    `range` (`start`, `end`) is the part of the text that an item replaces. Each of the `items` has `label`, `insert`,
    `kind` (keyword, function, variable, prefix, class, property, value, graph or query), `detail`, `count` (null if not
    applicable), `documentation`, `holes` (offsets in `insert` to fill, in the order of the Tab key) and `edits`: other
    changes, each with `start`, `end` and `text`, as offsets in the original text. `more` is whether candidates were
    left out. `ready` is false while the statistics of the store are being counted. `stored` returns the stored queries.
    """
    at = typed(text, position)
    statistics = cache.statistics(fresh=fresh)
    site = site_of(text, at, cache, statistics, stored)
    best = _best(site, candidates(site))
    return {
        "range": {"start": at.start, "end": at.end},
        "items": [_item(site, one) for one in best[:_MOST]],
        "more": len(best) > _MOST,
        "ready": bool(statistics.properties),
    }


def _best(site: Site, every: Iterable[Candidate]) -> list[Candidate]:
    """Return the candidates that match the typed text, the best first, without duplicates of the inserted text."""
    fit = _fit(site)
    ranked = []
    for one in every:
        score = fit(one)
        if score is not None:
            ranked.append(((score + 2 * one.rank, one.rank, -(one.count or 0), one.label), one))
    ranked.sort(key=lambda pair: pair[0])
    best: dict[str, Candidate] = {}
    for _, one in ranked:
        best.setdefault(one.insert, one)
    return list(best.values())


def _fit(site: Site) -> Callable[[Candidate], int | None]:
    text, form = site.typed.text, site.typed.form
    if form is Form.VARIABLE:
        variable = matcher(text[1:])
        return lambda one: variable(one.key[1:]) if one.kind == "variable" else None
    if form is Form.NAME:
        prefix, _, local = text.partition(":")
        name = matcher(local)
        return lambda one: _of_name(one, prefix, name)
    whole = matcher(text.removeprefix("<"))
    if form is not Form.WORD:
        return lambda one: whole(one.key)
    return lambda one: _of_word(one, text, whole)


def _of_name(one: Candidate, prefix: str, name: Callable[[str], int | None]) -> int | None:
    """Return the rating of a candidate for a prefixed name, whose prefix must be equal."""
    own, colon, local = one.insert.partition(":")
    return name(local.partition(" ")[0]) if colon and own == prefix else None


def _of_word(one: Candidate, text: str, whole: Callable[[str], int | None]) -> int | None:
    """Return the rating of a candidate for a word; also compares local names, and variables without their mark."""
    score = whole(one.key)
    if one.kind in {"class", "property", "value"} and ":" in one.label:
        local = whole(one.label.partition(":")[2])
        score = min((each for each in (score, local) if each is not None), default=None)
    elif one.kind == "variable":
        score = whole(one.key[1:])
    if score == WORST and one.kind in {"keyword", "function"} and len(text) < _WORD:
        return None
    return score


_WORD: Final = 3
"""Shorter words do not match keywords and functions as subsequences."""


def _item(site: Site, one: Candidate) -> dict[str, Any]:
    return {
        "label": one.label,
        "insert": one.insert,
        "kind": one.kind,
        "detail": one.detail,
        "count": one.count,
        "documentation": one.documentation,
        "holes": list(one.holes),
        "edits": _edits(site, one),
    }


def _edits(site: Site, one: Candidate) -> list[dict[str, Any]]:
    """Return an edit that declares the prefix of a candidate, if the query lacks it."""
    if not one.prefix or one.prefix in site.whole.prefixes or one.prefix not in site.prefixes:
        return []
    at, text = declaration(site.text, {one.prefix: site.prefixes[one.prefix]})
    return [{"start": at, "end": at, "text": text}]
