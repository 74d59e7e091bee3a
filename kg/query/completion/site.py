"""A place in a query where something is being typed, and what is known about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.query.completion.outline import Outline, outline
from kg.query.completion.typed import Form, Typed
from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.query.completion.keeping import Kept
    from kg.query.completion.statistics import Statistics
    from kg.query.stored import StoredQuery


@dataclass(frozen=True, slots=True)
class Candidate:
    """Something that may stand at a place.

    `label` is what people read, `insert` what replaces the word that is being typed; `holes` are offsets in it that
    want to be filled. `key` is what is compared with what was typed. A smaller `rank` comes first. `prefix` is
    what `insert` begins with.
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
    """The place: `before` is the outline of what stands before it, `whole` that of the query without the word."""

    text: str
    typed: Typed
    before: Outline
    whole: Outline
    kept: Kept
    statistics: Statistics
    stored: Callable[[], Sequence[StoredQuery]]

    @property
    def prefixes(self) -> dict[str, str]:
        """The prefixes that the query declares, those that are always known, and those of the store."""
        return {**self.statistics.prefixes, **PREFIXES, **self.before.prefixes}

    def short(self, iri: str) -> str:
        """Return an IRI as the query would write it; the prefixes that it declares come first."""
        return shorten(iri, {**self.before.prefixes, **PREFIXES, **self.prefixes})

    def comment(self, iri: str) -> str:
        """Return what the store says about a term."""
        return self.statistics.comments.get(iri, "")


_STANDS_FOR: Final = {Form.NAME: Kind.NAME, Form.VARIABLE: Kind.VARIABLE, Form.STRING: Kind.STRING, Form.IRI: Kind.IRI}


def site_of(
    text: str, typed: Typed, kept: Kept, statistics: Statistics, stored: Callable[[], Sequence[StoredQuery]]
) -> Site:
    """Return the site of what is being typed in `text`."""
    before = outline(typed.before)
    whole = outline(typed.before)
    if typed.form in _STANDS_FOR:
        # Without it what stands behind would be read one place too early.
        outline(
            [Token(_STANDS_FOR[typed.form], "?" if typed.form is Form.VARIABLE else "", typed.start, typed.end)], whole
        )
    return Site(text, typed, before, outline(typed.after, whole), kept, statistics, stored)
