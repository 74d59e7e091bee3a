"""Terms as integers: a term is interned by its spelling (`kg.store.terms`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import Triple

from kg.store.terms import of_spelling, spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from kg.store.terms import Term

__all__ = ["BLANK", "IRI", "LITERAL", "MAX_TERMS", "TRIPLE", "Dictionary"]

MAX_TERMS = 1 << 31
"""Two identifiers share one signed integer of 64 bits."""

IRI, BLANK, LITERAL, TRIPLE = range(1, 5)
"""The kinds of terms; 0 is that of "unbound"."""

_KINDS = np.zeros(1 << 16, np.int8)
# The first two bytes of a spelling, as a little-endian number, to the kind; `<<` opens a triple term.
_KINDS[0x3C::0x100] = IRI
_KINDS[0x3C3C] = TRIPLE
_KINDS[0x5F::0x100] = BLANK
_KINDS[0x22::0x100] = LITERAL


class _Identifiers(dict[bytes, int]):
    """Gives a spelling that it does not have the next identifier; looking up stays in C for those that it has."""

    def __init__(self, spellings: list[bytes]) -> None:
        super().__init__()
        self._spellings = spellings

    def __missing__(self, spelling: bytes) -> int:
        identifier = self[spelling] = len(self._spellings)
        self._spellings.append(spelling)
        return identifier


class Dictionary:
    """Spellings to identifiers and back. Identifiers count from 1; 0 stands for "unbound"."""

    def __init__(self) -> None:
        self._spellings: list[bytes] = [b""]
        self._identifiers = _Identifiers(self._spellings)
        self._kinds = np.zeros(1, np.int8)
        self._parts: dict[int, tuple[int, int, int]] = {}

    @classmethod
    def of(cls, spellings: Sequence[bytes]) -> Dictionary:
        """Return a dictionary of different terms, with identifiers in their order."""
        made = cls()
        made._spellings += spellings
        made._identifiers.update(zip(spellings, range(1, len(spellings) + 1), strict=True))
        return made

    def __len__(self) -> int:
        return len(self._spellings)

    def intern(self, spelling: bytes) -> int:
        """Return the identifier of a term, a new one when it is not known."""
        return self._identifiers[spelling]

    def intern_term(self, term: Term) -> int:
        """Return the identifier of a term of pyoxigraph."""
        return self._identifiers[spell(term)]

    def intern_all(self, spellings: Iterable[bytes]) -> NDArray[np.int64]:
        """Return the identifiers of many terms, in their order."""
        return np.fromiter(map(self._identifiers.__getitem__, spellings), np.int64)

    def find(self, spelling: bytes) -> int | None:
        """Return the identifier of a term that is known, without making one."""
        return self._identifiers.get(spelling)

    def spelling(self, identifier: int) -> bytes:
        """Return how a term is spelt in N-Triples."""
        return self._spellings[identifier]

    def spellings(self, identifiers: NDArray[np.int64] | Sequence[int]) -> list[bytes]:
        """Return the spellings of many terms, in their order."""
        every = self._spellings
        found = identifiers.tolist() if isinstance(identifiers, np.ndarray) else identifiers
        return [every[identifier] for identifier in found]

    def term(self, identifier: int) -> Term:
        """Return a term as one of pyoxigraph's."""
        return of_spelling(self._spellings[identifier])

    def kinds(self, identifiers: NDArray[np.int64]) -> NDArray[np.int8]:
        """Return the kind of each term. Only spellings of terms that are asked for the first time are looked at."""
        if self._kinds.size < len(self._spellings):
            # Grown by more than is needed, so that terms made one after the other do not copy it each time.
            grown = np.zeros(len(self._spellings) * 5 // 4, np.int8)
            grown[: self._kinds.size] = self._kinds
            self._kinds = grown
        found: NDArray[np.int8] = self._kinds[identifiers]
        if not found.all():
            every = self._spellings
            missing = np.unique(identifiers[found == 0])
            beginnings = b"".join([every[identifier][:2] or b"\0\0" for identifier in missing.tolist()])
            self._kinds[missing] = _KINDS[np.frombuffer(beginnings, "<u2")]
            found = self._kinds[identifiers]
        return found

    def intern_triple(self, subject: int, predicate: int, value: int) -> int:
        """Return the identifier of the triple term of three terms."""
        every = self._spellings
        found = self.intern(b"<<( %s %s %s )>>" % (every[subject], every[predicate], every[value]))
        self._parts[found] = (subject, predicate, value)
        return found

    def parts(self, identifier: int) -> tuple[int, int, int]:
        """Return subject, predicate and object of a triple term; interns those that are not known."""
        found = self._parts.get(identifier)
        if found is None:
            triple = self.term(identifier)
            if not isinstance(triple, Triple):
                raise TypeError(self._spellings[identifier])
            found = (
                self.intern_term(triple.subject),
                self.intern_term(triple.predicate),
                self.intern_term(triple.object),
            )
            self._parts[identifier] = found
        return found
