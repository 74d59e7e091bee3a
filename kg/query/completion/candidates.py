"""What is offered at each kind of place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.completion import terms
from kg.query.completion.outline import Role, Slot
from kg.query.completion.site import Candidate
from kg.query.completion.typed import Form
from kg.query.completion.vocabulary import AGGREGATES, FUNCTIONS, KEYWORDS
from kg.syntax.lexer import Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.query.completion.site import Site

__all__ = ["candidates"]

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
    """Yield what may stand at a site, whatever was typed of it."""
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
    """Return what offers some keywords."""
    found = [_keyword(name, KEYWORDS[name][1], rank) for name in names]
    return lambda _: found


def _keyword(name: str, sentence: str, rank: int = 1) -> Candidate:
    """Return the candidate for a keyword: what it inserts has a hole in each of its empty brackets."""
    insert = KEYWORDS[name][0] if name in KEYWORDS else name + " "
    holes = tuple(
        index + 1 for index in range(len(insert)) if insert[index : index + 2] in {"()", "<>", "? ", "?)", "( "}
    )
    holes += tuple(index + 2 for index in range(len(insert)) if insert.startswith("{  }", index))
    return Candidate(name, insert, "keyword", name, documentation=sentence, rank=rank, holes=tuple(sorted(holes)))


def variables(site: Site) -> Iterator[Candidate]:
    """Yield the variables of the query, the ones used most first."""
    used: dict[str, int] = {}
    for use in site.whole.uses:
        if use.name:
            used[use.name] = used.get(use.name, 0) + 1
    for name, number in used.items():
        yield Candidate("?" + name, "?" + name, "variable", "?" + name, count=number)


def _new_variables(site: Site) -> Iterator[Candidate]:
    """Yield a name for the value of the function before."""
    found = [token for token in site.typed.before if token.text.upper() in AGGREGATES]
    name = found[-1].text.lower() if found else "value"
    yield Candidate("?" + name, "?" + name, "variable", "?" + name, detail="a new variable")


def functions(site: Site) -> Iterator[Candidate]:
    """Yield the functions; behind GROUP BY, in SELECT and HAVING also those of groups."""
    groups = site.before.frame.role is Role.QUERY or any(
        each.slot in {Slot.PROJECTION, Slot.ORDER} for each in site.before.frames[:-1]
    )
    for known, rank in ((AGGREGATES, 1 if groups else 3), (FUNCTIONS, 2)):
        for name, one in known.items():
            hole = (len(name) + 1,) if one.arguments else ()
            detail = f"({one.arguments})"
            yield Candidate(name, f"{name}()", "function", name, detail, None, one.sentence, rank, hole)


def _aggregates(_site: Site) -> Iterator[Candidate]:
    """Yield aggregates as columns."""
    for name, one in AGGREGATES.items():
        insert = f"({name}() AS ?{name.lower()})"
        detail = f"({one.arguments}) as a column"
        yield Candidate(name, insert, "function", name, detail, None, one.sentence, 2, (len(name) + 2,))


def _stored(site: Site) -> Iterator[Candidate]:
    """Yield stored queries, where nothing else is written yet."""
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
