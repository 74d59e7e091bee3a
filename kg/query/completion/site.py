"""A position in a query, with its context."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.query.completion.outline import Outline, outline
from kg.query.completion.typed import Form, Typed
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.query.completion.keeping import SnapshotCache
    from kg.query.completion.statistics import Statistics
    from kg.query.stored import StoredQuery


@dataclass(frozen=True, slots=True)
class Candidate:
    """A possible completion.

    `label` is shown, `insert` replaces the typed word, and `holes` are offsets in it to fill. `key` is matched with the
    typed text. Smaller `rank` comes first. `prefix` is the prefix of `insert`, if it is a prefixed name.
    """

    label: str
    insert: str
    kind: str
    key: str
    detail: str = ""
    count: int | None = None
    documentation: str = ""
    rank: int = 0
    holes: tuple[int, ...] = ()
    prefix: str = ""


@dataclass(frozen=True, slots=True)
class Site:
    """A position in a query. `before` is the outline before it, `whole` that of the query without the typed word."""

    text: str
    typed: Typed
    before: Outline
    whole: Outline
    cache: SnapshotCache
    statistics: Statistics
    stored: Callable[[], Sequence[StoredQuery]]

    @property
    def prefixes(self) -> dict[str, str]:
        """Prefixes that the query declares, the standard ones, and those of the store."""
        return {**self.statistics.prefixes, **PREFIXES, **self.before.prefixes}

    def short(self, iri: str) -> str:
        """Return an IRI as written in the query; its own declarations take precedence."""
        return shorten(iri, {**self.before.prefixes, **PREFIXES, **self.prefixes})

    def comment(self, iri: str) -> str:
        """Return the documentation of a term in the store."""
        return self.statistics.comments.get(iri, "")


_STANDS_FOR: Final = {Form.NAME: Kind.NAME, Form.VARIABLE: Kind.VARIABLE, Form.STRING: Kind.STRING, Form.IRI: Kind.IRI}


def site_of(
    text: str, typed: Typed, cache: SnapshotCache, statistics: Statistics, stored: Callable[[], Sequence[StoredQuery]]
) -> Site:
    """Return the site of the typed word in `text`."""
    before = outline(typed.before)
    whole = outline(typed.before)
    if typed.form in _STANDS_FOR:
        # A token replaces the typed word; without it, the rest of the query would be parsed one slot too early.
        outline(
            [Token(_STANDS_FOR[typed.form], "?" if typed.form is Form.VARIABLE else "", typed.start, typed.end)], whole
        )
    return Site(text, typed, before, outline(typed.after, whole), cache, statistics, stored)
