"""Filters that identifiers alone decide, as masks over rows, with the same result as the store's engine."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode

from kg.rules.engine.facts import Keys, distinct
from kg.rules.engine.terms import BLANK, IRI, LITERAL, Dictionary
from kg.store.terms import datatype, spell
from kg.syntax.lexer import bare

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from kg.rules.engine.tables import Table
    from kg.rules.form import Expression

    Mask = NDArray[np.bool_]

_IRI: Final = r"<[^<>\"{}|^`\\\s]*>"
_OPERAND: Final = rf"(\?\w+|{_IRI})"
_COMPARISON: Final = re.compile(rf"\s*{_OPERAND}\s*(!?=)\s*{_OPERAND}\s*")
_SAME: Final = re.compile(rf"\s*(!?)\s*sameTerm\s*\(\s*{_OPERAND}\s*,\s*{_OPERAND}\s*\)\s*", re.IGNORECASE)
_KIND: Final = re.compile(r"\s*(!?)\s*(isIRI|isURI|isBlank|isLiteral)\s*\(\s*(\?\w+)\s*\)\s*", re.IGNORECASE)
_BOUND: Final = re.compile(r"\s*(!?)\s*BOUND\s*\(\s*(\?\w+)\s*\)\s*", re.IGNORECASE)
_AMONG: Final = re.compile(rf"\s*(\?\w+)\s+(NOT\s+)?IN\s*\(\s*({_IRI}(?:\s*,\s*{_IRI})*)\s*\)\s*", re.IGNORECASE)
_TYPED: Final = re.compile(rf"\s*DATATYPE\s*\(\s*(\?\w+)\s*\)\s*(!?=)\s*{_OPERAND}\s*", re.IGNORECASE)
_KINDS: Final = {"isiri": IRI, "isuri": IRI, "isblank": BLANK, "isliteral": LITERAL}


@cache
def has_shortcut(text: str) -> bool:
    """Return whether identifiers may decide a filter, which costs almost nothing."""
    return any(form.fullmatch(bare(text)) for form, _ in _FORMS)


@dataclass(frozen=True, slots=True)
class _Rows:
    """The rows that a filter is applied to."""

    table: Table
    columns: Mapping[str, str]
    dictionary: Dictionary

    def operand(self, text: str) -> Keys | None:
        """Return the identifiers of an operand; None when it is not bound everywhere."""
        if not text.startswith("?"):
            return np.array([self.dictionary.intern(spell(NamedNode(text[1:-1])))], np.int64)
        if text[1:] not in self.columns:
            return None
        values = self.table.columns[self.columns[text[1:]]]
        return values if values.all() else None

    def same(self, left: Keys, right: Keys, *, wanted: bool) -> Mask:
        """Return for each row whether two operands are the same term, or are not."""
        mask: Mask = np.broadcast_to((left == right) == wanted, (self.table.rows,))
        return mask


def shortcut(expression: Expression, table: Table, columns: Mapping[str, str], dictionary: Dictionary) -> Mask | None:
    """Return for each row whether a filter holds, or None if that needs evaluation."""
    rows = _Rows(table, columns, dictionary)
    text = bare(expression.text)
    for form, decide in _FORMS:
        match = form.fullmatch(text)
        if match:
            return decide(match, rows)
    return None


def _compared(match: re.Match[str], rows: _Rows) -> Mask | None:
    """Compare by `=` or `!=`; two literals may be equal though they are different terms, so they are left out."""
    left, right = rows.operand(match[1]), rows.operand(match[3])
    if left is None or right is None:
        return None
    kinds = rows.dictionary.kinds
    plain = (kinds(left) <= BLANK) | (kinds(right) <= BLANK)
    return rows.same(left, right, wanted=match[2] == "=") if plain.all() else None


def _same_term(match: re.Match[str], rows: _Rows) -> Mask | None:
    left, right = rows.operand(match[2]), rows.operand(match[3])
    return None if left is None or right is None else rows.same(left, right, wanted=not match[1])


def _of_kind(match: re.Match[str], rows: _Rows) -> Mask | None:
    values = rows.operand(match[3])
    if values is None:
        return None
    mask: Mask = (rows.dictionary.kinds(values) == _KINDS[match[2].lower()]) != bool(match[1])
    return mask


def _is_bound(match: re.Match[str], rows: _Rows) -> Mask:
    column = rows.columns.get(match[2][1:])
    bound = np.zeros(rows.table.rows, bool) if column is None else rows.table.columns[column] != 0
    return ~bound if match[1] else bound


def _is_among(match: re.Match[str], rows: _Rows) -> Mask | None:
    """Compare with a list of IRIs, which no literal is equal to."""
    values = rows.operand(match[1])
    if values is None:
        return None
    listed = [rows.dictionary.intern(iri.encode()) for iri in re.findall(_IRI, match[3])]
    mask: Mask = np.isin(values, np.array(listed, np.int64)) != bool(match[2])
    return mask


def _is_typed(match: re.Match[str], rows: _Rows) -> Mask | None:
    """Compare the type of literals with an IRI; of another term it is an error."""
    values, wanted = rows.operand(match[1]), rows.operand(match[3])
    if values is None or wanted is None:
        return None
    dictionary = rows.dictionary
    if (dictionary.kinds(wanted) == LITERAL).any():
        return None
    mask: Mask = dictionary.kinds(values) == LITERAL
    different = distinct(values[mask])
    types = dictionary.intern_all(map(datatype, dictionary.spellings(different)))
    chosen = wanted if wanted.size == 1 and values.size != 1 else wanted[mask]
    mask[mask] = (types[np.searchsorted(different, values[mask])] == chosen) == (match[2] == "=")
    return mask


_FORMS: Final[tuple[tuple[re.Pattern[str], Callable[[re.Match[str], _Rows], Mask | None]], ...]] = (
    (_COMPARISON, _compared),
    (_SAME, _same_term),
    (_KIND, _of_kind),
    (_BOUND, _is_bound),
    (_AMONG, _is_among),
    (_TYPED, _is_typed),
)
