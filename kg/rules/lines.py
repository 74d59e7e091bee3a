"""Columns as lines of N-Triples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.engine.facts import Facts, unpack
from kg.rules.form import AUXILIARY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.engine.facts import Keys
    from kg.rules.engine.terms import Dictionary

__all__ = ["lines", "stored"]

_ROWS: Final = 1 << 15
"""How many lines are made at once."""

_AUXILIARY: Final = b"<" + AUXILIARY.encode()


def stored(facts: Facts, dictionary: Dictionary) -> Facts:
    """Return the triples that belong into a store: those of predicates that decomposition did not make."""
    found = Facts()
    for predicate, keys in facts:
        if not dictionary.spelling(predicate).startswith(_AUXILIARY):
            found.replace(predicate, keys)
    return found


def lines(facts: Facts, dictionary: Dictionary, predicates: Iterable[int] | None = None) -> Iterator[bytes]:
    """Yield the triples, or those of some predicates, as chunks of N-Triples, in the order of predicates."""
    for predicate in sorted(facts.predicates if predicates is None else predicates, key=dictionary.spelling):
        keys = facts.keys(predicate)
        middle = b" " + dictionary.spelling(predicate) + b" "
        for begin in range(0, keys.size, _ROWS):
            yield _chunk(keys[begin : begin + _ROWS], middle, dictionary)
            if dictionary.pages is not None:
                dictionary.pages.release()


def _chunk(keys: Keys, middle: bytes, dictionary: Dictionary) -> bytes:
    subjects, objects = unpack(keys)
    cells = [middle] * (4 * keys.size)
    cells[0::4] = dictionary.spellings(subjects)
    cells[2::4] = dictionary.spellings(objects)
    cells[3::4] = [b" .\n"] * keys.size
    return b"".join(cells)
